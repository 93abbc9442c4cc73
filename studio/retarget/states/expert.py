"""What an expert is, apart from its weights: its state, how fast joints may go."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from studio.reference.consistency import ContactConfig
from studio.reference.intent import StateName


@dataclass(frozen=True, kw_only=True)
class ExpertSpec:
    """One state's retargeting expert.

    name: the state. speed_limit: rad/s, bound on every joint's speed
    in the temporal consistency step (JOINT_SPEED). trunk_speed: rad/s and root_speed: m/s,
    the same for the trunk: a little less than the joints of standing legs can follow, so that the
    clip of the joints does not tear locked feet off the floor. consistency: how feet lock.
    turn_gain: times the turns that a network says. turns: the trunk's
    heading is carried by the feet (walking) instead of read off the person's twist. emphasis:
    how much more of a task's motion to train on than of the others (default 1.0; 0: none).
    """

    name: StateName
    speed_limit: float
    trunk_speed: float
    root_speed: float
    consistency: ContactConfig = field(default_factory=ContactConfig)
    turn_gain: float = 1.0
    turns: bool = False
    emphasis: Mapping[str, float] = field(default_factory=dict)
