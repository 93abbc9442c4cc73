"""The light meshes against Unitree's own, and link poses against the compiled model."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from studio import geometry
from studio.robot import a1, kinematics
from studio.robot import meshes as visual
from studio.robot.decimate import decimate
from studio.robot.description import a1_folder, load_urdf
from studio.robot.pose import RobotPose
from studio.sim.spec import build_model


def pose(seed: int) -> RobotPose:
    rng = np.random.default_rng(seed)
    return RobotPose(
        base_pos=rng.normal(size=3),
        base_quat=geometry.normalize(rng.normal(size=4)),
        joint_pos=rng.uniform(a1.JOINT_LOWER, a1.JOINT_UPPER),
        foot_contact=np.ones(4),
    )


def test_link_poses_are_the_compiled_model_s():
    model = build_model()
    data = mujoco.MjData(model)
    for seed in range(5):
        p = pose(seed)
        data.qpos[:] = np.concatenate([p.base_pos, p.base_quat, p.joint_pos])
        mujoco.mj_kinematics(model, data)
        pos, quat = kinematics.link_frames_w(p.base_pos, p.base_quat, p.joint_pos)
        assert len(pos) == len(quat) == len(a1.LINKS)
        for i, name in enumerate(a1.LINKS):
            body = data.body(name)
            np.testing.assert_allclose(pos[i], body.xpos, atol=1e-9)
            assert geometry.quat_angle(quat[i], body.xquat) < 1e-9


def test_every_link_has_a_light_mesh_that_is_sound():
    meshes = visual.link_meshes()
    assert tuple(meshes) == a1.LINKS
    for mesh in meshes.values():
        assert mesh.vertices.dtype == np.float32
        assert np.isfinite(mesh.vertices).all()
        assert mesh.faces.dtype == np.uint32
        assert mesh.faces.max() < len(mesh.vertices)
        assert 300 <= len(mesh.faces) <= 3000
        assert all(0 <= c <= 255 for c in mesh.color)
    assert sum(len(mesh.faces) for mesh in meshes.values()) < 15_000
    # same shape, same arrays: viewers draw them as one batch
    assert meshes["FR_calf"] is meshes["RL_calf"]
    assert meshes["FR_thigh"] is meshes["RR_thigh"]


@pytest.mark.parametrize("link", ["trunk", "FR_hip", "RL_hip", "FR_thigh", "FL_thigh", "FR_calf"])
def test_light_meshes_keep_the_shape_of_the_originals(link: str):
    visuals = next(x for x in load_urdf().links if x.name == link).visuals[0]
    assert visuals.geometry is not None
    assert visuals.geometry.mesh is not None
    assert visuals.origin is not None
    file = a1_folder() / "meshes" / Path(visuals.geometry.mesh.filename).name
    original = trimesh.load_scene(str(file)).to_mesh()
    original.apply_transform(visuals.origin)
    light = visual.link_meshes()[link]
    surface = trimesh.Trimesh(light.vertices, light.faces, process=False)
    np.testing.assert_allclose(surface.bounds, original.bounds, atol=3e-3)
    theirs = trimesh.sample.sample_surface(original, 100_000, seed=0)[0]
    gap, _ = cKDTree(theirs).query(trimesh.sample.sample_surface(surface, 2000, seed=0)[0])
    # samples lie about a millimetre apart; the surface itself is that close or closer
    assert np.median(gap) < 1.5e-3
    assert np.quantile(gap, 0.98) < 4e-3


def test_hips_are_mirrored_across_the_body():
    meshes = visual.link_meshes()
    left, right = meshes["FL_hip"].vertices, meshes["FR_hip"].vertices
    np.testing.assert_allclose(left[:, 1].max(), -right[:, 1].min(), atol=1e-4)
    front, rear = meshes["FL_hip"].vertices, meshes["RL_hip"].vertices
    np.testing.assert_allclose(front[:, 0].max(), -rear[:, 0].min(), atol=1e-4)


def test_the_cache_is_used_and_a_damaged_one_is_not(tmp_path: Path):
    meshes = visual.link_meshes()
    path = tmp_path / "meshes.npz"
    visual._save(path, meshes)
    again = visual._load(path)
    for name, mesh in meshes.items():
        np.testing.assert_array_equal(again[name].vertices, mesh.vertices)
        assert again[name].color == mesh.color
    path.write_bytes(path.read_bytes()[:1000])
    with pytest.raises((OSError, KeyError, ValueError, EOFError, visual.BadZipFile)):
        visual._load(path)


def test_decimating_a_sphere_keeps_it_round_and_closed():
    sphere = trimesh.creation.icosphere(subdivisions=4, radius=0.1)
    points, faces = decimate(np.asarray(sphere.vertices), np.asarray(sphere.faces), 400)
    assert len(faces) <= 400
    light = trimesh.Trimesh(points, faces)
    assert light.is_watertight
    assert light.volume == pytest.approx(sphere.volume, rel=0.02)
    assert np.max(np.abs(np.linalg.norm(points, axis=1) - 0.1)) < 2e-3


def test_decimating_an_open_sheet_keeps_its_border():
    x, y = np.meshgrid(np.linspace(0, 1, 21), np.linspace(0, 1, 21))
    sheet = np.stack([x.ravel(), y.ravel(), np.zeros(441)], axis=1)
    index = np.arange(441).reshape(21, 21)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    faces = np.concatenate(
        [np.stack([a, b, d], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)]
    )
    points, faces = decimate(sheet, faces, 20)
    assert len(faces) <= 20
    assert trimesh.Trimesh(points, faces).area == pytest.approx(1.0, rel=1e-6)
