"""The programs of docs/bridges.md run, with stand-ins for the sensors' libraries that replay a
recorded person, and the robot marches."""

import json
import os
import re
import subprocess
import sys
import threading
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from studio.client import Studio
from studio.human.sensor_skeletons import SKELETONS
from studio.paths import package_folder
from studio.takes.columns import columns

TOKEN = "test-token-0123456789"
PAGE = Path(__file__).parents[2] / "docs" / "bridges.md"
AZURE, MEDIAPIPE, KINECT2 = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
SECONDS = 5.0

SENSOR = '''
import json, os, time
from types import SimpleNamespace as Thing

ROWS = json.load(open(os.environ["RECORDED"]))

class Sensor:
    """Gives a row every 1/30 s, and ends the program after the last one."""
    def __init__(self):
        self.k, self.begun = -1, time.monotonic()
    def row(self):
        self.k += 1
        if self.k >= len(ROWS):
            raise SystemExit(0)
        time.sleep(max(0.0, self.begun + self.k / 30 - time.monotonic()))
        return ROWS[self.k]
    def point(self, xyz, scale=1.0):
        return Thing(x=scale * xyz[0], y=scale * xyz[1], z=scale * xyz[2])
'''
AZURE_LIBRARY = """
from recorded_sensor import Sensor, Thing
K4A_COLOR_RESOLUTION_OFF, K4A_DEPTH_MODE_NFOV_UNBINNED = 0, 2
default_configuration = Thing(color_resolution=1, depth_mode=0)
tracks = []

def initialize_libraries(track_body=False):
    tracks.append(track_body)

class Device:
    def update(self):
        return Thing()

class Tracker(Sensor):
    def update(self):
        row = self.row()
        def body(further):
            places = [[x, y, z + further] for x, y, z in row]
            joints = [Thing(position=self.point(p, 1e3), confidence_level=2) for p in places]
            return Thing(joints=joints)
        # Somebody else stands behind, and is told of first; now and then nobody is seen.
        return Thing(get_bodies=lambda: [body(1.5), body(0.0)] if self.k % 10 else [])

def start_device(config):
    assert config.color_resolution == K4A_COLOR_RESOLUTION_OFF
    return Device()

def start_body_tracker():
    assert tracks == [True]
    return Tracker()
"""
CV2 = """
from recorded_sensor import Sensor
COLOR_BGR2RGB = 4

class VideoCapture(Sensor):
    def __init__(self, index):
        super().__init__()
        assert index == 0
    def read(self):
        return True, self.row()

def cvtColor(picture, code):
    assert code == COLOR_BGR2RGB
    return picture
"""
MEDIAPIPE_LIBRARY = """
from recorded_sensor import Sensor, Thing

class Landmarker(Sensor):
    @classmethod
    def create_from_options(cls, options):
        assert options.base_options.model_asset_path.endswith(".task")
        assert options.running_mode == "video"
        return cls()
    def __enter__(self):
        self.last = -1
        return self
    def __exit__(self, *_):
        return None
    def detect_for_video(self, image, t):
        assert t > self.last
        self.last = t
        world = [self.point(p) for p in image.data]
        seen = [Thing(visibility=0.9) for _ in world]
        return Thing(pose_world_landmarks=[world], pose_landmarks=[seen])

ImageFormat = Thing(SRGB=1)
Image = Thing
vision = Thing(
    PoseLandmarkerOptions=Thing, RunningMode=Thing(VIDEO="video"), PoseLandmarker=Landmarker
)
tasks = Thing(vision=vision, BaseOptions=Thing)
"""


def recorded(skeleton: str) -> list[list[list[float]]]:
    """A real march (CMU), as frames (joints, 3) m of a sensor 2.5 m before them."""
    table = columns(package_folder("sessions") / "example-cmu-march")
    joints = table.rows["human"][: round(30 * SECONDS)].astype(float)
    source = SKELETONS[skeleton]
    joints = joints - joints[:1, :1] + (-2.5 if skeleton != "mediapipe" else 0.0, 0.0, 0.0)
    return (np.linalg.pinv(source.weights) @ joints @ source.axes).round(5).tolist()


def run(program: str, libraries: dict[str, str], skeleton: str, tmp_path: Path, *more: str) -> str:
    for name, text in {**libraries, "recorded_sensor": SENSOR}.items():
        (tmp_path / f"{name}.py").write_text(text)
    (tmp_path / "rows.json").write_text(json.dumps(recorded(skeleton)))
    paths = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    done = subprocess.run(
        [sys.executable, "-c", program, *more],
        capture_output=True, text=True, timeout=120.0,
        env={**os.environ, "PYTHONPATH": paths, "RECORDED": str(tmp_path / "rows.json")},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("which", ["k4abt", "mediapipe", "kinect2"])
def test_a_recorded_person_marches_the_robot_through_each_bridge(studio_live, tmp_path, which):
    url = f"{studio_live.base}/?token={TOKEN}"
    studio = Studio(url)
    studio.set_source("stream")
    before = studio.arm()["counters"]
    experts: Counter[str] = Counter()
    with studio.ticks() as ticks:
        listener = threading.Thread(
            target=lambda: experts.update(tick["expert"] for tick in ticks), daemon=True
        )
        listener.start()
        if which == "k4abt":
            said = run(AZURE, {"pykinect_azure": AZURE_LIBRARY}, which, tmp_path, url)
        elif which == "mediapipe":
            libraries = {"cv2": CV2, "mediapipe": MEDIAPIPE_LIBRARY}
            said = run(MEDIAPIPE, libraries, which, tmp_path, url, "pose_full.task")
        else:
            rows = np.array(recorded(which)).reshape(-1, 75)
            np.savetxt(tmp_path / "dump.csv", rows, delimiter=",", fmt="%.5f")
            said = run(KINECT2, {}, which, tmp_path, url, str(tmp_path / "dump.csv"))
    listener.join(10.0)
    after = studio.state()["counters"]
    assert said == ""
    assert after["rejected"] == before["rejected"]
    assert after["frames"] - before["frames"] > 0.5 * 30 * SECONDS
    assert experts["walk"] > 15
