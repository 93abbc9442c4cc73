"""The robot's side and a simulated body: it rises, walks, stops and sits down in physics."""

import numpy as np
import pytest

from studio.link.engine import CROUCH, Engine, MotorCommand, MujocoEngine
from studio.link.robot_side import (
    SIT_AFTER,
    TO_BELLY,
    TO_CROUCH,
    TO_STAND,
    Heard,
    RobotSide,
)
from studio.reference.stances import NEUTRAL
from studio.robot import a1
from studio.sim.world import World

STAND = a1.STAND_JOINT_POS


def run(side: RobotSide, engine: Engine, seconds: float, order: Heard | None, now: float) -> float:
    for k in range(round(seconds / engine.dt)):
        if order is not None and k % 8 == 0:
            side.hear(order, now)
        engine.step(side.step(engine.state(), now))
        now += engine.dt
    return now


def test_short_steps_are_the_period_of_the_world_they_were_taken_from():
    engine, world = MujocoEngine(), World()
    engine.place(NEUTRAL["stand"])
    world.reset(NEUTRAL["stand"])
    rng = np.random.default_rng(1)
    for _ in range(15):
        target = STAND + rng.uniform(-0.2, 0.2, 12)
        whole = world.step(target)
        for _ in range(world.substeps):
            short = engine.step(MotorCommand(target=target, kp=a1.KP, kd=a1.KD))
        np.testing.assert_allclose(short.joint_pos, whole.joint_pos, atol=1e-12)
        np.testing.assert_allclose(short.base_quat, whole.base_quat, atol=1e-12)


@pytest.mark.parametrize("rate", [240, 480])
def test_it_rises_from_its_belly_stands_and_lies_down_when_the_line_is_silent(rate: int):
    engine = MujocoEngine(rate=rate)
    side = RobotSide(engine.dt)
    now = run(side, engine, 3.0, None, 0.0)
    assert side.phase == "limp"
    assert engine.state().base_pos[2] < 0.15
    now = run(
        side, engine, TO_CROUCH + TO_STAND + 1.0, Heard(level="targets", target=STAND, rise=1), now
    )
    assert side.phase == "following"
    standing = engine.state()
    assert standing.base_pos[2] == pytest.approx(a1.STAND_HEIGHT, abs=0.02)
    assert standing.foot_contact.all()
    now = run(side, engine, SIT_AFTER["targets"] + TO_BELLY + 0.1, None, now)
    assert side.phase == "limp"
    now = run(side, engine, 1.0, None, now)
    lying = engine.state()
    assert lying.base_pos[2] < 0.15
    np.testing.assert_allclose(lying.base_quat[1:3], 0.0, atol=0.1)  # on its belly, not its side
    np.testing.assert_allclose(lying.joint_pos, CROUCH, atol=0.5)


def test_damping_lets_a_standing_robot_sink_and_gains_come_back():
    engine = MujocoEngine()
    engine.place(NEUTRAL["stand"])
    for _ in range(240):
        engine.step(MotorCommand(target=STAND, kp=0.0, kd=4.0))
    assert engine.state().base_pos[2] < 0.2
    engine.place(NEUTRAL["stand"])
    for _ in range(240):
        engine.step(MotorCommand(target=STAND, kp=a1.KP, kd=a1.KD))
    assert engine.state().base_pos[2] == pytest.approx(a1.STAND_HEIGHT, abs=0.02)
