"""The geometry of the A1 in one place: legs, clearances between links, support of the feet."""

from studio.robot.collision import link_capsules, lowest_point, self_collision_distance
from studio.robot.legs import (
    center_of_mass_b,
    foot_pos_b,
    foot_pos_w,
    leg_ik,
    leg_jacobian,
    link_frames_b,
    link_frames_w,
    to_world,
)
from studio.robot.support import (
    along_gravity,
    support_distance,
)

__all__ = [
    "along_gravity",
    "center_of_mass_b",
    "foot_pos_b",
    "foot_pos_w",
    "leg_ik",
    "leg_jacobian",
    "link_capsules",
    "link_frames_b",
    "link_frames_w",
    "lowest_point",
    "self_collision_distance",
    "support_distance",
    "to_world",
]
