"""The family "wide": people who move as far and as fast as those in a gymnasium.

Beside the default family's: deeper bends, wider twists, other stances, high knees, quick squats.
What real people were seen to do told which ranges to widen, and how far; no motion of theirs is in
here. For training: held-out people stay as they were, so that tables compare.
"""

from dataclasses import replace

import numpy as np

from studio.synthetic.body import Body
from studio.synthetic.exercises import Drill
from studio.synthetic.habits import Habits

DRILL = Drill(
    kinds=(
        "twist", "twist", "twist", "twist", "bend", "bend", "sides", "windmill", "windmill",
        "windmill", "windmill", "raise", "circle", "circle", "wave", "lunge",
    ),
    size=(0.8, 1.0),
    down=40.0,
    linger=0.8,
    period=(1.1, 4.0),
    full=0.9,
    rest=0.4,
)  # fmt: skip
"""Their exercises."""
SQUAT_HOLD_S = (0.3, 1.2)


def wide_body(rng: np.random.Generator, body: Body) -> Body:
    """The same body with limbs further from the mean, on feet set down as they come."""

    def spread() -> float:
        return float(np.exp(np.clip(rng.normal(0.0, 0.06), -0.12, 0.12)))

    stance = rng.uniform(0.05, 0.42)
    return replace(
        body,
        thigh=body.thigh * spread(),
        shin=body.shin * spread(),
        foot=body.foot * spread(),
        hip_half_width=body.hip_half_width * spread(),
        trunk=body.trunk * spread(),
        neck=body.neck * spread(),
        shoulder_half_width=body.shoulder_half_width * spread(),
        upper_arm=body.upper_arm * spread(),
        forearm=body.forearm * spread(),
        stance_width=float(body.height * stance),
        stance_ahead=float(body.height * np.clip(rng.normal(0.0, 0.05), -0.12, 0.12)),
        toe_out=float(np.radians(rng.uniform(-10.0, 40.0))),
    )


def wide_habits(rng: np.random.Generator, habits: Habits) -> Habits:
    """The same person's habits, in wider ranges where real people were seen to leave the usual."""

    def u(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    def deg(low: float, high: float) -> float:
        return float(np.radians(rng.uniform(low, high)))

    chair = habits.squat_knee < np.radians(98.0)
    return replace(
        habits,
        follow_s=u(0.06, 0.2),
        change_s=u(0.4, 1.0),
        slouch=deg(-8, 5),
        knee_rest=deg(2, 25),
        sway=u(0.4, 2.5),
        shifts=u(0.5, 4.0),
        looks=u(0.5, 4.0),
        gain=np.array([u(0.7, 1.6), u(1.8, 2.45), u(0.6, 1.4), u(1.8, 3.6)]),
        sit_gain=np.array([u(1.2, 2.6), u(1.3, 2.6), u(0.9, 2.0), u(1.6, 3.5)]),
        hips_yaw=u(0.3, 0.9),
        hips_roll=u(0.0, 0.6),
        hips_back=u(0.1, 0.4),
        roll_hips=u(-0.1, 0.25),
        head_share=u(-0.3, 0.8),
        squat_knee=habits.squat_knee if chair else deg(98, 140),
        squat_shank=habits.squat_shank if chair else deg(25, 55),
        squat_lean=habits.squat_lean if chair else deg(5, 50),
        squat_hips=np.radians([u(-3, 3), 0.0, u(-15, 15)]),
        knees_out=deg(0, 40),
        hang=habits.hang + np.radians([u(-25, 15), u(-5, 15), 0.0, u(0, 40)]),
        arm_gravity=u(0.0, 1.0),
        raise_flex=np.radians(rng.uniform(2, 60, 2)),
        step_low=deg(40, 88),
        step_high=deg(95, 125),
        step_hold=u(1.2, 2.2),
        step_hold_share=u(0.4, 1.0),
        swing_s=u(1.0, 2.0),
        step_asymmetry=1.0 + np.clip(rng.normal(0.0, 0.1, 2), -0.2, 0.2),
        swing_share=u(0.42, 0.475),
        shin_back=deg(-12, 40),
        jog_kick=deg(10, 90),
        arm_swing=deg(5, 80),
        march_flex=deg(5, 120),
        march_lean=deg(-10, 12),
        march_nod=deg(0, 11),
        nod_phase=u(0.0, 2.0 * np.pi),
        step_in=deg(-15, 50),
        tuck=u(0.2, 1.2),
        march_sway=deg(0, 28),
        idle_gesture_gap_s=u(2.0, 8.0),
    )
