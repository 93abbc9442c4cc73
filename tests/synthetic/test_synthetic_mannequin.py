"""The mannequin stands where its joints are, in the picture and in depth; its video is JPEGs."""

import io

import numpy as np
from PIL import Image

from studio.human.skeleton import INDEX, NEUTRAL
from studio.synthetic.mannequin import SHIRT, Camera, Mannequin, mjpeg


def test_a_point_is_projected_as_by_hand():
    # 2 m away with a picture 480 px high and 90 degrees from top to bottom: 240 px are 2 m there.
    camera = Camera(distance=2.0, height=1.0, view=np.pi / 2)
    seen = camera.project(np.array([[0.0, 0.5, 1.5], [1.0, 0.0, 1.0]]))
    np.testing.assert_allclose(seen, [[320 + 60, 240 - 60, 2.0], [320, 240, 1.0]])


def test_a_camera_turned_to_the_left_sees_the_left_arm_nearer():
    camera = Camera(turn=0.5)
    left, right = camera.project(NEUTRAL[[INDEX["l_wrist"], INDEX["r_wrist"]]])
    assert left[2] < right[2] - 0.2


def test_the_figure_is_drawn_around_its_joints_and_nowhere_else():
    camera = Camera()
    mannequin = Mannequin(camera)
    empty = mannequin.picture(np.full((19, 3), np.nan)).astype(int)
    drawn = np.abs(mannequin.picture(NEUTRAL).astype(int) - empty).max(axis=-1) > 12
    pixels = camera.project(NEUTRAL)[:, :2].round().astype(int)
    assert all(drawn[v, u] for u, v in pixels)
    rows, columns = np.nonzero(drawn)
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    assert columns.min() > low[0] - 30
    assert columns.max() < high[0] + 30
    assert rows.min() > low[1] - 60  # hair over the ears
    assert rows.max() < high[1] + 30


def test_a_hand_before_the_chest_hides_the_shirt():
    pose = NEUTRAL.copy()
    pose[INDEX["l_elbow"]] = pose[INDEX["chest"]] + [0.20, 0.15, -0.20]
    pose[INDEX["l_wrist"]] = pose[INDEX["chest"]] + [0.35, 0.0, -0.15]
    camera = Camera()
    u, v = camera.project(pose[INDEX["l_wrist"]])[:2].round().astype(int)
    before, now = (Mannequin(camera).picture(p)[v, u].astype(int) for p in (NEUTRAL, pose))
    assert np.argmax(before) == np.argmax(SHIRT) == 2  # blue
    assert now[0] > now[2] + 20  # skin


def test_a_video_is_jpegs_one_after_the_other():
    pictures = [Mannequin().picture(NEUTRAL)] * 2
    video = b"".join(mjpeg(pictures))
    assert video.count(b"\xff\xd8\xff") == 2
    first = np.asarray(Image.open(io.BytesIO(video)))
    assert np.abs(first.astype(int) - pictures[0]).mean() < 4.0
