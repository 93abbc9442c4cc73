"""When a step is done: predicates over what was `Seen`, each of the simulated world alone."""

from collections.abc import Callable

import numpy as np

from studio import geometry
from studio.robot import a1
from studio.scenes.scene import Seen

Check = Callable[[Seen], bool]
PAWS = ("FR_foot", "FL_foot")
_STANDS = 0.18
"""m: a trunk that is higher is carried by legs; the lowest crouch has 0.185."""


def touched_by_paw(prop: str) -> Check:
    """A front paw touches the prop."""
    return lambda seen: any((prop, paw) in seen.touched for paw in PAWS)


def touched_by_robot(prop: str) -> Check:
    """Any part of the robot touches the prop."""
    return lambda seen: any(name == prop and other[:3] in _PARTS for name, other in seen.touched)


_PARTS = {*(f"{leg}_" for leg in a1.LEGS), "tru"}


def touches(prop: str, other: str) -> Check:
    """Two props touch."""
    return lambda seen: (prop, other) in seen.touched


def tilted(least_deg: float) -> Check:
    """On its legs, the trunk leans by at least so many degrees from level, whichever way."""
    least = np.cos(np.radians(least_deg))

    def check(seen: Seen) -> bool:
        up = float(geometry.up_in_body(seen.robot.base_quat)[2])
        on_four = seen.robot.foot_contact.all()
        return bool(on_four and seen.robot.base_pos[2] > _STANDS and np.cos(1.0) < up <= least)

    return check


def stands_near(x: float, y: float, radius: float) -> Check:
    """The trunk is within `radius` m of (x, y), and rests."""

    def check(seen: Seen) -> bool:
        robot = seen.robot
        near = np.hypot(*(robot.base_pos[:2] - [x, y])) <= radius
        return bool(near and np.hypot(*robot.base_lin_vel_w[:2]) < 0.1)

    return check


def past(x: float, y: tuple[float, float]) -> Check:
    """The trunk is beyond x m, and between y[0] and y[1] m."""
    return lambda seen: bool(seen.robot.base_pos[0] >= x and y[0] <= seen.robot.base_pos[1] <= y[1])


def prop_near(prop: str, x: float, y: float, radius: float) -> Check:
    """The prop's centre is within `radius` m of (x, y)."""
    return lambda seen: bool(np.hypot(*(seen.pos[prop][:2] - [x, y])) <= radius)


def dodged(seen: Seen) -> bool:
    """The ball has flown by."""
    return seen.dodged
