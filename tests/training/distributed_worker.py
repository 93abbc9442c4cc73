"""One process of a distributed training: trains a little and writes down what it ended with.

torchrun --nproc-per-node 2 distributed_worker.py FOLDER
"""

import hashlib
import json
import sys
from pathlib import Path

import numpy as np

from studio.rl.bank import build_bank
from studio.rl.curriculum import Curriculum, stages
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig
from studio.training.parallel import SEED_STEP, join, leave
from studio.training.policy_settings import PolicyTraining
from studio.training.policy_trainer import PolicyTrainer
from studio.training.ppo import PpoConfig


def digest(arrays: dict[str, np.ndarray]) -> str:
    return hashlib.sha256(b"".join(arrays[k].tobytes() for k in sorted(arrays))).hexdigest()


def main(folder: Path) -> None:
    group = join()
    bank = build_bank("sit", per_task=1, seconds=2.0, difficulties=(0.4, 0.7, 1.0))
    # Stages are left after few episodes, at other moments in each process.
    curriculum = Curriculum(ladder=stages(bank.tasks), patience=10 + 9 * group.rank)
    env = ImitationEnv(
        EnvConfig(num_envs=16, threads=1), bank, seed=SEED_STEP * group.rank, curriculum=curriculum
    )
    ppo = PpoConfig(horizon=12, epochs=1, minibatch=96, hidden=(32, 32))
    config = PolicyTraining(state="sit", num_envs=16, threads=1, ppo=ppo)
    trainer = PolicyTrainer(config, env, group)
    trainer.teach(2 * 16 * 24 * group.size, lambda _: None)
    curriculum.load({"level": 0, "episodes": 0, "ratio": 0.0})
    env.restart()
    for _ in range(12):
        trainer.step()
    report = {
        "policy": digest(trainer.tensors()),
        "critic": digest({k: v.numpy() for k, v in trainer.alg.critic.state_dict().items()}),
        "learning_rate": trainer.alg.learning_rate,
        "level": curriculum.level,
        "samples": trainer.samples,
        "observations": digest({"o": env.observation()}),
    }
    (folder / f"{group.rank}.json").write_text(json.dumps(report))
    leave()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
