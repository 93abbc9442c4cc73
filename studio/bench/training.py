"""What training costs on this machine as work grows: a policy's environments, a mapper's pairs."""

import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from studio.errors import StudioError
from studio.reference.stances import NEUTRAL
from studio.retarget.store import load_experts
from studio.rl.bank import MotionBank, build_bank
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig
from studio.robot.a1 import CONTROL_DT
from studio.sim.batch import BatchConfig, BatchWorld
from studio.training.collected import TakesTraining, train_state
from studio.training.synthetic_pairs import make_pairs
from studio.training.take_pairs import split_pairs

SIZES = (64, 256, 1024, 4096)
PPO_ENVS = 512
PPO_SAMPLES = 300_000
ROUNDS = 3
MOTIONS = 4
"""Of every task at each difficulty."""
STATE = "walk"
SETTLE = 60
"""Control periods until a robot that was dropped stands."""
Step = Callable[[], Any]

PAIRS = (500, 5_000, 50_000)
EPOCHS = 10


def training_rates(
    seconds: float,
    sizes: tuple[int, ...] = SIZES,
    ppo_envs: int = PPO_ENVS,
    ppo_samples: int = PPO_SAMPLES,
    motions: int = MOTIONS,
    rounds: int = ROUNDS,
) -> list[dict[str, Any]]:
    """A row per number of environments: control samples a second of physics and environment.

    The last row adds PPO around it (its own process), at `ppo_envs` environments, without and with
    mirrored copies (which are not counted), as shares of the bare physics of as many. What is
    compared takes turns, `rounds` of them: a machine that is slow for a while is so for all.
    """
    bank = build_bank(STATE, per_task=motions, seed=0)
    rows = []
    for n in sizes:
        steps = physics_step(n), environment_step(n, bank)
        physics, environment = in_turns(steps, n, seconds, rounds)
        rows.append(
            {
                "num_envs": n,
                "physics_per_s": physics,
                "environment_per_s": environment,
                "environment_share": environment / physics,
            }
        )
    step, each = physics_step(ppo_envs), max(1, ppo_samples // rounds)
    turns = []
    for _ in range(rounds):
        (physics,) = in_turns((step,), ppo_envs, seconds / rounds, 1)
        learnt = (ppo_rate(mirror, ppo_envs, each, motions) for mirror in (False, True))
        turns.append((physics, *learnt))
    physics, plain, mirrored = map(statistics.harmonic_mean, zip(*turns, strict=True))
    rows.append(
        {
            "num_envs": ppo_envs,
            "physics_per_s": physics,
            "ppo_per_s": plain,
            "ppo_share": plain / physics,
            "ppo_mirrored_per_s": mirrored,
            "ppo_mirrored_share": mirrored / physics,
        }
    )
    return rows


def mapper_growth(sizes: tuple[int, ...] = PAIRS, epochs: int = EPOCHS) -> dict[str, Any]:
    """Seconds from pairs to a scored mapper at each size, each pair learnt from `epochs` times.

    Holding out, learning, and scoring beside nearest pair and ridge, as `train mapper --takes`
    does it. exponent: slope of log seconds over log pairs between the two largest; 1 is linear.
    """
    pairs = make_pairs(STATE, 1.3 * max(sizes) * CONTROL_DT, seed=0)
    shipped = load_experts("march").mappers
    rows: list[dict[str, Any]] = []
    for size in (sizes[0], *sizes):  # the first one twice: to warm up
        some = pairs.take(np.arange(size))
        split = split_pairs({f"t{i}": some.take(rows) for i, rows in enumerate(_fifths(size))})
        config = TakesTraining(
            steps=max(1, epochs * len(split.known) // TakesTraining.batch), start="scratch"
        )
        began = time.perf_counter()
        train_state(STATE, split, config, shipped, lambda _: None)
        rows.append({"pairs": size, "steps": config.steps, "seconds": time.perf_counter() - began})
    rows = rows[1:]
    (n, s), (m, t) = ((row["pairs"], row["seconds"]) for row in rows[-2:])
    return {"epochs": epochs, "rows": rows, "exponent": float(np.log(t / s) / np.log(m / n))}


def _fifths(count: int) -> list[np.ndarray]:
    return np.array_split(np.arange(count), 5)


def physics_step(num_envs: int) -> Step:
    """One control period of standing robots.

    They stand already: a robot in the air has no contacts and costs half.
    """
    world = BatchWorld(BatchConfig(num_envs=num_envs))
    target = np.tile(NEUTRAL["stand"].joint_pos, (num_envs, 1))
    for _ in range(SETTLE):
        world.step(target)
    return lambda: world.step(target)


def environment_step(num_envs: int, bank: MotionBank) -> Step:
    """The same of the whole environment: references, noise, observation, reward, resets."""
    env = ImitationEnv(EnvConfig(num_envs=num_envs), bank)
    env.reset()
    action = np.zeros((num_envs, 12))
    return lambda: env.step(action)


def ppo_rate(
    mirror: bool, num_envs: int = PPO_ENVS, samples: int = PPO_SAMPLES, motions: int = MOTIONS
) -> float:
    """Samples a second of `a1-studio train policy`, learning included; mirror: copies, not counted.

    No teacher's lessons: they cost less than PPO does. StudioError, saying why, if it fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        done = subprocess.run(
            [
                *(sys.executable, "-m", "studio", "train", "policy", "--state", STATE),
                *("--samples", str(samples), "--num-envs", str(num_envs)),
                *("--motions-per-task", str(motions)),
                *("--distil", "0", "--people", "0", "--transitions", "0"),
                "--ppo.mirror" if mirror else "--ppo.no-mirror",
                *("--run", str(Path(folder) / "run"), "--json", str(report)),
            ],
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            lines = done.stderr.strip().splitlines()
            raise StudioError(f"training did not run: {lines[-1] if lines else 'no word why'}")
        figures = json.loads(report.read_text())
        return figures["samples"] / figures["seconds"]


def in_turns(
    steps: Sequence[Step], num_envs: int, seconds: float, rounds: int = ROUNDS
) -> list[float]:
    """Control periods a second of each, all environments together, `seconds` of each in all."""
    counts, spent = [0] * len(steps), [0.0] * len(steps)
    for step in steps:
        step()
    for _ in range(rounds):
        for k, step in enumerate(steps):
            began = time.perf_counter()
            while (lasted := time.perf_counter() - began) < seconds / rounds:
                step()
                counts[k] += 1
            spent[k] += lasted
    return [num_envs * count / lasted for count, lasted in zip(counts, spent, strict=True)]
