"""Scripted reference motions at nominal dynamics → what the simulated robot did, over time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.control.policy import MODELS
from studio.errors import StudioError
from studio.evaluation.contenders import contender
from studio.reference.intent import IntentTrack, StateName
from studio.reference.motion import ReferenceMotion
from studio.reference.realize import realize
from studio.rl import rollouts
from studio.rl.bank import assemble

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Recording:
    """N scripts of T control periods: base_pos (T, N, 3) m, base_quat (T, N, 4), joint_pos
    (T, N, 12) rad and alive (T, N) of the robot; the motions it was asked for."""

    base_pos: Array
    base_quat: Array
    joint_pos: Array
    alive: NDArray[np.bool_]
    motions: list[ReferenceMotion]


def controllers(state: StateName) -> list[str]:
    """PD playback, and the policy where one is trained."""
    trained = (MODELS / f"{state}.safetensors").exists()
    return ["pd_playback"] + (["policy"] if trained else [])


def record(
    state: StateName, tracks: Sequence[IntentTrack], controller: str, *, seed: int = 0
) -> Recording:
    """Track every script (all of one length) without noise, at nominal dynamics.

    Raises StudioError where no such policy is trained.
    """
    motions = [realize(track) for track in tracks]
    tasks = tuple(dict.fromkeys(m.task for m in motions))
    bank = assemble(state, tasks, motions, [1.0] * len(motions))
    who = contender(controller, state, MODELS)
    if who is None:
        raise StudioError(f"no policy is trained for {state}: `a1-studio train policy`")
    env = rollouts.evaluation_env(
        bank,
        len(motions),
        seed,
        randomisation=0.0,
        noise=0.0,
        settings=who.settings,
    )
    env.reset()
    frames = []
    alive = np.ones(len(motions), dtype=bool)
    for _ in range(bank.frames - 1):
        command = who.act(env)
        _, _, ended, _, _ = env.step(command.action, command.target)
        alive &= ~ended
        w = env.world
        frames.append(
            [np.array(w.base_pos), np.array(w.base_quat), np.array(w.joint_pos), alive.copy()]
        )
    pos, quat, joints, living = (np.stack(column) for column in zip(*frames, strict=True))
    # Row k of the recording answers frame k + 1 of the motion.
    return Recording(
        base_pos=pos, base_quat=quat, joint_pos=joints, alive=living.astype(bool), motions=motions
    )
