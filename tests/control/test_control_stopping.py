"""A walk comes to rest in steps: ever slower; what stands does not slide, no joint hurries."""

import numpy as np
import pytest

from studio.control.drive_command import Directive
from studio.control.footing import feet_w
from studio.control.state_machine import SPEED_LIMIT, StateMachine
from studio.control.stopping import BRAKING, IN_THE_AIR, PUT_DOWN_PERIODS, in_the_air
from studio.reference import gait
from studio.reference.marching import Bout, march_track
from studio.reference.realize import realize
from studio.robot import a1


def halted(speed, seconds, turn=0.0, directive=Directive.STAND):
    """(references while walking, references from the halt on) of a robot that walked `seconds`."""
    cadence = 1.7 if speed < 0.7 else 2.2
    bout = Bout(
        half_strides=int(2.0 * seconds * cadence) + 4,
        cadence=cadence,
        lift=float(gait.march_lift(cadence, speed)),
        turn=turn,
    )
    machine = StateMachine()
    for _ in range(75):  # from standing to walking
        machine.step("walk", None)
    walk = [
        machine.step("walk", pose).reference
        for pose in realize(march_track("walk", seconds, [bout])).poses()
    ]
    return walk, [machine.step("walk", None, directive).reference for _ in range(60)]


def speeds(references):
    return np.array([np.hypot(*r.base_lin_vel_w[:2]) for r in references])


@pytest.mark.parametrize("directive", [Directive.STAND, Directive.REST])
@pytest.mark.parametrize("seconds", np.arange(4.0, 4.6, 0.1))
@pytest.mark.parametrize(("speed", "turn"), [(0.35, 0.0), (0.6, 0.2), (0.9, 0.0)])
def test_a_fast_walk_slows_down_in_steps_whenever_it_is_called_off(speed, turn, seconds, directive):
    walk, halt = halted(speed, seconds, turn, directive)
    begun, done = speeds(walk[-1:])[0], speeds(halt)
    assert begun > 0.25
    periods = int(np.ceil(begun / BRAKING / a1.CONTROL_DT)) + PUT_DOWN_PERIODS
    assert np.all(np.diff(done[:periods]) < 1e-6)  # it slows down from the first period on
    assert done[0] < begun + 1e-9
    assert done[periods:].max() < 0.2  # at rest; steps to the neutral stance follow
    peak = max(np.abs(r.joint_vel).max() for r in halt)
    assert peak <= SPEED_LIMIT["walk"] + 1e-6


@pytest.mark.parametrize("seconds", np.arange(4.0, 4.6, 0.1))
def test_feet_on_the_floor_stay_where_they_are(seconds):
    walk, halt = halted(0.9, seconds)
    feet = np.array([feet_w(r) for r in [walk[-1], *halt]])
    down = np.array([r.foot_contact for r in halt]) == 1.0
    slid = np.linalg.norm(np.diff(feet[..., :2], axis=0), axis=-1)
    assert slid[1:][down[1:] & down[:-1]].max() < 1e-3
    assert feet[..., 2].min() > a1.FOOT_RADIUS - 2e-3


@pytest.mark.parametrize("seconds", np.arange(4.0, 4.6, 0.1))
def test_a_slow_walk_sets_its_feet_down_at_once(seconds):
    walk, halt = halted(0.15, seconds)
    lifted = in_the_air(walk[-1])
    assert feet_w(halt[PUT_DOWN_PERIODS - 1])[lifted, 2].max(initial=0.0) <= IN_THE_AIR
    assert speeds(halt[PUT_DOWN_PERIODS - 1 :]).max() < 0.1  # then it steps to a stance
