"""Task library → a bank of reference motions as arrays, drawn once and sampled from thereafter."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control.observation_frame import heading_of, level_quat, reference_frame
from studio.errors import StudioError
from studio.reference.intent import StateName
from studio.reference.library import TASKS, task_names
from studio.reference.motion import ReferenceMotion, backward_difference
from studio.reference.tasks_travel import TRAVEL
from studio.rl.curriculum import DIFFICULTIES, Rung
from studio.rl.transitions import rests_on_legs, transition_motion, transition_names
from studio.robot import kinematics
from studio.timing import CONTROL_HZ

log = logging.getLogger(__name__)
Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class MotionBank:
    """M motions of T control periods each, leading axes (M, T); world frame, starting anywhere.

    feet: (M, T, 4, 3) m, base-relative in the levelled heading frame. feature: (M, T, 18), p̄.
    yaw: (M, T) rad heading of the levelled trunk. task: (M,) index into `tasks`; difficulty: (M,).
    leg_contact: some motion rests on calves or thighs. seen: (M, T, 18), p̄ as the policy sees it,
    None for `feature` with the environment's noise.
    """

    state: StateName
    tasks: tuple[str, ...]
    joint_pos: Array
    joint_vel: Array
    base_pos: Array
    base_quat: Array
    lin_vel_w: Array
    ang_vel_b: Array
    contact: Array
    feet: Array
    feature: Array
    yaw: Array
    task: NDArray[np.intp]
    difficulty: Array
    leg_contact: bool = False
    seen: Array | None = None

    def __len__(self) -> int:
        return len(self.task)

    @property
    def frames(self) -> int:
        """Control periods in every motion."""
        return self.joint_pos.shape[1]

    def choices(self, stage: Rung) -> NDArray[np.intp]:
        """Indices (n,) of the motions of the stage's tasks up to its difficulty.

        Raises StudioError where there is none.
        """
        known = np.isin(np.array(self.tasks)[self.task], stage.tasks)
        chosen = np.flatnonzero(known & (self.difficulty <= stage.difficulty + 1e-9))
        if not len(chosen):
            raise StudioError(f"no motion of {stage.tasks} up to difficulty {stage.difficulty}")
        return chosen


def warp(motion: ReferenceMotion, rate: float, frames: int) -> ReferenceMotion:
    """The motion played at `rate` times its speed, cut to `frames` control periods."""
    at = np.minimum(np.arange(frames) * rate, len(motion) - 1.0)
    low = np.minimum(at.astype(int), len(motion) - 2)
    s = at - low

    def mix(x: Array) -> Array:
        w = s.reshape((-1,) + (1,) * (x.ndim - 1))
        return (1.0 - w) * x[low] + w * x[low + 1]

    quat = geometry.quat_slerp(motion.base_quat[low], motion.base_quat[low + 1], s)
    return ReferenceMotion(
        state=motion.state,
        task=motion.task,
        dt=motion.dt,
        base_pos=mix(motion.base_pos),
        base_quat=quat,
        joint_pos=mix(motion.joint_pos),
        foot_contact=mix(motion.foot_contact),
        params=motion.params,
    )


def heading_feet(joint_pos: Array, base_quat: Array, yaw: Array) -> Array:
    """(…, 4, 3) m foot centres relative to the trunk origin, in the frame turned by yaw (…) rad.

    joint_pos (…, 12) rad, base_quat (…, 4) in the world.
    """
    rel = kinematics.to_world(np.zeros(3), base_quat, kinematics.foot_pos_b(joint_pos))
    turned = geometry.turn_xy(rel, -np.asarray(yaw)[..., None])
    return np.concatenate([turned, rel[..., 2:]], axis=-1)


def assemble(
    state: StateName,
    tasks: Sequence[str],
    motions: Sequence[ReferenceMotion],
    difficulty: Sequence[float],
) -> MotionBank:
    """Stack equally long motions and derive everything that training reads per frame.

    difficulty: of each motion, in [0, 1].
    """
    level = np.array(level_quat(state))
    joint_pos = np.stack([m.joint_pos for m in motions])
    base_pos = np.stack([m.base_pos for m in motions])
    base_quat = np.stack([m.base_quat for m in motions])
    dt = motions[0].dt
    lin = np.stack([backward_difference(m.base_pos, dt) for m in motions])
    ang = np.stack([geometry.ang_vel_b(m.base_quat, dt) for m in motions])
    yaw = heading_of(base_quat, level)
    return MotionBank(
        state=state,
        tasks=tuple(tasks),
        joint_pos=joint_pos,
        joint_vel=np.stack([backward_difference(m.joint_pos, dt) for m in motions]),
        base_pos=base_pos,
        base_quat=base_quat,
        lin_vel_w=lin,
        ang_vel_b=ang,
        contact=np.stack([m.foot_contact for m in motions]),
        feet=heading_feet(joint_pos, base_quat, yaw),
        feature=reference_frame(joint_pos, base_pos[..., 2], base_quat, lin, ang, level),
        yaw=yaw,
        task=np.array([list(tasks).index(m.task) for m in motions]),
        difficulty=np.asarray(difficulty, dtype=np.float64),
        leg_contact=state == "sit",
    )


def build_bank(
    state: StateName,
    *,
    per_task: int,
    seconds: float = 10.0,
    seed: int = 0,
    difficulties: Sequence[float] = DIFFICULTIES,
    time_warp: float = 0.15,
    transitions: int = 0,
    travels: int = 0,
) -> MotionBank:
    """`per_task` motions of every task of a state at each difficulty, time-warped by ± a share.

    transitions: as many motions out of each other state, at each difficulty. travels: as many
    through space (`reference.tasks_travel`). Deterministic in its arguments.
    """
    names = task_names(state)
    ways = transition_names(state) if transitions else ()
    counts = dict.fromkeys(names, per_task) | dict.fromkeys(ways, transitions)
    if travels:
        counts[TRAVEL.name] = travels
    frames = round(seconds * CONTROL_HZ) + 1
    motions, hardness = [], []
    for index, (name, count) in enumerate(counts.items()):
        for level in difficulties:
            rng = np.random.default_rng([seed, index, round(1000 * level)])
            for _ in range(count):
                rate = rng.uniform(1.0 - time_warp, 1.0 + time_warp)
                length = seconds * (1.0 + time_warp) + 0.2
                motions.append(warp(_motion(name, state, rng, length, level), rate, frames))
                hardness.append(level)
    bank = assemble(state, tuple(counts), motions, hardness)
    if transitions:
        bank = replace(bank, leg_contact=rests_on_legs(state))
    log.info("bank %s: %d motions of %d frames", state, len(bank), frames)
    return bank


def _motion(
    name: str, state: StateName, rng: np.random.Generator, seconds: float, difficulty: float
) -> ReferenceMotion:
    """One motion of a library task, or of a transition into the state."""
    from studio.reference.realize import realize

    if name == TRAVEL.name:
        return realize(TRAVEL.sample(rng, seconds, difficulty=difficulty))
    if name in TASKS:
        return realize(TASKS[name].sample(rng, seconds, difficulty=difficulty))
    source = cast(StateName, name.removeprefix("from_"))
    return transition_motion(source, state, rng, seconds, difficulty)


def relevelled(bank: MotionBank, state: StateName) -> MotionBank:
    """The same motions with tilts and headings about the neutral trunk of another state."""
    level = np.array(level_quat(state))
    yaw = heading_of(bank.base_quat, level)
    return replace(
        bank,
        state=state,
        yaw=yaw,
        feet=heading_feet(bank.joint_pos, bank.base_quat, yaw),
        feature=reference_frame(
            bank.joint_pos,
            bank.base_pos[..., 2],
            bank.base_quat,
            bank.lin_vel_w,
            bank.ang_vel_b,
            level,
        ),
    )


def merged(banks: Sequence[MotionBank], state: StateName = "stand") -> MotionBank:
    """One bank of several states' motions, levelled as `state`: for one policy of them all."""
    banks = [relevelled(bank, state) for bank in banks]
    tasks = tuple(name for bank in banks for name in bank.tasks)
    offsets = np.cumsum([0] + [len(bank.tasks) for bank in banks])
    arrays = {
        f.name: np.concatenate([getattr(bank, f.name) for bank in banks])
        for f in fields(MotionBank)
        if isinstance(getattr(banks[0], f.name), np.ndarray)
    }
    arrays["task"] = np.concatenate([b.task + o for b, o in zip(banks, offsets[:-1], strict=True)])
    legs = any(bank.leg_contact for bank in banks)
    return MotionBank(state=state, tasks=tasks, leg_contact=legs, **arrays)
