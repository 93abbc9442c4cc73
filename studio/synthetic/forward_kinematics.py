"""Posture: joint angles and foot places of a person over time, and the joints they put in space."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.skeleton import INDEX, NUM_JOINTS
from studio.synthetic.body import Body

Array = NDArray[np.float64]

SIGN = np.array([-1.0, 1.0])  # y of the (right, left) side
_R = [INDEX[f"r_{j}"] for j in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")]
_L = [INDEX[f"l_{j}"] for j in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")]
_SIDES = np.array([_R, _L]).T  # (7, 2)
_HAND_CLEAR = 0.07  # m, wrists above the floor
_STRETCH = 0.9985  # of the leg's length: a knee never locks, so it never flips


@dataclass(frozen=True, kw_only=True)
class Posture:
    """T frames; pairs are (right, left); rad and m, in the person's heading frame, z up.

    knee, shank: (T,) flexion of both knees and forward lean of both shanks of the planted legs.
    pelvis_shift: (T, 2) m, forward and left, on top of what the legs say. pelvis_drop: (T,) m.
    pelvis_rpy, trunk_rpy, head_rpy: (T, 3). heel: (T,) both feet up on their toes.
    lift, lift_knee: (T, 2) thigh and knee flexion that a swinging leg adds. swing: (T, 2) in
    [0, 1], how much a foot is off the floor. tuck: (T, 2) share of the way it comes in under its
    hip. point: (T, 2) toes pointed down in swing. knees_out: (T, 2).
    arms: (T, 2, 4) upper arm raised forward, outward, twist of the upper arm, elbow flexion.
    arm_free: (T, 2) share of the trunk's roll and pitch that the hanging arm does not follow.
    """

    knee: Array
    shank: Array
    pelvis_shift: Array
    pelvis_drop: Array
    pelvis_rpy: Array
    trunk_rpy: Array
    head_rpy: Array
    heel: Array
    lift: Array
    lift_knee: Array
    swing: Array
    tuck: Array
    point: Array
    knees_out: Array
    arms: Array
    arm_free: Array


def _rotate(rpy: Array, v: Array) -> Array:
    return geometry.quat_rotate(geometry.quat_from_rpy(rpy), v)


def joints(body: Body, posture: Posture) -> Array:
    """(T, 19, 3) m joints of postures, the middle between the feet at x = y = 0, floor at z = 0."""
    steps = len(posture.knee)
    out = np.empty((steps, NUM_JOINTS, 3))
    pelvis = _legs(body, posture, out)
    up = np.array([0.0, 0.0, 1.0])
    trunk_quat = geometry.quat_from_rpy(posture.trunk_rpy)
    chest = pelvis + body.trunk * geometry.quat_rotate(trunk_quat, np.broadcast_to(up, (steps, 3)))
    # As every source is mapped: the neck lies on the line from chest to head.
    head_dir = np.broadcast_to(geometry.normalize([0.1, 0.0, 1.0]), (steps, 3))
    to_head = _rotate(posture.trunk_rpy + posture.head_rpy, head_dir)
    neck, head = chest + body.neck * to_head, chest + (body.neck + body.head) * to_head
    trunk = ("pelvis", pelvis), ("spine", 0.5 * (pelvis + chest)), ("chest", chest)
    for name, pos in (*trunk, ("neck", neck), ("head", head)):
        out[:, INDEX[name]] = pos
    _arms(body, posture, chest, trunk_quat, out)
    return out


def _legs(body: Body, p: Posture, out: Array) -> Array:
    """Fill hips to toes by two-bone IK from planted or swinging feet; returns the pelvis (T, 3)."""
    steps = len(p.knee)
    rise = body.ankle_height - body.toe_height
    toe_out = -SIGN * -body.toe_out  # left foot turns left (+), right foot right (-)
    along = np.stack([np.cos(toe_out), np.sin(toe_out), np.zeros(2)], axis=-1)  # (2, 3)
    flat_ankle = np.zeros((2, 3))
    flat_ankle[:, 0] = SIGN * 0.5 * body.stance_ahead
    flat_ankle[:, 1] = SIGN * 0.5 * body.stance_width
    toe_xy = flat_ankle + body.foot * along
    # Heels up: the ankle turns about the toe, which stays where it is.
    c, s = np.cos(p.heel)[:, None, None], np.sin(p.heel)[:, None, None]
    planted = toe_xy + (-body.foot * c + rise * s) * along
    planted[..., 2] = body.toe_height + (body.foot * s + rise * c)[..., 0]

    # The pelvis that the knee and ankle angles of both legs agree on, in the sagittal plane.
    x = body.shin * np.sin(p.shank) - body.thigh * np.sin(p.knee - p.shank)
    z = body.shin * np.cos(p.shank) + body.thigh * np.cos(p.knee - p.shank)
    length_sq = x**2 + z**2
    pelvis = np.empty((steps, 3))
    pelvis[:, 0] = x + p.pelvis_shift[:, 0] + planted[..., 0].mean(axis=1)
    pelvis[:, 1] = p.pelvis_shift[:, 1]
    half = np.zeros((steps, 2, 3))
    half[..., 1] = SIGN * body.hip_half_width
    hip_rel = _rotate(np.repeat(p.pelvis_rpy[:, None], 2, axis=1), half)
    gap = pelvis[:, None, :2] + hip_rel[..., :2] - planted[..., :2]
    gap_sq = np.sum(gap**2, axis=-1)
    wanted = np.sqrt(np.maximum(length_sq - gap_sq.mean(axis=1), (0.2 * body.shin) ** 2))
    wanted = wanted + planted[:, 0, 2] - p.pelvis_drop
    reach = np.sqrt(np.maximum((_STRETCH * (body.thigh + body.shin)) ** 2 - gap_sq, 1e-4))
    limit = planted[..., 2] + reach - hip_rel[..., 2] + 10.0 * p.swing
    pelvis[:, 2] = np.minimum(wanted, limit.min(axis=1))
    hip = pelvis[:, None] + hip_rel

    # A lifted leg: what thigh and knee flexion do to a straight leg is added to the planted ankle.
    shin_at = p.lift - p.lift_knee
    forward = body.thigh * np.sin(p.lift) + body.shin * np.sin(shin_at)
    upward = body.thigh * (1 - np.cos(p.lift)) + body.shin * (1 - np.cos(shin_at))
    face = np.stack(
        [np.cos(p.pelvis_rpy[:, 2]), np.sin(p.pelvis_rpy[:, 2]), np.zeros(steps)], axis=-1
    )
    ankle = planted + forward[..., None] * face[:, None]
    ankle[..., 2] += np.maximum(upward, 0.0)
    ankle[..., 1] += p.tuck * (hip[..., 1] - planted[..., 1])
    knee, ankle = _bend(hip, ankle, _knee_axis(toe_out, p, steps), body)

    # The swinging foot hangs by its toes as far as the floor lets it.
    high = ankle[..., 2] - planted[..., 2]
    pitch = np.minimum(p.point * p.swing, np.arcsin(np.clip(high / body.foot, 0.0, 1.0)))
    pitch = pitch + p.heel[:, None]
    cp, sp = np.cos(pitch)[..., None], np.sin(pitch)[..., None]
    yaw = toe_out + p.swing * p.pelvis_rpy[:, None, 2]
    ahead = np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=-1)
    toe = ankle + (body.foot * cp - rise * sp) * ahead
    toe[..., 2] = ankle[..., 2] - (body.foot * sp + rise * cp)[..., 0]
    for row, pos in zip(_SIDES[3:], (hip, knee, ankle, toe)):
        out[:, row] = pos
    return pelvis


def _knee_axis(toe_out: Array, p: Posture, steps: int) -> Array:
    """(T, 2, 3) axis about which each knee bends: leftwards, turned with foot and pelvis."""
    yaw = 0.5 * toe_out + 0.5 * p.pelvis_rpy[:, None, 2] + SIGN * p.knees_out
    return np.stack([-np.sin(yaw), np.cos(yaw), np.zeros((steps, 2))], axis=-1)


def _bend(hip: Array, ankle: Array, axis: Array, body: Body) -> tuple[Array, Array]:
    """Knee and reached ankle of a two-bone leg whose knee points forward (law of cosines)."""
    d = ankle - hip
    dist = np.linalg.norm(d, axis=-1, keepdims=True)
    most, least = body.thigh + body.shin, 0.25 * (body.thigh + body.shin)
    span = np.clip(dist, least, 0.9999 * most)
    d = d / np.maximum(dist, 1e-9)
    along = (body.thigh**2 - body.shin**2 + span**2) / (2.0 * span)
    aside = np.sqrt(np.maximum(body.thigh**2 - along**2, 0.0))
    knee = hip + along * d + aside * geometry.normalize(np.cross(d, axis))
    return knee, hip + span * d


def _arms(body: Body, p: Posture, chest: Array, trunk_quat: Array, out: Array) -> None:
    """Fill shoulders to wrists: raise (forward, outward), twist about the bone, bend the elbow."""
    steps = len(chest)
    half = np.zeros((steps, 2, 3))
    half[..., 1] = SIGN * body.shoulder_half_width
    shoulder = chest[:, None] + geometry.quat_rotate(trunk_quat[:, None], half)
    fwd, side, twist, flex = np.moveaxis(p.arms, -1, 0)
    zero = np.zeros_like(fwd)
    # Rotation vector that takes "down" towards (fwd, side): down x (fwd, side, 0).
    raise_vec = np.stack([SIGN * side, -fwd, zero], axis=-1)
    raise_quat = geometry.quat_from_rotvec(raise_vec)
    follow = p.trunk_rpy[:, None] * np.stack(
        [1.0 - p.arm_free, 1.0 - p.arm_free, np.ones_like(p.arm_free)], axis=-1
    )
    arm_quat = geometry.quat_mul(geometry.quat_from_rpy(follow), raise_quat)
    down = np.zeros((steps, 2, 3))
    down[..., 2] = -1.0
    bent = np.stack(
        [np.sin(flex) * np.cos(twist), -SIGN * np.sin(flex) * np.sin(twist), -np.cos(flex)],
        axis=-1,
    )
    elbow = shoulder + body.upper_arm * geometry.quat_rotate(arm_quat, down)
    wrist = elbow + body.forearm * geometry.quat_rotate(arm_quat, bent)
    elbow, wrist = _off_the_floor(shoulder, elbow, wrist)
    for row, pos in zip(_SIDES[:3], (shoulder, elbow, wrist)):
        out[:, row] = pos


def _off_the_floor(shoulder: Array, elbow: Array, wrist: Array) -> tuple[Array, Array]:
    """Arms (T, 2, 3) that would hang through the floor, swung forward about the shoulder."""
    if wrist[..., 2].min() >= _HAND_CLEAR:
        return elbow, wrist
    arm = wrist - shoulder
    length = np.linalg.norm(arm, axis=-1)
    drop = -arm[..., 2]
    allowed = np.minimum(drop, np.maximum(shoulder[..., 2] - _HAND_CLEAR, 0.0))
    angle = np.arccos(allowed / length) - np.arccos(drop / length)
    ahead = geometry.normalize(arm[..., :2] + [0.02, 0.0])
    axis = np.stack([ahead[..., 1], -ahead[..., 0], np.zeros_like(angle)], axis=-1)
    quat = geometry.quat_from_axis_angle(axis, angle)
    return (
        shoulder + geometry.quat_rotate(quat, elbow - shoulder),
        shoulder + geometry.quat_rotate(quat, arm),
    )
