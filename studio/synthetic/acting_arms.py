"""Acting with the arms: reaching, hanging, swinging along with the steps, circling the hands."""

import numpy as np
from numpy.typing import NDArray

from studio.geometry.time_scaling import smoothstep
from studio.synthetic import signals as sig
from studio.synthetic.forward_kinematics import SIGN
from studio.synthetic.habits import SQUAT_ARMS
from studio.synthetic.person import Person
from studio.synthetic.signals import leg_phase

Array = NDArray[np.float64]

FULL_BEND, ELBOW_BACK = np.radians(140.0), np.radians(-15.0)
"""Of an elbow that leads: flexion with the hand at the shoulder; the furthest back it goes."""


def act_arms(
    person: Person,
    s: Array,
    pace: Array,
    circles: Array,
    sit: Array,
    phase: Array,
    arm_sway: Array,
    gesture: Array,
    gesture_weight: Array,
) -> tuple[Array, Array, Array]:
    """Arm angles (T, 2, 4), freedom from the trunk (T, 2) and idleness (T, 2)."""
    h = person.habits
    reach = s[:, sig.REACH]
    active = smoothstep(reach / 0.25)
    idle_weight = gesture_weight * (1.0 - active)
    rest = h.hang + arm_sway
    if h.squat_arms != "hang" and np.isfinite(h.idle_gesture_gap_s):
        weight = sit[:, None] * (1.0 - active)
        rest = rest + weight[..., None] * (SQUAT_ARMS[h.squat_arms] - rest)
        squat_idle = weight
    else:
        squat_idle = np.zeros_like(reach)
    rest = rest + _march_arms(person, s, pace, circles, phase)
    rest = rest + idle_weight[..., None] * (gesture - rest)

    out = s[:, sig.SIDE] * SIGN  # > 0: outwards
    angle = np.where(out > 0.0, h.raise_side, 0.6) * out + h.raise_aside * (1.0 - np.abs(out))
    blend = active[..., None]
    top, flex = _raised(person, reach)
    twist = 0.1 - h.raise_elbow * (0.1 + angle)  # a leading forearm stays in the arm's plane
    raised = np.stack([top * np.cos(angle), top * np.sin(angle), twist, flex], axis=-1)
    arms = rest + blend * (raised + 0.5 * arm_sway - rest)
    arms[..., 3] = np.clip(arms[..., 3], 0.03, 2.6)
    free = h.arm_gravity + active * (h.raised_gravity - h.arm_gravity)
    # Who sits bent forward still reaches up to the ceiling.
    free = free + sit[:, None] * active * (0.7 - h.raised_gravity)
    free = free * (1.0 - idle_weight * smoothstep(gesture[..., :2].max(axis=-1)))
    return arms, free, np.maximum(idle_weight, squat_idle)


def _raised(person: Person, reach: Array) -> tuple[Array, Array]:
    """(T, 2) rad each: how far the upper arm is raised, and the elbow bent, to reach that high.

    With a bent elbow the wrist comes as high as that of a straight arm would, as far as it can.
    """
    h, upper, fore = person.habits, person.body.upper_arm, person.body.forearm
    top = h.raise_top * reach
    flex = h.raise_flex * (1.0 - 0.7 * reach**2)
    if h.raise_elbow == 0.0:
        return top, flex
    flex = flex + h.raise_elbow * np.sin(np.pi * reach) ** 2 * (FULL_BEND - flex)
    along, aside = upper + fore * np.cos(flex), fore * np.sin(flex)
    below = (upper + fore) * np.cos(top) / np.hypot(along, aside)
    bent = np.arccos(np.clip(below, -1.0, 1.0)) - np.arctan2(aside, along)
    return np.maximum(bent, ELBOW_BACK), flex


def _march_arms(person: Person, s: Array, pace: Array, circles: Array, phase: Array) -> Array:
    """(T, 2, 4) what marching adds to resting arms: a swing against the legs, or the circles."""
    h = person.habits
    turn = 2.0 * np.pi * leg_phase(phase)
    add = np.zeros((len(s), 2, 4))
    w = pace[:, None]
    # An arm goes forward with the other side's leg: against its own.
    beat = -np.sin(turn + 0.35)
    add[..., 0] = w * (h.arm_swing * beat + 0.3 * h.march_out)
    add[..., 1] = w * h.march_out
    add[..., 3] = w * (h.march_flex + 0.35 * h.arm_swing * beat)
    if not circles.any():
        return add
    rounds = w[..., None] * (_circles(person, s, turn) - h.hang)
    return add + circles[:, None, None] * (rounds - add)


def _circles(person: Person, s: Array, turn: Array) -> Array:
    """(T, 2, 4) arms whose hands go round in front of the body, forwards over the top, in turn.

    turn: (T, 2) rad, where each hand is on its way: 0 at the back of the circle, rising. The wrist
    goes round the place that `circle_arm` puts it, in the plane of the bent arm, by two-bone IK.
    The higher the step that is meant, the larger the circle.
    """
    h, upper, fore = person.habits, person.body.upper_arm, person.body.forearm
    at, bend = h.circle_arm[0], h.circle_arm[0] + h.circle_arm[3]
    centre = np.array(
        [upper * np.sin(at) + fore * np.sin(bend), -upper * np.cos(at) - fore * np.cos(bend)]
    )
    size = 0.35 + 0.65 * np.clip(s[:, sig.LIFT, None], 0.0, 1.0)
    radius = h.circle_size * upper * size * h.step_asymmetry
    # Nobody goes round evenly, or quite in a circle.
    turn = turn + 0.6 * (h.step_skew - 1.0) * np.sin(turn)
    tall = np.sqrt(h.step_shape)
    x = centre[0] - radius / tall * np.cos(turn)
    z = centre[1] + radius * tall * np.sin(turn)
    span = np.clip(np.hypot(x, z), 0.12, 0.98 * (upper + fore))
    flex = np.pi - np.arccos(
        np.clip((upper**2 + fore**2 - span**2) / (2.0 * upper * fore), -1.0, 1.0)
    )
    ahead = np.arctan2(x, -z) - np.arctan2(fore * np.sin(flex), upper + fore * np.cos(flex))
    arms = np.repeat(np.repeat(h.circle_arm[None, None], len(s), axis=0), 2, axis=1)
    arms[..., 0], arms[..., 3] = ahead, flex
    return arms
