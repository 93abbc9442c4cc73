"""Tick: everything known about one control period; seen, saved and scored are the same value."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio.human.pose import HumanPose
from studio.robot.pose import ReferencePose, RobotState

Array = NDArray[np.float64]


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

    index: int
    t: float
    human: HumanPose | None
    human_fresh: bool
    expert: str
    votes: dict[str, float]
    state: str
    transition_to: str | None
    mode: str
    controller: str
    reference: ReferencePose
    action: Array
    target: Array
    robot: RobotState
    clipped: bool
    fallen: bool
    why: str = ""
    timings_ms: dict[str, float] = field(default_factory=dict)
    counters: dict[str, int] = field(default_factory=dict)
