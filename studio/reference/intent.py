"""What an operator means, in the robot's terms: the one value people, scripts and keys set.

An intent drives two things that must agree: the synthetic operator acts it out
(`synthetic.operator`), the reference library realises it on the robot (`reference.library`). A
pair of the two is what a mapper learns from. Nothing else turns an intent into robot motion: live,
a keyboard sets an intent, the operator acts it, the mapper reads the person.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio.options import STATES, StateName

__all__ = ["STATES", "Intent", "IntentTrack", "StateName"]

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Intent:
    """One instant of what is meant. Everything but `phase` is zero at rest.

    state: which expert it belongs to. task: the library task it came from.
    tilt: (3,) rad, roll, pitch, yaw of the trunk about the state's neutral pose; the person's
        trunk does the same (roll > 0 leans right, pitch > 0 bends forward, yaw > 0 twists left).
    crouch: [0, 1], 0 the neutral height, 1 the lowest stand; the person bends the knees
        (up to about 70 degrees).
    reach: (2,) [0, 1], front right and front left paw: 0 on the floor (arm hanging), 0.5 paw
        forward at mid-height (arm straight forward), 1 as high as it goes (arm overhead).
    reach_side: (2,) [-1, 1], to the side: > 0 to the left (arm and paw alike).
    speed, side: m/s forward (< 0 backward) and to the left. turn: rad/s, > 0 left.
    phase: strides since the start of walking (its fraction is the gait phase: 0 the front left and
        rear right feet lift (the person's left foot), 0.5 the front right and rear left feet).
    cadence: strides per second (d phase / dt). lift: [0, 1], foot clearance (thigh lift).
    """

    state: StateName = "stand"
    task: str = "quiet"
    tilt: Array = field(default_factory=lambda: np.zeros(3))
    crouch: float = 0.0
    reach: Array = field(default_factory=lambda: np.zeros(2))
    reach_side: Array = field(default_factory=lambda: np.zeros(2))
    speed: float = 0.0
    turn: float = 0.0
    phase: float = 0.0
    cadence: float = 0.0
    lift: float = 0.0
    side: float = 0.0


@dataclass(frozen=True, kw_only=True)
class IntentTrack:
    """Intents over time at a fixed rate: every field of Intent with a leading axis T."""

    state: StateName
    task: str
    dt: float
    tilt: Array  # (T, 3)
    crouch: Array  # (T,)
    reach: Array  # (T, 2)
    reach_side: Array  # (T, 2)
    speed: Array  # (T,)
    turn: Array  # (T,)
    phase: Array  # (T,)
    cadence: Array  # (T,)
    lift: Array  # (T,)
    side: Array  # (T,)

    def __len__(self) -> int:
        return len(self.tilt)

    def __getitem__(self, i: int) -> Intent:
        return Intent(
            state=self.state,
            task=self.task,
            tilt=self.tilt[i],
            crouch=float(self.crouch[i]),
            reach=self.reach[i],
            reach_side=self.reach_side[i],
            speed=float(self.speed[i]),
            turn=float(self.turn[i]),
            phase=float(self.phase[i]),
            cadence=float(self.cadence[i]),
            lift=float(self.lift[i]),
            side=float(self.side[i]),
        )
