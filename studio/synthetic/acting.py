"""Acting: what is meant, as smoothed signals, becomes the posture of one person, habits and all."""

import numpy as np
from numpy.typing import NDArray

from studio.geometry.time_scaling import smoothstep
from studio.synthetic import signals as sig
from studio.synthetic.acting_arms import act_arms
from studio.synthetic.forward_kinematics import SIGN, Posture
from studio.synthetic.habits import Habits
from studio.synthetic.person import Person
from studio.synthetic.signals import leg_phase

Array = NDArray[np.float64]


def act(
    person: Person,
    s: Array,
    tempo: Array,
    walk: Array,
    pace: Array,
    circles: Array,
    body_sway: Array,
    arm_sway: Array,
    beat: Array,
    gesture: Array,
    gesture_weight: Array,
) -> tuple[Posture, Array]:
    """Posture of T frames of signal `s` (T, NUM), and (T, 2) how idle each arm is (right, left).

    tempo: (T,) strides per second of the march as a whole. walk, pace: (T,) in [0, 1], how much
    of a marcher's steps, and of a marcher's posture, has been taken up. circles: (T,) in [0, 1],
    how much walking is circling the hands instead of lifting the feet. The others are those of
    `idle.Sway` and `idle.IdleGestures`.
    """
    h = person.habits
    sit = s[:, sig.SIT]
    phase = s[:, sig.PHASE] + h.timing * beat
    bell, march = _steps(h, s, tempo, walk, phase)
    march = march * (1.0 - circles[:, None])
    trunk, pelvis = _trunk(h, s, pace, sit, body_sway, march, bell)
    trunk[:, 1] += pace * h.march_nod * np.sin(4.0 * np.pi * phase + h.nod_phase)
    knee, shank, heel, out = _knees(h, s, sit, body_sway[:, 7])
    lift, lift_knee, point = _lifts(h, s, bell, march)
    shift = np.stack(
        [
            h.shifts * body_sway[:, 0]
            - h.hips_back * np.sin(trunk[:, 1] - _lean(h, s, sit)) * (1.0 - sit),
            h.shifts * body_sway[:, 1]
            + (0.5 * h.hips_back - h.roll_hips) * np.sin(trunk[:, 0])
            - h.weight_shift * (_lead(h, tempo, phase) * SIGN).sum(axis=1) * march.max(axis=1),
        ],
        axis=-1,
    )
    arms, free, idle = act_arms(
        person, s, pace, circles, sit, phase, arm_sway, gesture, gesture_weight
    )
    turn_head = np.stack(
        [
            -h.head_share * 0.5 * trunk[:, 0],
            -h.head_share * trunk[:, 1] * 0.6 + h.looks * body_sway[:, 5],
            h.head_share * 0.3 * trunk[:, 2] + h.looks * body_sway[:, 6],
        ],
        axis=-1,
    )
    return (
        Posture(
            knee=knee,
            shank=shank,
            pelvis_shift=shift,
            # Whoever stands and circles the hands hardly bobs.
            pelvis_drop=(1.0 - 0.7 * circles)
            * (h.bob * pace * 0.5 * (1.0 - np.cos(4.0 * np.pi * phase))),
            pelvis_rpy=pelvis,
            trunk_rpy=trunk,
            head_rpy=turn_head,
            heel=heel,
            lift=lift,
            lift_knee=lift_knee,
            swing=np.minimum(4.0 * bell, 1.0) * march,
            tuck=h.tuck * bell**2 * march,
            point=point,
            knees_out=out[:, None] - h.step_in * bell * march,
            arms=arms,
            arm_free=free,
        ),
        idle,
    )


def marching(s: Array) -> Array:
    """(T,) in [0, 1]: 1 while the phase of a march goes on."""
    return s[:, sig.WALK] * smoothstep(s[:, sig.CADENCE] / 0.2)


def _share(h: Habits, tempo: Array) -> Array:
    """(T, 1) share of the stride that a foot swings: slow marchers pause between steps."""
    most = h.swing_share + h.jog_flight * smoothstep((tempo - 0.9) / 0.5)
    return np.clip(h.swing_s * tempo, 0.12, most)[:, None]


def _steps(h: Habits, s: Array, tempo: Array, walk: Array, phase: Array) -> tuple[Array, Array]:
    """(T, 2) how high each foot is in its swing, in [0, 1], and (T, 2) how much it marches."""
    u = np.clip(leg_phase(phase) / _share(h, tempo), 0.0, 1.0) ** h.step_skew
    wave = np.maximum(np.sin(np.pi * u), 0.0)
    held = smoothstep(h.step_hold * wave)
    bell = h.step_hold_share * held + (1.0 - h.step_hold_share) * wave ** (2.0 * h.step_shape)
    return bell, np.repeat((walk * smoothstep(s[:, sig.LIFT] / 0.1))[:, None], 2, axis=1)


