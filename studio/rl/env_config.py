"""The settings of a vectorised environment."""

from dataclasses import dataclass, field

from studio.control.action import ActionConfig
from studio.control.observation import ObservationConfig
from studio.rl.noise import NoiseConfig
from studio.rl.reward import RewardConfig


@dataclass(frozen=True, kw_only=True)
class EnvConfig:
    """One environment's settings, saved beside the weights trained in it.

    anchor_tau, anchor_yaw_tau: s, leak of the re-anchored root's place and heading. leg_contact:
    calves and thighs touch the floor, None for where the bank needs it. push: m/s, largest kick, at
    full randomisation, and push_every its mean interval in s. noise_scale: of reference noise.
    init_first: share of the episodes that begin with a motion's first frame. init_speed (m/s),
    init_spin (rad/s): of half of the trunks at the start, on top of the reference's.
    init_heading: rad, how far off its way a robot may begin, so that a policy that holds its
    heading learns to steer: its own errors are small and seldom.
    steep: share of the episodes on slopes of STEEP of Table I's largest, which an even draw seldom
    meets and a sitting robot falls on.
    motors: armature, damping and strength of the motors are drawn too, which Table I does not have.
    evaluation: motions in order from their first frame, no kicks, and nobody begins anew: whatever
    a controller does, it meets the same references, dynamics and noise.
    """

    num_envs: int = 512
    threads: int = 0
    observation: ObservationConfig = field(default_factory=ObservationConfig)
    action: ActionConfig = field(default_factory=ActionConfig)
    reward: RewardConfig = field(default_factory=RewardConfig)
    noise: NoiseConfig = field(default_factory=NoiseConfig)
    noise_scale: float = 1.0
    anchor_tau: float = 0.5
    anchor_yaw_tau: float = 0.5
    leg_contact: bool | None = None
    push: float = 0.4
    push_every: float = 4.0
    init_joint_noise: float = 0.03
    init_first: float = 0.0
    init_speed: float = 0.0
    init_spin: float = 0.0
    init_heading: float = 0.0
    steep: float = 0.0
    motors: bool = False
    evaluation: bool = False
