"""References of one state → a policy that tracks them: `a1-studio train policy`.

Reads top to bottom: the run, what is kept of it, its line of progress. One iteration is
`policy_trainer`, the settings `policy_settings`.
"""

import logging
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors.numpy import load_file, save_file

from studio.control.policy import save_policy
from studio.errors import StudioError
from studio.files import whole
from studio.training.device import threads
from studio.training.parallel import ProcessGroup, join, leave
from studio.training.policy_settings import PolicyTraining
from studio.training.policy_trainer import PolicyTrainer
from studio.training.stages import publish, stages_of

log = logging.getLogger(__name__)


def run_train_policy(config: PolicyTraining) -> dict[str, Any]:
    """Train every stage of `config`, a checkpoint every minute; the object `--json` prints.

    Until `samples` of each, or `hours` in all; with `resume` each goes on where it stopped.
    """
    group = join()
    stages = stages_of(replace(config, threads=config.threads or group.threads))
    began = time.monotonic()
    answer: dict[str, Any] = {}
    with threads(stages[0].threads):  # the command line keeps torch on one, for the live loop
        for k, stage in enumerate(stages):
            left = stage.hours - (time.monotonic() - began) / 3600.0
            begun = (stage.folder / "checkpoint.safetensors").is_file()
            # A later stage may not have been reached; that a first one was not is worth saying.
            resume = stage.resume and (begun or k == 0)
            log.info("stage %d of %d: %s", k + 1, len(stages), stage.folder)
            answer = _run(replace(stage, hours=left, resume=resume), group)
            if answer["samples"] < stage.samples:
                break  # its hours were over
    leave()
    if config.publish and group.is_main and answer["samples"] >= stages[-1].samples:
        publish(stages)
    return answer


def _run(config: PolicyTraining, group: ProcessGroup) -> dict[str, Any]:
    from torch.utils.tensorboard.writer import SummaryWriter

    folder = config.folder
    saved = folder / "checkpoint.safetensors"
    trainer = PolicyTrainer(config, group=group)
    if config.checkpoint and not (config.resume and saved.is_file()):
        trainer.restore(config.checkpoint)
        if config.explore:
            trainer.explore(config.explore)
    elif config.resume:
        trainer.restore(saved)
    writer = SummaryWriter(str(folder)) if group.is_main else None

    began = last_save = time.monotonic()
    first = trainer.samples

    def write(figures: dict[str, float]) -> None:
        if writer:
            for name, value in figures.items():
                writer.add_scalar(name, value, trainer.samples)

    def lesson(figures: dict[str, float]) -> None:
        nonlocal last_save
        log.info("%s taught %.2f M: %s", config.state, trainer.samples / 1e6, _brief(figures))
        write({f"teacher/{name}": value for name, value in figures.items()})
        if time.monotonic() - last_save > config.checkpoint_seconds:
            last_save = time.monotonic()
            _keep(trainer, figures, folder)

    if trainer.samples < config.lessons:
        trainer.teach(config.lessons, lesson)
        _keep(trainer, {"stage": float(trainer.env.env.curriculum.level)}, folder)
    figures: dict[str, float] = {}
    while trainer.samples < config.samples:
        if group.broadcast(time.monotonic() - began) >= 3600.0 * config.hours:
            break
        figures = trainer.step()
        write(figures)
        _progress(config, trainer, figures, first, time.monotonic() - began)
        if time.monotonic() - last_save > config.checkpoint_seconds:
            last_save = time.monotonic()
            _keep(trainer, figures, folder)
    _keep(trainer, figures, folder)
    if writer:
        writer.close()
    return {
        "state": config.state,
        "samples": trainer.samples,
        "seconds": trainer.seconds,
        "run": str(folder),
        "stage": trainer.env.env.curriculum.level,
        **figures,
    }


def _brief(figures: dict[str, float]) -> str:
    return ", ".join(f"{name} {value:.4g}" for name, value in figures.items())


def _keep(trainer: PolicyTrainer, figures: dict[str, float], folder: Path) -> None:
    """Checkpoint, weights and one point of the curve, by the first process."""
    if not trainer.group.is_main:
        return
    keep = ("reward", "joint_rmse_deg", "tracked_time_ratio", "fall_rate", "stage")
    point = {k: round(figures[k], 4) for k in keep if k in figures}
    trainer.curve.append({"samples": trainer.samples, **point})
    trainer.save(folder / "checkpoint.safetensors")
    if trainer.config.privileged:
        with whole(folder / "teacher.safetensors") as scratch:
            save_file(trainer.tensors(), scratch)
    else:
        tensors, manifest = trainer.tensors(), trainer.manifest(scores={})
        if trainer.config.average:
            tensors = mean_weights(tensors, load_file(trainer.config.average))
            manifest["averaged"] = {"with": "the stage it went on from", "share": 0.5}
        save_policy(folder / "policy.safetensors", tensors, manifest)


def mean_weights(
    one: Mapping[str, NDArray[np.float32]], other: Mapping[str, NDArray[np.float32]]
) -> dict[str, NDArray[np.float32]]:
    """Each array the mean of both, normalisers' too; StudioError if they are of other networks."""
    if {k: v.shape for k, v in one.items()} != {k: v.shape for k, v in other.items()}:
        raise StudioError("only weights of networks of the same size can be averaged")
    half = np.float32(0.5)
    return {name: np.multiply(value + other[name], half) for name, value in one.items()}


def _progress(
    config: PolicyTraining,
    trainer: PolicyTrainer,
    figures: dict[str, float],
    first: int,
    elapsed: float,
) -> None:
    """One line an iteration, with the time left."""
    rate = (trainer.samples - first) / max(elapsed, 1e-9)
    left = min((config.samples - trainer.samples) / rate, 3600.0 * config.hours - elapsed)
    log.info(
        "%s %.2f M of %.1f M, stage %d/%d, reward %.3f, joints %.2f deg, feet %.1f cm, "
        "tilt %.1f deg, tracked %.3f, falls %.3f/s, std %.2f, lr %.0e, %.0f samples/s "
        "(collect %.0f %%), %d min left",
        config.state,
        trainer.samples / 1e6,
        config.samples / 1e6,
        trainer.env.env.curriculum.level,
        len(trainer.env.env.curriculum.ladder) - 1,
        figures["reward"],
        figures["joint_rmse_deg"],
        100.0 * figures["metric/foot_error"],
        np.rad2deg(figures["metric/tilt_error"]),
        figures["metric/tracked"],
        figures["fall_rate"],
        figures["action_std"],
        figures["learning_rate"],
        figures["samples_per_second"],
        100.0 * figures["collect_share"],
        max(left, 0.0) / 60.0,
    )