def _lead(h: Habits, tempo: Array, phase: Array) -> Array:
    """(T, 2) weight to take off each foot: ahead of its swing and longer."""
    share = _share(h, tempo)
    u = np.clip((leg_phase(phase + 0.35 * share[:, 0]) / (1.7 * share)), 0.0, 1.0)
    return np.sin(np.pi * u) ** 2


def _lifts(h: Habits, s: Array, bell: Array, march: Array) -> tuple[Array, Array, Array]:
    """Thigh lift, knee flexion and toe pointing (T, 2) of the swinging legs."""
    share = np.maximum(s[:, sig.LIFT, None], 0.0) ** 0.7
    high = h.step_low + (h.step_high - h.step_low) * share
    # Nobody throws the knees up twice a second as high as once.
    high = high / (1.0 + 0.9 * np.maximum(s[:, sig.CADENCE, None] - 0.8, 0.0))
    lift = high * h.step_asymmetry * bell * march
    # A jog lifts the heel behind instead of the thigh in front.
    jog = smoothstep((s[:, sig.CADENCE, None] - 0.9) / 0.5) * np.maximum(1.2 - high, 0.0)
    # Twice the thigh's angle at first: the foot leaves the floor straight up instead of sliding.
    knee = lift * (2.0 - bell) + (h.shin_back + h.jog_kick * jog) * bell**2 * march
    return lift, np.maximum(knee, 0.35 * lift), np.full_like(lift, 0.5)


def _lean(h: Habits, s: Array, sit: Array) -> Array:
    """(T,) trunk lean that balance asks for: crouching, squatting, and on the way down or up."""
    dive = 4.0 * sit * (1.0 - sit) * h.squat_dive
    return h.crouch_lean * s[:, sig.CROUCH] * (1.0 - sit) + h.squat_lean * sit + dive


def _trunk(
    h: Habits, s: Array, pace: Array, sit: Array, sway: Array, march: Array, bell: Array
) -> tuple[Array, Array]:
    """Trunk and pelvis roll, pitch, yaw (T, 3) each."""
    stand_gain = np.repeat(h.gain[None], len(s), axis=0)
    gain = stand_gain + sit[:, None] * (h.sit_gain - stand_gain)
    tilt = s[:, sig.TILT]
    # Backwards a spine gives less; in sit both ways are the hips' doing.
    back = np.where(sit > 0.5, gain[:, 1], gain[:, 2])
    pitch_gain = np.where(tilt[:, 1] > 0.0, gain[:, 1], back)
    turn = s[:, sig.TURN] * s[:, sig.WALK]
    swing = (SIGN * bell * march).sum(axis=1)
    roll = gain[:, 0] * tilt[:, 0] + sway[:, 2] - h.turn_lean * turn + h.march_sway * swing
    pitch = h.slouch + pitch_gain * tilt[:, 1] + sway[:, 3] + _lean(h, s, sit)
    pitch = pitch + pace * (h.march_lean + 0.06 * s[:, sig.SPEED])
    yaw = gain[:, 3] * tilt[:, 2] + sway[:, 4] + h.turn_yaw * turn
    trunk = np.stack([roll, pitch, yaw + 0.8 * h.march_sway * swing], axis=-1)
    share = np.array([h.hips_roll, 0.0, h.hips_yaw])
    pelvis = trunk * share + sit[:, None] * h.squat_hips
    pelvis[:, 2] -= 1.2 * h.march_sway * swing
    return trunk, pelvis


def _knees(h: Habits, s: Array, sit: Array, sway: Array) -> tuple[Array, Array, Array, Array]:
    """Knee, shank, heel and knees-out angles (T,) of standing, crouching and squatting."""
    stand = h.knee_rest + (h.crouch_knee - h.knee_rest) * s[:, sig.CROUCH]
    deep = smoothstep(sit / 0.95)
    # Wobbling knees: both ways when bent, only ever bending further when nearly straight.
    sway = np.where(sway > 0.0, sway, sway * smoothstep((stand - 0.05) / 0.3))
    knee = stand + (h.squat_knee - stand) * sit + sway * (1.0 + 1.5 * sit)
    shank = h.shank_share * h.knee_rest + 0.48 * (stand - h.knee_rest)
    shank = shank + (h.squat_shank - shank) * sit
    bent = np.clip(knee / 1.8, 0.0, 1.0)
    return knee, shank, h.heels_up * deep**2, h.knees_out * bent
