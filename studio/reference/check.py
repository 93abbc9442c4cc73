"""Is a reference motion fit to be tracked? The list of what is wrong with it, empty if nothing is.

Joint and speed limits, no self-collision, no foot below the floor, standing feet that stand on it
and do not slide, and balance where the robot must be balanced: the centre of mass within the feet
(and sitting calves) while standing or sitting, the zero moment point while crawling.
"""

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.reference import stances
from studio.reference.motion import ReferenceMotion, backward_difference
from studio.robot import a1, kinematics

Array = NDArray[np.float64]

PENETRATION = 0.002
STANDING = 0.003
SLIDING = 0.02
"""m, m and m/s: soles below the floor, above it while in full contact, sliding in full contact."""
BALANCE = 0.005
"""m: how far outside its support the centre of mass (standing, sitting) may lie."""
ZMP_BALANCE = 0.04
"""m: how far outside the feet the zero moment point of a crawl may lie, while three feet stand."""
_FULL = 0.97  # contact label of a foot that stands
_LIMIT_SLACK = 1e-6


def check(motion: ReferenceMotion) -> list[str]:
    """Problems of a motion, one line each."""
    feet = kinematics.foot_pos_w(motion.base_pos, motion.base_quat, motion.joint_pos)
    return [
        *_joints(motion),
        *_collision(motion),
        *_feet(motion, feet),
        *_balance(motion, feet),
    ]


def _joints(motion: ReferenceMotion) -> list[str]:
    out = []
    q = motion.joint_pos
    beyond = np.maximum(a1.JOINT_LOWER - q, q - a1.JOINT_UPPER)
    if not np.all(np.isfinite(q)):
        return ["joint angles are not finite"]
    if np.max(beyond) > _LIMIT_SLACK:
        frame, joint = np.unravel_index(np.argmax(beyond), beyond.shape)
        out.append(f"{a1.JOINTS[joint]} is {np.max(beyond):.3f} rad past its limit at {frame}")
    speed, limit = np.abs(motion.joint_vel), stances.JOINT_SPEED[motion.state]
    if np.max(speed) > limit:
        frame, joint = np.unravel_index(np.argmax(speed), speed.shape)
        out.append(
            f"{a1.JOINTS[joint]} turns at {np.degrees(np.max(speed)):.0f} of "
            f"{np.degrees(limit):.0f} degrees a second at {frame}"
        )
    return out


def _collision(motion: ReferenceMotion) -> list[str]:
    gap = kinematics.self_collision_distance(motion.joint_pos)
    if np.min(gap) < 0.0:
        return [f"links overlap by {-np.min(gap):.3f} m at {np.argmin(gap)}"]
    return []


def _feet(motion: ReferenceMotion, feet: Array) -> list[str]:
    out = []
    sole = feet[..., 2] - a1.FOOT_RADIUS
    if np.min(sole) < -PENETRATION:
        frame, leg = np.unravel_index(np.argmin(sole), sole.shape)
        out.append(f"foot {a1.LEGS[leg]} is {-np.min(sole):.4f} m below the floor at {frame}")
    stands = motion.foot_contact >= _FULL
    above = np.where(stands, sole, 0.0)
    if np.max(above) > STANDING:
        frame, leg = np.unravel_index(np.argmax(above), above.shape)
        out.append(f"foot {a1.LEGS[leg]} stands {np.max(above):.4f} m above the floor at {frame}")
    slide = np.linalg.norm(backward_difference(feet[..., :2], motion.dt), axis=-1)
    down = stands & (sole < 5e-4)  # not the first moment of a swing
    slide = np.where(down & np.concatenate([down[:1], down[:-1]]), slide, 0.0)
    if np.max(slide) > SLIDING:
        frame, leg = np.unravel_index(np.argmax(slide), slide.shape)
        out.append(f"standing foot {a1.LEGS[leg]} slides at {np.max(slide):.3f} m/s at {frame}")
    return out


def _balance(motion: ReferenceMotion, feet: Array) -> list[str]:
    com_b = kinematics.center_of_mass_b(motion.joint_pos)
    com = motion.base_pos + geometry.quat_rotate(motion.base_quat, com_b)
    if motion.state == "walk":
        return _zmp_balance(motion, feet, com)
    support, on = feet[..., :2], motion.foot_contact > 0.5
    if motion.state == "sit":  # on rear feet and knees, the calves between them
        knees = knee_pos_w(motion.base_pos, motion.base_quat, motion.joint_pos)[:, 2:]
        support = np.concatenate([support[:, 2:], knees[..., :2]], axis=1)
        low = knees[..., 2] < sit_knee_height() + 0.02
        on = np.concatenate([on[:, 2:], low], axis=1)
    few = np.sum(on, axis=-1) < 3
    if np.any(few):
        return [f"only {np.sum(on[np.argmax(few)])} supports at {np.argmax(few)}"]
    outside = kinematics.support_distance(com[:, :2], support, on)
    if np.max(outside) > BALANCE:
        return [f"centre of mass {np.max(outside):.3f} m outside at {np.argmax(outside)}"]
    return []


def _zmp_balance(motion: ReferenceMotion, feet: Array, com: Array) -> list[str]:
    """While three or four feet stand, the ZMP x - h / g x'' lies near their hull.

    Averaged over 0.1 s: it is a second difference of a motion whose speed may step.
    """
    if len(motion) < 5:
        return []
    acc = np.zeros_like(com)
    acc[1:-1] = (com[2:] - 2.0 * com[1:-1] + com[:-2]) / motion.dt**2
    kernel = np.ones(5) / 5.0
    acc = np.stack([np.convolve(acc[:, k], kernel, mode="same") for k in range(3)], axis=-1)
    zmp = com[:, :2] - com[:, 2:] / a1.GRAVITY * acc[:, :2]
    on = feet[..., 2] - a1.FOOT_RADIUS < 1e-3
    outside = np.where(
        np.sum(on, axis=-1) >= 3, kinematics.support_distance(zmp, feet[..., :2], on), 0.0
    )
    if np.max(outside) > ZMP_BALANCE:
        return [f"zero moment point {np.max(outside):.3f} m outside at {np.argmax(outside)}"]
    return []


def knee_pos_w(base_pos: Array, base_quat: Array, joint_pos: Array) -> Array:
    """Knees (..., 4, 3) m in the world."""
    return kinematics.link_frames_w(base_pos, base_quat, joint_pos)[0][..., 3::3, :]


def sit_knee_height() -> float:
    """Height m of a rear knee in neutral sitting."""
    p = stances.NEUTRAL["sit"]
    return float(knee_pos_w(p.base_pos, p.base_quat, p.joint_pos)[2, 2])
