"""Tick: everything known about one control period; seen, saved and scored are the same value.

FIELDS is the one table of what a tick consists of, read off the annotations. The tape, the table of
columns, JSON, traces, npz and mcap derive from it: a field added to Tick, ReferencePose or
RobotState (with a default, so that older takes can be read) is in each, unless LEFT_OUT names it.
"""

from dataclasses import MISSING, dataclass, field, fields
from functools import cache
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import numpy as np

from studio.human.pose import HumanPose
from studio.human.skeleton import NUM_JOINTS
from studio.reference.intent import STATES
from studio.robot import a1, kinematics
from studio.robot.pose import PerJoint, ReferencePose, RobotPose, RobotState
from studio.takes.untrusted import Count, Line, Name, Seconds


@dataclass(frozen=True, kw_only=True)
class Tick:
    """One control period (1/30 s) of the flow.

    index: periods since the puppeteer's reset. t: seconds into the source.
    human: the pose as used (checked; the last one again if none came), or None before the first.
    human_fresh: a new human pose arrived in this period.
    expert: the selector's decision, "stand" | "walk" | "sit" | "unknown". votes: share of the
        neighbours per expert. state: what the controller does: an expert's state or "transition";
        `transition_to` then names the goal.
    mode: "idle" | "live" | "replay" | "collect". controller: which controller made the action.
    reference: the retargeted kinematic A1. action: (12,) rad, the controller's raw output.
    target: (12,) rad, the PD target after low-pass and limits. robot: the simulated A1 after
        the step. clipped: the temporal consistency clip acted on this frame. why: one line that
        says why nothing moves, or "". timings_ms: time per section. counters: totals so far.
    """

    index: Count
    t: Seconds
    human: HumanPose | None
    human_fresh: bool
    expert: Name
    votes: Annotated[dict[Name, float], STATES]
    state: Name
    transition_to: Name | None
    mode: Name
    controller: Name
    reference: ReferencePose
    action: PerJoint
    target: PerJoint
    robot: RobotState
    clipped: bool
    fallen: bool
    why: Line = ""
    timings_ms: dict[Name, float] = field(default_factory=dict)
    counters: dict[Name, Count] = field(default_factory=dict)


LEFT_OUT: dict[str, frozenset[str]] = {
    "columns": frozenset({"tick.index", "tick.human_fresh", "tick.why"}),
    "json": frozenset(
        {
            "tick.action", "reference.base_ang_vel_b", "reference.joint_vel", "robot.t",
            "robot.base_ang_vel_b", "robot.joint_vel", "robot.torque", "robot.self_collision",
        }
    ),
    "trace": frozenset(
        {
            "tick.index", "tick.human_fresh", "tick.votes", "tick.transition_to", "tick.controller",
            "tick.action", "tick.clipped", "tick.fallen", "tick.why", "tick.timings_ms",
            "tick.counters", "human.t", "human.joint_pos_w", "human.confidence",
            "reference.base_lin_vel_w", "reference.base_ang_vel_b", "reference.joint_vel",
            "robot.t", "robot.base_lin_vel_w", "robot.base_ang_vel_b", "robot.joint_vel",
            "robot.foot_pos_w", "robot.torque", "robot.trunk_contact", "robot.self_collision",
        }
    ),
    "npz": frozenset(
        {
            "tick.human_fresh", "tick.votes", "tick.transition_to", "tick.mode", "tick.controller",
            "tick.clipped", "tick.fallen", "tick.why", "robot.t",
            "robot.trunk_contact", "robot.self_collision",
        }
    ),
}  # fmt: skip
"""What a form does without, as STREAM.FIELD; the tape holds all."""

STREAMS = ("human", "reference", "robot", "tick")


