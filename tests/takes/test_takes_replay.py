"""A take as a page of its own: one file, small, with the robot's meshes, that asks for nothing."""

import base64
import json
import re
from pathlib import Path

import numpy as np
import pytest
from acted_takes import acted_take, record

from studio import geometry
from studio.errors import StudioError
from studio.robot import a1
from studio.robot.kinematics import link_frames_b
from studio.robot.meshes import link_meshes
from studio.takes.edit.edits import edit
from studio.takes.export import html
from studio.takes.export.formats import export
from studio.takes.take import read_take


@pytest.fixture
def page(tmp_path: Path) -> str:
    """Four seconds of a march, the page that is shared of it."""
    record(acted_take("walk", np.random.default_rng(1), seconds=4.0), tmp_path, "walk")
    return export(read_take(tmp_path / "walk"), "html", tmp_path).read_text("utf-8")


def data_of(page: str) -> dict:
    found = re.search(r'type="application/json">(.*?)</script>', page, re.DOTALL)
    assert found
    return json.loads(found[1])


def numbers(text: str, kind: str, *shape: int) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), kind).reshape(*shape)


def test_it_is_one_small_file_without_imports_or_holes(page: str):
    assert len(page) < 600_000
    assert "{{" not in page.partition("<script")[0]
    assert not re.search(r"^\s*(import|export) ", page, re.MULTILINE)
    assert not re.search(r"https?://(?!www\.w3\.org)", page)


def test_it_holds_the_meshes_and_the_motion_as_they_are(page: str, tmp_path: Path):
    data, take = data_of(page), read_take(tmp_path / "walk")
    frames = len(data["states"])
    assert frames == len(take)
    for link, mesh in zip(data["links"], link_meshes().values(), strict=True):
        shape = data["shapes"][link["shape"]]
        vertices = numbers(shape["vertices"], "<i2", -1, 3) * shape["unit"]
        np.testing.assert_allclose(vertices, mesh.vertices, atol=2e-5)
        np.testing.assert_array_equal(numbers(shape["faces"], "<u2", -1, 3), mesh.faces)
    for robot, pose in zip(data["robots"], (take.arrays.reference, take.arrays.robot)):
        rows = numbers(robot["data"], "<i2", frames, 20).astype(float)
        np.testing.assert_allclose(rows[:, 7:19] / 7000, pose["joint_pos"], atol=1e-4)
        np.testing.assert_allclose(rows[:, 2] / 1e3, pose["base_pos"][:, 2], atol=1e-3)
        tilt = geometry.up_in_body(rows[:, 3:7] / 32767)
        np.testing.assert_allclose(tilt, geometry.up_in_body(pose["base_quat"]), atol=1e-3)
        assert abs(geometry.heading(rows[0, 3:7] / 32767)) < 1e-3
        stands = (rows[:, 19:].astype(int) >> np.arange(4)) & 1
        np.testing.assert_array_equal(stands, pose["foot_contact"] > 0.5)
    passed = numbers(data["passed"], "<f4", frames, 2)
    way = passed + rows[:, :2] / 1e3
    went = take.arrays.robot["base_pos"][-1, :2] - take.arrays.robot["base_pos"][0, :2]
    assert np.linalg.norm(way[-1]) == pytest.approx(np.linalg.norm(went), abs=2e-3)
    joints = numbers(data["person"]["data"], "<i2", frames, 19, 3) / 1e3
    assert joints[..., 2].min() == pytest.approx(0.0, abs=0.1)
    bones = take.human
    assert bones is not None
    length = np.linalg.norm(joints[:, 12] - joints[:, 11], axis=-1)  # a thigh
    assert np.median(length) == pytest.approx(
        np.median(np.linalg.norm(bones.joint_pos_w[:, 12] - bones.joint_pos_w[:, 11], axis=-1)),
        abs=0.01,
    )


def test_the_offsets_are_those_of_the_robot():
    """With all angles zero each joint lies at the sum of the offsets before it."""
    offsets = html._offsets()
    pos, _ = link_frames_b(np.zeros(a1.NUM_JOINTS))
    for leg in range(4):
        hip = np.array(offsets["hip"][leg])
        thigh = hip + offsets["thigh"][leg]
        np.testing.assert_allclose(pos[3 * leg + 1 : 3 * leg + 4], [
            hip, thigh, thigh + offsets["calf"]], atol=1e-9)  # fmt: skip


def test_a_long_way_does_not_run_out_of_numbers():
    n = 3000
    pose = {
        "base_pos": np.column_stack([0.05 * np.arange(n), np.zeros(n), np.full(n, 0.27)]),
        "base_quat": np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)),
        "joint_pos": np.tile(a1.JOINT_UPPER, (n, 1)),
        "foot_contact": np.ones((n, 4)),
    }
    robot, follow = html._robot("far", pose, None)
    rows = numbers(robot["data"], "<i2", n, 20)
    way = follow + rows[:, :2] / 1e3
    np.testing.assert_allclose(way, pose["base_pos"][:, :2], atol=1e-3)
    np.testing.assert_allclose(rows[:, 7:19] / 7000, pose["joint_pos"], atol=1e-4)


def test_of_nothing_there_is_no_page_and_a_long_take_is_thinned(tmp_path: Path, monkeypatch):
    record(acted_take("tilt", np.random.default_rng(1), seconds=2.0), tmp_path, "tilt")
    monkeypatch.setattr(html, "MOST_FRAMES", 50)
    take = read_take(tmp_path / "tilt")
    data = data_of(export(take, "html", tmp_path / "x.html").read_text("utf-8"))
    assert len(data["states"]) <= 50
    assert len(data["states"]) / data["fps"] == pytest.approx(take.seconds, rel=0.05)
    edit(tmp_path / "tilt", cuts=[(0.0, 100.0)])
    with pytest.raises(StudioError, match="nothing is left"):
        export(read_take(tmp_path / "tilt"), "html", tmp_path / "y.html")
