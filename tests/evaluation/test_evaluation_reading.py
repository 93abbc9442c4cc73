"""What is read is driven: files of every kind give the same robot as their plain twin."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bvh_writer import NAMES, Layout, Names, write

from studio.evaluation.drive import run_drive
from studio.human.pose import HumanPose
from studio.human.skeleton import JOINTS, NEUTRAL
from studio.options import DriveConfig
from studio.sources import Source, SourceEnded

MARCH = Layout(seconds=4.0)
FOUND = {"joints_found", "joints_missing", "scale_m", "up_axis", "refused"}


@pytest.fixture
def drive(tmp_path):
    def driven(layout: Layout | str | bytes, suffix: str = ".bvh", **options):
        content = write(layout) if isinstance(layout, Layout) else layout
        path = tmp_path / f"clip{suffix}"
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        kind = "bvh" if suffix == ".bvh" else "frames"
        config = DriveConfig(source=f"{kind}:{path}", sessions=tmp_path, **options)
        return run_drive(config)

    return driven


def test_a_march_written_with_positions_on_each_joint_walks_as_its_plain_twin(drive):
    plain = drive(MARCH)
    assert plain["expert_share"]["walk"] > 0.8
    for layout in (
        Layout(seconds=4.0, channels="all"),
        Layout(seconds=4.0, channels="all", offsets="zero", start=(150.0, 40.0, 0.93)),
        Layout(seconds=4.0, names=NAMES["MMD"], unit=1.0),
    ):
        other = drive(layout)
        for key in ("frames", "rejected_frames", "survived"):
            assert other[key] == plain[key]
        for expert, share in plain["expert_share"].items():
            assert other["expert_share"][expert] == pytest.approx(share, abs=0.05)


def test_the_report_says_what_was_found(drive):
    report = drive(Layout(seconds=1.0, names=NAMES["Xsens"]))["source_report"]
    assert set(report) >= FOUND
    json.dumps(report, allow_nan=False)
    assert set(report["joints_found"]) == set(JOINTS)
    assert report["joints_found"]["l_knee"] == ["LeftKnee"]
    assert report["joints_missing"] == []
    assert (report["scale_m"], report["up_axis"]) == (0.01, "y")
    assert report["refused"] == {"frames": 0, "why": []}


@pytest.mark.parametrize("source", ["operator", "operator:quiet"])
def test_every_source_has_a_report(source):
    report = run_drive(DriveConfig(source=source, seconds=0.5))["source_report"]
    assert set(report) >= FOUND
    assert set(report["joints_found"]) == set(JOINTS)


def test_frames_that_the_flow_refuses_are_in_the_report_with_why(drive):
    lines = write(MARCH).splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("Frame Time")) + 1
    row = lines[first + 40].split()
    lines[first + 40] = " ".join(["900", *row[1:]])  # nine metres to the left for one frame
    out = drive("\n".join(lines))
    assert out["rejected_frames"] == 1
    assert out["source_report"]["refused"]["frames"] == 1
    assert "jumps at" in out["source_report"]["refused"]["why"][0]
    assert "_failed" not in out


def test_a_person_whose_every_frame_is_refused_is_no_success():
    class Doll(Source):
        name, starts_live, duration = "doll", True, 1.0

        def read(self, t):
            if t >= 1.0:
                raise SourceEnded(self.name)
            return HumanPose(t=t, joint_pos_w=0.05 * NEUTRAL, confidence=np.ones(19))

        def calibration_poses(self):
            return []

        def close(self):
            pass

    out = run_drive(DriveConfig(source="doll"), source=Doll())
    assert (out["frames"], out["rejected_frames"]) == (0, 30)
    assert out["source_report"]["refused"]["frames"] == 30
    assert len(out["source_report"]["refused"]["why"]) == 5
    assert out["_failed"].startswith(
        "doll: all 30 frames were refused, at 0.03 s: the body reaches"
    )


def run(*args: str) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-m", "studio", *args], capture_output=True, text=True, timeout=120,
        cwd=Path(__file__).parents[2], check=False,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])},
    )  # fmt: skip


@pytest.mark.slow
def test_a_joint_map_is_given_on_the_command_line_and_used_again(tmp_path):
    names = Names(leg=("{}Gamba", "{}Polpaccio", "{}Foot", "{}Toe"))
    clip, said = tmp_path / "clip.bvh", tmp_path / "map.json"
    clip.write_text(write(Layout(names=names, seconds=1.0)))
    parts = (("hip", "Gamba"), ("knee", "Polpaccio"))
    sides = (("l", "Left"), ("r", "Right"))
    said.write_text(json.dumps({f"{s}_{j}": w + n for s, w in sides for j, n in parts}))
    drive = ["drive", "--source", f"bvh:{clip}", "--sessions", str(tmp_path), "--json", "-"]
    refused = run(*drive)
    assert refused.returncode == 1
    assert "LeftGamba" in refused.stderr
    assert refused.stderr.count("\n") == 1
    mapped = run(*drive, "--joint-map", str(said))
    assert mapped.returncode == 0, mapped.stderr
    assert json.loads(mapped.stdout)["source_report"]["joints_found"]["l_hip"] == ["LeftGamba"]
    again = run(*drive)
    assert json.loads(again.stdout)["source_report"]["joints_missing"] == []
    wrong = run(*drive, "--joint-map", str(clip))
    assert wrong.returncode == 1
    assert "a joint map is" in wrong.stderr
