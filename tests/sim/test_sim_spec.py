"""The compiled model against the numbers of a1.py and the closed-form kinematics."""

import mujoco
import numpy as np
import pytest

from studio import geometry
from studio.robot import a1, kinematics
from studio.robot.collision import CAPSULES, PAIRS, pair_distances
from studio.robot.description import load_urdf
from studio.sim.spec import ModelConfig, build_model


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return build_model()


def random_state(model: mujoco.MjModel, seed: int) -> mujoco.MjData:
    rng = np.random.default_rng(seed)
    data = mujoco.MjData(model)
    data.qpos[:3] = rng.normal(size=3)
    data.qpos[3:7] = geometry.normalize(rng.normal(size=4))
    data.qpos[7:] = rng.uniform(a1.JOINT_LOWER, a1.JOINT_UPPER)
    mujoco.mj_forward(model, data)
    return data


def test_the_total_mass_is_the_a1_s(model: mujoco.MjModel):
    assert np.sum(model.body_mass) == pytest.approx(a1.TOTAL_MASS, abs=2e-3)
    assert np.sum(a1.LINK_MASS) == pytest.approx(np.sum(model.body_mass), abs=1e-9)
    names = [model.body(i).name for i in range(1, model.nbody)]
    assert tuple(names) == a1.LINKS
    np.testing.assert_allclose(model.body_mass[1:], a1.LINK_MASS, atol=1e-9)


def test_joint_order_limits_and_actuators_are_those_of_a1(model: mujoco.MjModel):
    assert model.nq == 19
    assert model.nu == 12
    names = [model.joint(i).name for i in range(1, model.njnt)]
    assert tuple(names) == a1.JOINTS
    assert tuple(model.actuator(i).name for i in range(12)) == a1.JOINTS
    np.testing.assert_allclose(model.jnt_range[1:, 0], a1.JOINT_LOWER)
    np.testing.assert_allclose(model.jnt_range[1:, 1], a1.JOINT_UPPER)
    np.testing.assert_allclose(model.actuator_forcerange[:, 1], a1.TORQUE_LIMIT)
    np.testing.assert_array_equal(model.actuator_trnid[:, 0], np.arange(1, 13))


def test_limits_in_a1_are_those_of_the_urdf():
    by_name = {joint.name.removesuffix("_joint"): joint for joint in load_urdf().joints}
    limits = [limit for name in a1.JOINTS if (limit := by_name[name].limit) is not None]
    assert len(limits) == 12
    np.testing.assert_allclose(np.array([x.velocity for x in limits]), a1.SPEED_LIMIT)
    np.testing.assert_allclose(np.array([x.effort for x in limits]), a1.TORQUE_LIMIT)


def test_closed_form_frames_feet_and_center_of_mass_are_the_model_s(model: mujoco.MjModel):
    feet = [model.geom(f"{leg}_foot").id for leg in a1.LEGS]
    for seed in range(20):
        data = random_state(model, seed)
        pos, quat, joint_pos = data.qpos[:3], data.qpos[3:7], data.qpos[7:]
        link_pos, link_quat = kinematics.link_frames_w(pos, quat, joint_pos)
        np.testing.assert_allclose(link_pos, data.xpos[1:], atol=1e-9)
        assert np.max(geometry.quat_angle(link_quat, data.xquat[1:])) < 1e-9
        foot = kinematics.foot_pos_w(pos, quat, joint_pos)
        np.testing.assert_allclose(foot, data.geom_xpos[feet], atol=1e-9)
        com_b = kinematics.center_of_mass_b(joint_pos)
        com_w = kinematics.to_world(pos, quat, com_b[None])[0]
        np.testing.assert_allclose(com_w, data.subtree_com[1], atol=1e-9)


def test_closed_form_jacobian_is_the_model_s(model: mujoco.MjModel):
    data = random_state(model, 3)
    rot = geometry.quat_to_matrix(data.qpos[3:7])
    ours = kinematics.leg_jacobian(data.qpos[7:])
    for i, leg in enumerate(a1.LEGS):
        jacobian = np.zeros((3, model.nv))
        mujoco.mj_jacGeom(model, data, jacobian, None, model.geom(f"{leg}_foot").id)
        columns = slice(6 + 3 * i, 9 + 3 * i)
        np.testing.assert_allclose(rot @ ours[i], jacobian[:, columns], atol=1e-9)


def test_capsule_clearances_are_the_simulator_s(model: mujoco.MjModel):
    geom = [model.geom(capsule.name).id for capsule in CAPSULES]
    for seed in range(5):
        data = random_state(model, seed)
        ours = pair_distances(data.qpos[7:])
        theirs = [
            mujoco.mj_geomDistance(model, data, geom[i], geom[j], 10.0, None) for i, j in PAIRS
        ]
        apart = np.array(theirs) > 0.0  # overlapping capsules: MuJoCo measures depth its own way
        np.testing.assert_allclose(ours[apart], np.array(theirs)[apart], atol=1e-6)
        assert np.all(ours[~apart] < 1e-6)


def test_the_simulator_collides_exactly_the_pairs_we_check(model: mujoco.MjModel):
    """Poses drawn at random: a contact between links is there exactly when a gap is negative."""
    names = [capsule.name for capsule in CAPSULES]
    found = 0
    for seed in range(300):
        data = random_state(model, 1000 + seed)
        data.qpos[2] = 5.0
        mujoco.mj_forward(model, data)
        touching = {
            tuple(sorted(names.index(model.geom(int(g)).name) for g in pair))
            for pair, dist in zip(data.contact.geom, data.contact.dist)
            if dist < -1e-6
        }
        gaps = pair_distances(data.qpos[7:])
        assert touching == {pair for pair, gap in zip(PAIRS, gaps) if gap < -1e-6}
        found += len(touching)
    assert found > 20


def test_a_cheaper_model_leaves_out_what_it_says():
    model = build_model(ModelConfig(self_collision=False, leg_contact=False))
    calf, foot = model.geom("FR_calf").id, model.geom("FR_foot").id
    assert (model.geom_contype[calf], model.geom_conaffinity[calf]) == (0, 0)
    assert model.geom_conaffinity[foot] == 1
    assert np.sum(model.body_mass) == pytest.approx(a1.TOTAL_MASS, abs=2e-3)


def test_props_are_compiled_into_the_world():
    def add_ball(spec: mujoco.MjSpec) -> None:
        ball = spec.worldbody.add_body(name="ball", pos=[2.0, 0.0, 0.1])
        ball.add_freejoint()
        ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.1, 0, 0], mass=0.2)

    model = build_model(props=[add_ball])
    assert model.nq == 19 + 7
    assert model.body("ball").mass[0] == pytest.approx(0.2)