@dataclass(frozen=True, kw_only=True)
class Field:
    """One field of a tick.

    stream: the part of the tick it belongs to, "tick" for itself; attr: its name there. name: on
    the tape and in JSON. column: in the table of columns. type: as annotated, without shape or
    keys. shape: of an array, else None. keys: of a mapping whose keys are known, else ().
    default: makes what an older take holds none of; None where every take has it.
    """

    stream: str
    attr: str
    name: str
    column: str
    type: Any
    shape: tuple[int, ...] | None = None
    keys: tuple[str, ...] = ()
    default: Any = None

    def within(self, form: str) -> bool:
        """Whether the form ("tape", "columns", "json", "trace", "npz") holds it."""
        if form in ("columns", "npz") and get_origin(self.type) is dict and not self.keys:
            return False  # no telling which columns
        return f"{self.stream}.{self.attr}" not in LEFT_OUT.get(form, ())


def _human(attr: str, name: str, column: str, type: Any, shape: tuple | None = None) -> Field:
    return Field(stream="human", attr=attr, name=name, column=column, type=type, shape=shape)


def _fields_of(cls: type, stream: str) -> list[Field]:
    hints, out = get_type_hints(cls, include_extras=True), list[Field]()
    for given in fields(cls):
        if given.name in STREAMS:
            continue
        hint: Any = hints[given.name]
        shape: tuple[int, ...] | None = None
        keys: tuple[str, ...] = ()
        first: Any = next(iter(getattr(hint, "__metadata__", ())), None)
        if isinstance(first, tuple):  # a shape, or the keys of a mapping
            numbers = all(isinstance(size, int) for size in first)
            shape, keys = (first, ()) if numbers else (None, first)
            hint = get_args(hint)[0]
        default = None if given.default_factory is MISSING else given.default_factory
        if given.default is not MISSING:
            default = lambda value=given.default: value  # noqa: E731
        out.append(
            Field(
                stream=stream,
                attr=given.name,
                name=given.name,
                column=given.name if stream == "tick" else f"{stream}_{given.name}",
                type=hint,
                shape=shape,
                keys=keys,
                default=default,
            )
        )
    return out


FIELDS: tuple[Field, ...] = (
    # A person's frame has the names of docs/contract.md.
    _human("t", "t", "human_t", Seconds),
    _human("joint_pos_w", "positions", "human", np.ndarray, (NUM_JOINTS, 3)),
    _human("confidence", "confidence", "confidence", np.ndarray, (NUM_JOINTS,)),
    *_fields_of(ReferencePose, "reference"),
    *_fields_of(RobotState, "robot"),
    *_fields_of(Tick, "tick"),
)
"""Every field of a tick, stream by stream."""


@cache
def fields_in(form: str, stream: str) -> tuple[Field, ...]:
    """The fields of a stream that a form holds."""
    return tuple(f for f in FIELDS if f.stream == stream and f.within(form))


def tick_at_rest(index: int, human: HumanPose | None, pose: RobotPose, **known: Any) -> Tick:
    """A recorded person beside a robot that rests in `pose`, but for the fields that are known."""
    same = {
        key: getattr(pose, key) for key in ("base_pos", "base_quat", "joint_pos", "foot_contact")
    }
    zero = np.zeros(a1.NUM_JOINTS)
    t = index * a1.CONTROL_DT
    robot = RobotState(
        **same,
        t=t + a1.CONTROL_DT,
        base_lin_vel_w=np.zeros(3),
        base_ang_vel_b=np.zeros(3),
        joint_vel=zero,
        foot_pos_w=kinematics.foot_pos_w(pose.base_pos, pose.base_quat, pose.joint_pos),
        torque=zero,
    )
    rest: dict[str, Any] = {
        "human_fresh": True,
        "expert": "unknown",
        "votes": {},
        "state": "idle",
        "transition_to": None,
        "mode": "collect",
        "controller": "stand_still",
        "reference": ReferencePose(**same),
        "action": pose.joint_pos,
        "target": pose.joint_pos,
        "robot": robot,
        "clipped": False,
        "fallen": False,
    }
    return Tick(index=index, t=t, human=human, **(rest | known))
