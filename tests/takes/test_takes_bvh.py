"""What is written as BVH reads back as the same motion, through our own reader and the clips."""

import numpy as np
import pytest

from studio.human.skeleton import INDEX
from studio.mocap.bvh import load_bvh
from studio.takes.export.bvh import write_bvh

BONES = [
    ("l_hip", "l_knee"), ("l_knee", "l_ankle"), ("l_shoulder", "l_elbow"), ("l_elbow", "l_wrist"),
    ("r_hip", "r_knee"), ("r_knee", "r_ankle"), ("r_shoulder", "r_elbow"), ("r_elbow", "r_wrist"),
]  # fmt: skip


@pytest.mark.parametrize(
    "name", ["cmu_13_29_squats", "cmu_13_29_arm_circles", "cmu_131_01_start_walk_stop"]
)
def test_real_motion_survives_the_round_trip(name, clips, tmp_path):
    clip = load_bvh(clips / f"{name}.bvh")
    pos = clip.joint_pos_w[::4]
    dt = float(np.median(np.diff(clip.t))) * 4
    write_bvh(tmp_path / "out.bvh", pos, dt)
    back = load_bvh(tmp_path / "out.bvh")
    assert len(back) == len(pos)
    assert np.allclose(np.diff(back.t), dt, atol=1e-6)
    for a, b in BONES:
        was = pos[:, INDEX[b]] - pos[:, INDEX[a]]
        now = back.joint_pos_w[:, INDEX[b]] - back.joint_pos_w[:, INDEX[a]]
        cosine = np.sum(was * now, -1) / np.linalg.norm(was, axis=-1) / np.linalg.norm(now, axis=-1)
        # Limbs keep their direction exactly; lengths were rigid in these files already.
        assert np.rad2deg(np.arccos(np.clip(cosine, -1, 1))).max() < 0.5, (a, b)
    assert np.abs(back.joint_pos_w[:, 0] - pos[:, 0]).max() < 0.05
