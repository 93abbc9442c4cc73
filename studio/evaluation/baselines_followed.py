"""What comes of a mapper when the shipped policy follows: Table I's episodes, minutes of driving.

The truth is what the robot was to make of the person (the library's motion); the policy sees what
the mapper says of them, planted. So who maps little is not tracked, however steadily it stands.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from studio import geometry
from studio.control.observation_frame import level_quat, reference_frame
from studio.evaluation.contenders import contender
from studio.evaluation.endurance import FIRST_SEED, time_between
from studio.evaluation.long_drive import LIE_S, Case, endure
from studio.evaluation.pairs import SETTLE, plant
from studio.evaluation.tracking import compare
from studio.reference.contact import contact_labels
from studio.reference.intent import StateName
from studio.reference.motion import ReferenceMotion, backward_difference
from studio.reference.realize import realize
from studio.retarget.mapper import Expert
from studio.retarget.store import load_experts
from studio.rl.bank import MotionBank, assemble
from studio.robot import kinematics
from studio.robot.a1 import CONTROL_DT
from studio.training.operator_pairs import KNOWN_AFTER, Array, acts, aligned
from studio.training.rivals import in_place

FRAMES = 301
"""Of an episode of 10 s."""
ACTED_S = 13.0
"""s a person acts: an episode, how late they are, and how long they take to be known."""
DRIVEN: dict[StateName, str] = {
    "stand": "operator:tilt",
    "walk": "operator:walk",
    "sit": "operator:sit_tilt",
}
"""Who drives for minutes."""


@dataclass(frozen=True, kw_only=True)
class Acted:
    """triplet (T, 3F) of a person, SETTLE frames before the robot's motion begins."""

    triplet: Array
    motion: ReferenceMotion


def acted(state: StateName, episodes: int, seed: int) -> list[Acted]:
    """People of the held-out family, and the motions of 10 s that they mean."""
    rng = np.random.default_rng([seed, 47])
    out: list[Acted] = []
    for track, robot, person in acts(state, rng, "held_out", "march", ACTED_S):
        triplet, pose = aligned(track, realize(robot), person, rng)
        begin = KNOWN_AFTER + SETTLE
        if len(triplet) < begin + FRAMES:
            continue
        pos, quat, joints = (x[begin : begin + FRAMES] for x in pose)
        motion = ReferenceMotion(
            state=state,
            task=track.task,
            dt=CONTROL_DT,
            base_pos=pos,
            base_quat=quat,
            joint_pos=joints,
            foot_contact=contact_labels(kinematics.foot_pos_w(pos, quat, joints), CONTROL_DT),
        )
        out.append(Acted(triplet=triplet[KNOWN_AFTER : begin + FRAMES], motion=motion))
        if len(out) == episodes:
            return out
    raise AssertionError("acts end")


def followed(state: StateName, expert: Expert, people: list[Acted], seed: int) -> dict[str, Any]:
    """Success and tracked time of the shipped policy, with their intervals, and the robot's lag."""
    who = contender("policy", state)
    if who is None:
        return {}
    bank = _bank(state, expert, people)

    def motions(*_: Any) -> MotionBank:
        return bank

    row = compare([(state, who)], len(people), seed, 1, None, False, motions)[0]
    names = ("success_time_ratio", "tracked_time_ratio")
    return {
        **{key: row[key] for name in names for key in (name, f"{name}_ci")},
        "robot_lag_ms": row["lag_ms"],
    }


def _bank(state: StateName, expert: Expert, people: list[Acted]) -> MotionBank:
    level, seen = np.array(level_quat(state)), []
    for each in people:
        pose, _, _ = plant(state, expert(each.triplet))
        seen.append(
            reference_frame(
                pose.joint_pos,
                pose.base_pos[:, 2],
                pose.base_quat,
                backward_difference(pose.base_pos, CONTROL_DT),
                geometry.ang_vel_b(pose.base_quat, CONTROL_DT),
                level,
            )
        )
    motions = [each.motion for each in people]
    tasks = tuple(dict.fromkeys(motion.task for motion in motions))
    bank = assemble(state, tasks, motions, [1.0] * len(motions))
    return replace(bank, seen=np.stack(seen))


def endured(
    state: StateName, expert: Expert, people: int, seconds: float, seed: int
) -> dict[str, Any]:
    """Falls of people who drive under Table I, the other states mapped by the shipped experts."""
    case = Case(source=DRIVEN[state], dynamics="table_i", people=people, seconds=seconds)
    experts = in_place(load_experts(), {state: expert}, "a rival")
    runs = [endure(case, FIRST_SEED + seed + k, experts) for k in range(people)]
    falls = sum(len(run.falls) for run in runs)
    up = sum(run.seconds for run in runs) - LIE_S * falls
    return {
        "falls": falls,
        "driven_s": up,
        "mean_time_between_falls_s": up / falls if falls else None,
        "mean_time_between_falls_s_ci": list(time_between(falls, up)),
    }
