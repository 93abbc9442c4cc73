"""How one person moves: posture, tempo, steps, arms; drawn from a seed, in two ways of moving."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def _pair(x: float = 0.0) -> Array:
    return np.full(2, x)


# Arms while squatting, (fwd, out, twist, flex); "hang" is the person's own way.
SQUAT_ARMS: dict[str, Array] = {
    "hang": np.zeros(4),
    "forward": np.radians([75.0, 8.0, 5.0, 10.0]),
    "clasp": np.radians([30.0, 25.0, 45.0, 110.0]),
    "hips": np.radians([-15.0, 42.0, 50.0, 95.0]),
    "overhead": np.radians([75.0, 105.0, 0.0, 20.0]),
}


@dataclass(frozen=True, kw_only=True)
class Habits:
    """How one person moves. Angles in rad; pairs are (right, left); arms (fwd, out, twist, flex).

    Gains turn the robot's tilt into the person's: roll, forward, backward, yaw; `sit_gain` the
    same while sitting. `hips_*`: share of a twist or side bend that the pelvis takes.
    """

    # movement
    profile: str = "minimum_jerk"
    follow_s: float = 0.13  # duration of the movement that answers a step of the intent
    change_s: float = 1.0  # duration of a change of state
    # standing
    slouch: float = 0.05
    knee_rest: float = 0.10
    shank_share: float = 0.5  # share of the resting knee's angle that the ankle takes
    sway: float = 1.0
    lively: float = 0.2  # jiggling, bouncing and swinging along, from 0 to 1
    facing: float = 0.0
    shifts: float = 1.0  # how far the hips wander, beside the rest of the sway
    looks: float = 1.0  # how far the head does
    # trunk
    gain: Array = field(default_factory=lambda: np.array([0.9, 1.9, 0.9, 1.4]))
    sit_gain: Array = field(default_factory=lambda: np.array([1.8, 2.0, 1.6, 2.5]))
    hips_yaw: float = 0.4
    hips_roll: float = 0.3
    hips_back: float = 0.30  # m the pelvis goes back in a full bend
    roll_hips: float = 0.0  # m the hips go along in a side bend: all of it, a side lunge
    head_share: float = 0.4
    # legs
    crouch_knee: float = 1.08
    crouch_lean: float = 0.25
    squat_knee: float = 1.9
    squat_shank: float = 0.5
    squat_lean: float = 0.5
    squat_dive: float = 0.3  # extra lean half way down
    heels_up: float = 0.0
    squat_hips: Array = field(default_factory=lambda: np.zeros(3))  # turned by so much, when deep
    knees_out: float = 0.1
    squat_arms: str = "hang"
    # arms
    hang: Array = field(default_factory=lambda: np.array([0.05, 0.15, 0.2, 0.3]))
    arm_gravity: float = 0.7
    raised_gravity: float = 0.2
    raise_top: Array = field(default_factory=lambda: _pair(2.95))
    raise_side: float = 1.35
    raise_flex: Array = field(default_factory=lambda: _pair(0.25))
    raise_aside: Array = field(default_factory=_pair)  # raises a little outwards anyway
    raise_elbow: float = 0.0  # from 0, the arm swings up, to 1: the elbow bends, then opens
    # marching
    step_low: float = 0.55
    step_high: float = 1.75
    step_hold: float = 1.3  # > 1 keeps the knee up for a while; counts with step_hold_share
    step_hold_share: float = 0.7
    step_shape: float = 1.0  # the rest: > 1 lingers at the bottom, < 1 at the top
    step_skew: float = 1.0
    step_asymmetry: Array = field(default_factory=lambda: _pair(1.0))
    swing_share: float = 0.46
    jog_flight: float = 0.05  # more of it when jogging: both feet leave the floor
    swing_s: float = 1.2  # longest time a foot stays up; the rest of the stride is a pause
    shin_back: float = 0.1  # knee flexion beyond the thigh's lift
    jog_kick: float = 0.8
    arm_swing: float = 0.4
    march_flex: float = 0.5
    march_out: float = 0.05
    march_lean: float = 0.03
    march_nod: float = 0.0  # the trunk rocks forward and back at every step
    nod_phase: float = 0.0
    step_in: float = 0.0  # a lifted knee points inwards
    tuck: float = 0.5  # share of the way that a lifted foot comes in under its hip
    weight_shift: float = 0.035
    bob: float = 0.02
    march_sway: float = 0.04
    turn_yaw: float = 2.0  # rad of trunk per rad/s of turn
    turn_lean: float = 0.2
    timing: float = 0.01  # strides, wander of the step's timing
    circle_arm: Array = field(default_factory=lambda: np.array([0.6, 0.2, 0.2, 1.3]))
    circle_size: float = 0.45
    # what the intent does not ask for
    idle_gesture_gap_s: float = 6.0
    idle_gestures: tuple[str, ...] = ()  # which of `idle.GESTURES`; none: any


def draw_habits(rng: np.random.Generator) -> Habits:
    def u(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    def deg(low: float, high: float) -> float:
        return float(np.radians(rng.uniform(low, high)))

    chair = rng.random() < 0.3
    straight = rng.random() < 0.6
    spread = deg(4, 20) if rng.random() < 0.8 else deg(20, 38)
    return Habits(
        follow_s=u(0.08, 0.22),
        change_s=u(0.7, 1.5),
        slouch=deg(-3, 10),
        knee_rest=deg(3, 24),
        shank_share=u(0.4, 0.75),
        sway=u(0.4, 1.8),
        lively=float(rng.beta(0.8, 1.6)),
        facing=float(np.clip(rng.normal(0.0, 0.1), -0.25, 0.25)),
        gain=np.array([u(0.65, 1.1), u(1.3, 2.2), u(0.6, 1.0), u(1.0, 2.3)]),
        sit_gain=np.array([u(1.2, 2.2), u(1.3, 2.4), u(0.9, 1.8), u(1.6, 3.5)]),
        hips_yaw=float(rng.choice([u(0.0, 0.2), u(0.3, 0.7)])),
        hips_roll=u(0.0, 0.5),
        hips_back=u(0.15, 0.35),
        head_share=u(-0.2, 0.7),
        crouch_knee=deg(48, 69),
        crouch_lean=deg(0, 25),
        squat_knee=deg(92, 103) if chair else deg(98, 146),
        squat_shank=deg(-8, 10) if chair else deg(18, 40),
        squat_lean=deg(-5, 18) if chair else deg(18, 50),
        squat_dive=deg(10, 35) if chair else deg(0, 15),
        heels_up=deg(5, 30) if not chair and rng.random() < 0.3 else 0.0,
        knees_out=deg(0, 25),
        squat_arms=str(rng.choice(list(SQUAT_ARMS), p=[0.4, 0.2, 0.2, 0.1, 0.1])),
        hang=np.array([deg(-10, 15), spread, deg(0, 45), deg(5, 40) + 1.2 * (spread - 0.2)]),
        arm_gravity=u(0.3, 1.0),
        raised_gravity=u(0.0, 0.4),
        raise_top=np.radians(rng.uniform(158, 178) + rng.uniform(-4, 4, 2)),
        raise_side=deg(65, 90),
        raise_flex=np.radians((u(3, 25) if straight else u(30, 80)) + rng.uniform(0, 8, 2)),
        raise_aside=np.radians(rng.uniform(-8, 18, 2)),
        step_low=deg(26, 40),
        step_high=deg(80, 110),
        step_hold=u(1.0, 1.7),
        step_hold_share=u(0.3, 1.0),
        step_shape=u(0.75, 1.2),
        step_skew=u(0.85, 1.15),
        step_asymmetry=1.0 + np.clip(rng.normal(0.0, 0.06, 2), -0.15, 0.15),
        swing_share=u(0.40, 0.47),
        swing_s=u(0.8, 1.8),
        jog_flight=u(0.0, 0.12),
        shin_back=deg(-12, 25),
        jog_kick=deg(10, 70),
        arm_swing=deg(0, 45) if rng.random() < 0.75 else 0.0,
        march_flex=deg(5, 110),
        march_out=deg(0, 10) if rng.random() < 0.6 else deg(10, 40),
        march_lean=deg(-6, 12),
        tuck=u(0.2, 0.9),
        weight_shift=u(0.01, 0.06),
        bob=u(0.0, 0.035),
        march_sway=deg(0, 12),
        turn_yaw=u(1.4, 3.0),
        turn_lean=u(-0.2, 0.5) if rng.random() < 0.65 else u(0.6, 1.4),
        timing=u(0.0, 0.02),
        circle_arm=np.array([deg(20, 50), deg(5, 20), deg(0, 30), deg(60, 95)]),
        circle_size=deg(14, 32),
        idle_gesture_gap_s=u(3.0, 15.0),
    )


def held_out_habits(rng: np.random.Generator, habits: Habits) -> Habits:
    """The held-out family: other speed profiles, step waveforms, squats and arm paths."""

    def u(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    def deg(low: float, high: float) -> float:
        return float(np.radians(rng.uniform(low, high)))

    return replace(
        habits,
        profile=str(rng.choice(["trapezoid", "hasty"])),
        follow_s=u(0.15, 0.35),
        change_s=u(0.6, 1.0) if rng.random() < 0.5 else u(1.4, 2.0),
        step_hold_share=0.0,
        step_shape=float(rng.choice([u(0.6, 0.7), u(1.4, 1.9)])),
        step_skew=float(rng.choice([u(0.7, 0.8), u(1.25, 1.5)])),
        swing_share=u(0.36, 0.46),
        shin_back=deg(20, 45),
        squat_knee=deg(95, 118),
        squat_shank=deg(5, 25),
        squat_lean=deg(30, 60),
        squat_dive=deg(15, 40),
        knees_out=deg(20, 40),
        heels_up=deg(0, 35) if rng.random() < 0.4 else 0.0,
        raise_flex=np.radians(rng.uniform(60, 110, 2)),
        raise_aside=np.radians(rng.uniform(15, 40, 2)),
        hips_back=u(0.05, 0.2),
        hips_yaw=u(0.5, 0.9),
    )
