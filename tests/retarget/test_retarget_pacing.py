"""Generated steps: as fast as the network says, in time with the person, and up where mapped ones
fell."""

from dataclasses import replace

import numpy as np
import pytest

from studio.control.drive_command import PuppeteerConfig
from studio.control.staleness import stale_command
from studio.evaluation import long_drive
from studio.evaluation.behind import met
from studio.human.skeleton import INDEX
from studio.options import Steps
from studio.reference.intent import Intent
from studio.robot.a1 import CONTROL_DT, LEGS
from studio.synthetic.impaired import walking
from studio.synthetic.operator import InteractiveOperator
from studio.synthetic.person import HELD_OUT_SEED

FRONT_LEFT = LEGS.index("FL")
FELL = (101, 75.0)
"""A person under whom mapped steps fall at 67 s by Table I's draw, and for how long they walk."""


def driven(*parts, seed=1, steps: Steps = "generated"):
    """Ticks of somebody held out who means each intent for so many seconds, in physics."""
    operator = InteractiveOperator(seed=HELD_OUT_SEED + seed, family="held_out")
    puppeteer = met(operator, PuppeteerConfig(steps=steps))
    ticks, k = [], 0
    for intent, seconds in parts:
        operator.set_intent(intent)
        for _ in range(round(seconds / CONTROL_DT)):
            ticks.append(puppeteer.step(operator.read(k * CONTROL_DT), stale_command))
            k += 1
    assert not any(tick.fallen for tick in ticks)
    return ticks


def lifts(up):
    """Periods at which a foot leaves the floor."""
    return np.flatnonzero(up[1:] & ~up[:-1]) + 1


def stride_times(ticks):
    up = np.array([tick.reference.foot_contact[FRONT_LEFT] < 0.5 for tick in ticks])
    return np.diff(lifts(up)) * CONTROL_DT


def speed(ticks):
    return np.mean([np.hypot(*tick.reference.base_lin_vel_w[:2]) for tick in ticks])


@pytest.mark.parametrize("m_s", [0.35, 0.9])
def test_the_left_front_foot_steps_with_the_left_foot_of_the_person(m_s):
    ticks = driven((walking(m_s, 0.0), 9.0))[-150:]
    ankles = np.array([t.human.joint_pos_w[[INDEX["l_ankle"], INDEX["r_ankle"]], 2] for t in ticks])
    theirs = lifts(ankles[:, 0] - ankles[:, 1] > 0.03)
    ours = lifts(np.array([t.reference.foot_contact[FRONT_LEFT] < 0.5 for t in ticks]))
    assert abs(len(ours) - len(theirs)) <= 1
    late = [np.min(np.abs(ours - at)) * CONTROL_DT for at in theirs[1:-1]]
    stride = np.diff(theirs).mean() * CONTROL_DT
    assert np.mean(late) < 0.2 * stride


def test_its_strides_are_even_where_those_of_the_network_are_not():
    def spread(steps):
        times = stride_times(driven((walking(0.5, 0.0), 12.0), steps=steps)[-240:])
        return np.std(times) / np.mean(times)

    assert spread("generated") < 0.1
    assert spread("generated") < 0.5 * spread("mapped")


def test_who_means_a_faster_walk_gets_one_and_who_turns_a_turn():
    speeds = [speed(driven((walking(m_s, 0.0), 8.0))[-120:]) for m_s in (0.2, 0.5, 0.9)]
    assert speeds[0] + 0.05 < speeds[1] < speeds[2] - 0.05
    ticks = driven((walking(0.4, np.radians(12.0)), 8.0))[-120:]
    assert ticks[-1].robot.yaw - ticks[0].robot.yaw > np.radians(20.0)


def test_who_stops_marching_stops_the_robot_with_all_feet_down():
    ticks = driven((walking(0.5, 0.0), 6.0), (Intent(), 5.0))
    assert speed(ticks[150:180]) > 0.2
    assert np.array([t.reference.foot_contact for t in ticks[-30:]]).min() > 0.5
    assert speed(ticks[-30:]) < 0.02


def test_a_style_whose_people_do_not_step_walks_at_a_pace_of_its_own():
    operator = InteractiveOperator(seed=HELD_OUT_SEED, family="held_out", style="circles")
    puppeteer = met(operator, PuppeteerConfig(style="circles", steps="generated"))
    operator.set_intent(walking(0.6, 0.0))
    ticks = [puppeteer.step(operator.read(k * CONTROL_DT), stale_command) for k in range(270)]
    assert speed(ticks[-120:]) > 0.3
    assert np.std(stride_times(ticks[-180:])) < 0.06


@pytest.mark.slow
def test_it_stays_up_where_mapped_steps_fell():
    seed, seconds = FELL
    mapped = long_drive.Case(
        source="operator:walk", dynamics="table_i", sensor="dropped", seconds=seconds
    )
    assert long_drive.endure(mapped, seed).falls
    assert not long_drive.endure(replace(mapped, steps="generated"), seed).falls
