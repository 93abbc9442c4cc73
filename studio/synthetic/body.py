"""A body: segment lengths and the way its feet stand, drawn from anthropometric proportions."""

from dataclasses import dataclass

import numpy as np

# Segment lengths as shares of the stature, joint centre to joint centre
# (Drillis and Contini 1966, as tabulated in Winter, Biomechanics of Human Movement).
THIGH, SHIN, ANKLE_HEIGHT = 0.245, 0.246, 0.039
UPPER_ARM, FOREARM = 0.186, 0.146
TRUNK, NECK, HEAD = 0.285, 0.045, 0.072
HIP_HALF_WIDTH, SHOULDER_HALF_WIDTH = 0.052, 0.112
FOOT = 0.105  # ankle to the ball of the foot, along the floor


@dataclass(frozen=True, kw_only=True)
class Body:
    """Lengths in m, angles in rad.

    ankle_height, toe_height: above the sole, standing flat. foot: ankle to toe along the floor.
    stance_width: between the ankles. stance_ahead: the left foot ahead of the right. toe_out: each
    foot turned outwards.
    """

    height: float = 1.72
    thigh: float = 0.42
    shin: float = 0.42
    ankle_height: float = 0.07
    toe_height: float = 0.02
    foot: float = 0.18
    hip_half_width: float = 0.09
    trunk: float = 0.49
    neck: float = 0.08
    head: float = 0.12
    shoulder_half_width: float = 0.19
    upper_arm: float = 0.32
    forearm: float = 0.25
    stance_width: float = 0.24
    stance_ahead: float = 0.0
    toe_out: float = 0.17

    @staticmethod
    def sample(rng: np.random.Generator) -> "Body":
        """A grown-up between 1.50 and 1.95 m, each proportion within about 4 % of the mean."""
        height = float(np.clip(rng.normal(1.71, 0.10), 1.50, 1.95))

        def part(share: float, spread: float = 0.04) -> float:
            return float(height * share * (1.0 + np.clip(rng.normal(0.0, spread), -0.1, 0.1)))

        # Half of the people stand hip-wide, the others as wide as for exercises (CMU: .15 to .36).
        stance = rng.uniform(0.06, 0.17) if rng.random() < 0.5 else rng.uniform(0.15, 0.4)
        return Body(
            height=height,
            thigh=part(THIGH),
            shin=part(SHIN),
            ankle_height=part(ANKLE_HEIGHT, 0.1),
            toe_height=float(height * rng.uniform(0.004, 0.013)),
            foot=part(FOOT),
            hip_half_width=part(HIP_HALF_WIDTH, 0.07),
            trunk=part(TRUNK),
            neck=part(NECK),
            head=part(HEAD, 0.06),
            shoulder_half_width=part(SHOULDER_HALF_WIDTH, 0.06),
            upper_arm=part(UPPER_ARM),
            forearm=part(FOREARM),
            stance_width=float(height * stance),
            toe_out=float(np.radians(rng.uniform(0.0, 25.0))),
        )
