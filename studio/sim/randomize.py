"""Table I of the paper: how the dynamics of each simulation are drawn."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.robot import a1

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Ranges:
    """Full ranges; a scale in [0, 1] shrinks them towards the nominal robot.

    mass, kp, kd: factors of the default (mass: each link on its own, its inertia with it).
    friction: sliding coefficient between foot and ground. delay: s before a new target reaches
    the motors. slope: rad of the ground, in any direction. period: relative change of every
    control period (the paper names it among its limitations).
    """

    mass: tuple[float, float] = (0.75, 1.25)
    friction: tuple[float, float] = (0.5, 1.5)
    kp: tuple[float, float] = (0.7, 1.3)
    kd: tuple[float, float] = (0.7, 1.3)
    delay: tuple[float, float] = (0.0, 0.016)
    slope: tuple[float, float] = (0.0, 0.14)
    period: float = 0.1


TABLE_I = Ranges()
NOMINAL_FRICTION = 1.0
ARMATURES, DAMPINGS, STRENGTHS = (0.0, 0.02), (0.0, 0.4), (0.8, 1.1)
"""kg m^2, N m s/rad and shares of the torque limit that motors may have: not in Table I, which the
robot of another simulator is not in either (the same policy fell there in slow trots)."""
STEEP = (0.75, 1.1)
"""Shares of Table I's largest slope: beyond its end too, so that the end itself is met often."""


@dataclass(frozen=True, kw_only=True)
class Dynamics:
    """Drawn dynamics of N simulations.

    mass: (N, B) factor per link. friction: (N,). kp, kd: (N,) factors. delay: (N,) s.
    slope_axis: (N, 2) rad, rotation vector of the ground about world x and y. period: relative
    jitter of the control period, drawn anew every step within ± this. armature: (N,) kg m^2 of
    each rotor at its joint. damping: (N,) N m s/rad of each joint. strength: (N,) factor of the
    torque limits. These three: None for the nominal robot's.
    """

    mass: Array
    friction: Array
    kp: Array
    kd: Array
    delay: Array
    slope_axis: Array
    period: float
    armature: Array | None = None
    damping: Array | None = None
    strength: Array | None = None

    def __len__(self) -> int:
        return len(self.friction)

    def motors(self, nominal_armature: float = a1.ARMATURE) -> tuple[Array, Array, Array]:
        """armature (N,) kg m^2, damping (N,) N m s/rad and torque limits (N, 12) N m: those drawn,
        else the nominal robot's."""
        n = len(self)
        strength = np.ones(n) if self.strength is None else self.strength
        return (
            np.full(n, nominal_armature) if self.armature is None else self.armature,
            np.zeros(n) if self.damping is None else self.damping,
            strength[:, None] * a1.TORQUE_LIMIT,
        )


def draw(
    rng: np.random.Generator, num: int, num_links: int, scale: float = 1.0, ranges: Ranges = TABLE_I
) -> Dynamics:
    """`num` uniform draws of Table I, its ranges `scale` times as wide about the nominal values."""

    def around(low_high: tuple[float, float], nominal: float, *shape: int) -> Array:
        return _around(rng, low_high, nominal, scale, (num, *shape))

    slope = around(ranges.slope, 0.0)
    direction = rng.uniform(0.0, 2.0 * np.pi, num)
    return Dynamics(
        mass=around(ranges.mass, 1.0, num_links),
        friction=around(ranges.friction, NOMINAL_FRICTION),
        kp=around(ranges.kp, 1.0),
        kd=around(ranges.kd, 1.0),
        delay=around(ranges.delay, 0.0),
        slope_axis=np.stack([np.cos(direction), np.sin(direction)], axis=-1) * slope[:, None],
        period=ranges.period * scale,
    )


def steepened(
    drawn: Dynamics, rng: np.random.Generator, share: float, scale: float = 1.0
) -> Dynamics:
    """The same dynamics with a share of the slopes redrawn, in any direction, from STEEP."""
    chosen = rng.random(len(drawn)) < share
    size = scale * TABLE_I.slope[1] * rng.uniform(*STEEP, len(drawn))
    direction = rng.uniform(0.0, 2.0 * np.pi, len(drawn))
    steep = np.stack([np.cos(direction), np.sin(direction)], axis=-1) * size[:, None]
    return replace(drawn, slope_axis=np.where(chosen[:, None], steep, drawn.slope_axis))


def with_motors(drawn: Dynamics, rng: np.random.Generator, scale: float = 1.0) -> Dynamics:
    """The same dynamics with motors of their own, the ranges shrunk by `scale` about nominal."""

    def around(low_high: tuple[float, float], nominal: float) -> Array:
        return _around(rng, low_high, nominal, scale, (len(drawn),))

    return replace(
        drawn,
        armature=around(ARMATURES, a1.ARMATURE),
        damping=around(DAMPINGS, 0.0),
        strength=around(STRENGTHS, 1.0),
    )


def _around(
    rng: np.random.Generator,
    low_high: tuple[float, float],
    nominal: float,
    scale: float,
    shape: tuple[int, ...],
) -> Array:
    low, high = (nominal + scale * (bound - nominal) for bound in low_high)
    return rng.uniform(low, high, shape)


def gravity(slope_axis: Array, g: float = a1.GRAVITY) -> Array:
    """(N, 3) m/s^2, gravity in the frame of the ground, for slopes as rotation vectors (N, 2) rad.

    A plane tilted by R is the same world as a level plane under gravity R^T g.
    """
    angle = np.linalg.norm(slope_axis, axis=-1)
    unit = slope_axis / np.maximum(angle, 1e-12)[:, None]
    # R^T (0, 0, -g) about a horizontal unit axis (ux, uy): Rodrigues on the z axis.
    s, c = np.sin(angle), np.cos(angle)
    return g * np.stack([s * unit[:, 1], -s * unit[:, 0], -c], axis=-1)
