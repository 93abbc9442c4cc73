"""PyBullet's own A1 behind the same robot's side: joints, signs and frames are ours."""

import numpy as np
import pytest

from studio import geometry
from studio.errors import StudioError
from studio.link.engine import CROUCH, MotorCommand
from studio.link.process import open_engine
from studio.link.pybullet_engine import PybulletEngine
from studio.link.robot_side import TO_CROUCH, TO_STAND, Heard, RobotSide
from studio.reference.stances import NEUTRAL
from studio.robot import a1
from studio.robot.pose import RobotPose

STAND = a1.STAND_JOINT_POS


def test_without_pybullet_it_is_one_line(monkeypatch: pytest.MonkeyPatch):
    import studio.link.pybullet_engine as module

    def missing(name: str):
        raise ImportError(name)

    monkeypatch.setattr(module, "import_module", missing)
    with pytest.raises(StudioError, match=r"pip install 'a1-studio\[pybullet\]'"):
        open_engine("pybullet", 500)


@pytest.fixture
def engine():
    pytest.importorskip("pybullet")
    made = PybulletEngine()
    yield made
    made.close()


def test_a_pose_that_is_placed_is_read_as_it_was(engine: PybulletEngine):
    quat = geometry.quat_from_rpy([0.1, -0.2, 0.7])
    joints = STAND + np.linspace(-0.2, 0.2, 12)
    given = RobotPose(
        base_pos=np.array([1.0, -2.0, 0.3]),
        base_quat=quat,
        joint_pos=joints,
        foot_contact=np.ones(4),
    )
    robot = engine.place(given)
    np.testing.assert_allclose(robot.joint_pos, joints, atol=1e-9)
    np.testing.assert_allclose(robot.base_quat, quat, atol=1e-6)
    np.testing.assert_allclose(robot.base_pos[:2], [1.0, -2.0], atol=1e-6)


def test_each_joint_moves_the_foot_of_its_own_leg_as_our_kinematics_say(engine: PybulletEngine):
    p = engine._p
    for joint in range(12):
        joints = STAND.copy()
        joints[joint] += 0.3
        up = RobotPose(base_pos=np.zeros(3), base_quat=geometry.IDENTITY_QUAT, joint_pos=joints,
                       foot_contact=np.ones(4))  # fmt: skip
        robot = engine.place(up)
        theirs = [
            p.getLinkState(engine._robot, foot, computeForwardKinematics=True,
                           physicsClientId=engine._client)[4]
            for foot in engine._feet
        ]  # fmt: skip
        # Its legs are ours but for some millimetres of the trunk.
        np.testing.assert_allclose(np.array(theirs), robot.foot_pos_w, atol=0.012)


def test_it_rises_and_stands(engine: PybulletEngine):
    side, now = RobotSide(engine.dt), 0.0
    np.testing.assert_allclose(engine.state().joint_pos, CROUCH, atol=1e-6)
    for _ in range(240):
        engine.step(side.step(engine.state(), now))
        now += engine.dt
    order = Heard(level="targets", target=STAND, rise=1)
    for _ in range(round((TO_CROUCH + TO_STAND + 1.0) / engine.dt)):
        side.hear(order, now)
        engine.step(side.step(engine.state(), now))
        now += engine.dt
    robot = engine.state()
    assert side.phase == "following"
    assert robot.base_pos[2] == pytest.approx(a1.STAND_HEIGHT, abs=0.03)
    assert robot.foot_contact.all()
    assert not robot.trunk_contact


def test_torque_never_exceeds_a_motors(engine: PybulletEngine):
    engine.place(NEUTRAL["stand"])
    for _ in range(60):
        robot = engine.step(MotorCommand(target=STAND + 1.0, kp=500.0, kd=2.0))
        assert np.abs(robot.torque).max() <= a1.TORQUE_LIMIT[0] + 1e-9
