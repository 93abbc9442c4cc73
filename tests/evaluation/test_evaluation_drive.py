"""The headless drive: report, trace and take; on files a test writes and on real clips."""

import json
from itertools import pairwise

import numpy as np
import pytest

from studio.errors import StudioError
from studio.evaluation.drive import run_drive
from studio.evaluation.drive_report import DriveReport, tilt_against_feet
from studio.options import DriveConfig
from studio.reference.stances import NEUTRAL, tilted
from studio.robot import a1, kinematics
from studio.synthetic.operator import OperatorSource
from studio.takes.export.bvh import write_bvh
from studio.takes.take import read_take

KEYS = {
    "frames", "seconds", "survived", "survival_ratio", "state_seconds", "expert_share",
    "tilt_deg", "base_height_m", "paw_height_m", "max_joint_speed_deg_s", "clipped_share",
    "limit_violations", "joint_rmse_deg", "orientation_error_deg", "foot_error_m",
    "foot_skate_m_s", "reference_foot_skate_m_s", "contact_f1", "distance_m", "mean_speed_m_s",
    "inference_ms", "rejected_frames", "net_distance_m", "heading_change_deg",
}  # fmt: skip


def performed(task, seconds, seed=0):
    """Joint positions (T, 19, 3) of an operator at 30 Hz."""
    source = OperatorSource(task, seed=seed)
    poses = (source.read(k / 30.0) for k in range(round(seconds * 30)))
    return [pose for pose in poses if pose is not None]


@pytest.fixture
def bvh(tmp_path):
    """A BVH of an operator, written to a file."""

    def write(task, seconds, seed=0):
        path = tmp_path / f"{task}.bvh"
        poses = performed(task, seconds, seed)
        write_bvh(path, np.array([pose.joint_pos_w for pose in poses]), 1.0 / 30.0)
        return path

    return write


def check_shape(report):
    """What every report must be, whatever was driven."""
    assert set(report) >= KEYS
    json.dumps(report)
    assert sum(report["expert_share"].values()) == pytest.approx(1.0)
    assert sum(report["state_seconds"].values()) == pytest.approx(report["seconds"], abs=1e-3)
    assert 0.0 <= report["survival_ratio"] <= 1.0
    assert report["limit_violations"] == 0
    speeds = report["max_joint_speed_deg_s"]
    assert max(speeds[s] for s in ("stand", "sit", "transition")) <= 120.0
    assert speeds["walk"] <= 900.0
    for low, high in (*report["tilt_deg"].values(), *report["paw_height_m"].values()):
        assert low <= high


def test_a_bvh_is_driven_to_its_end_and_reported_on(bvh):
    report = run_drive(DriveConfig(source=f"bvh:{bvh('quiet', 4.0)}"))
    check_shape(report)
    assert report["survived"]
    assert report["frames"] == 120
    assert report["seconds"] == pytest.approx(4.0, abs=0.1)
    assert report["expert_share"]["stand"] > 0.95
    assert report["distance_m"] < 0.3
    assert report["orientation_error_deg"] < 5.0


def test_the_trace_has_a_line_a_tick_with_poses_that_agree_with_the_report(bvh, tmp_path):
    trace = tmp_path / "deep" / "trace.jsonl"
    report = run_drive(DriveConfig(source=f"bvh:{bvh('crouch', 3.0)}", trace=trace))
    lines = [json.loads(line) for line in trace.read_text().splitlines()]
    assert len(lines) == round(report["seconds"] * 30)
    times = [line["t"] for line in lines]
    assert times == sorted(times)
    assert times[0] == pytest.approx(0.0, abs=0.04)
    for line in lines:
        assert set(line) == {"t", "expert", "state", "mode", "reference", "robot", "target"}
        for pose in (line["reference"], line["robot"]):
            assert [len(v) for v in pose.values()] == [3, 4, 12, 4]
        assert len(line["target"]) == 12
    heights = [line["robot"]["base_pos"][2] for line in lines]
    np.testing.assert_allclose(report["base_height_m"], [min(heights), max(heights)], atol=1e-5)


def test_seconds_end_a_drive_and_a_missing_limit_is_one_tour():
    report = run_drive(DriveConfig(source="operator", seconds=2.0))
    assert report["seconds"] == pytest.approx(2.0)
    with pytest.raises(StudioError, match="seconds"):
        run_drive(DriveConfig(source="operator", seconds=-1.0))
    with pytest.raises(StudioError, match="serve"):
        run_drive(DriveConfig(source="stream"))


def test_a_recorded_drive_can_be_driven_again_from_its_take(tmp_path):
    config = DriveConfig(source="operator:crouch", seconds=3.0, sessions=tmp_path, record=True)
    first = run_drive(config)
    take = read_take(tmp_path / first["take"])
    assert len(take.ticks) == 90
    assert take.complete
    again = run_drive(DriveConfig(source=f"take:{first['take']}", sessions=tmp_path))
    assert again["survived"]
    assert again["frames"] >= 88
    np.testing.assert_allclose(again["base_height_m"], first["base_height_m"], atol=0.01)


def test_a_fall_ends_the_drive_and_is_no_error(monkeypatch):
    from studio.control.controllers import PdPlayback

    collapse = np.tile([0.0, 2.5, -2.6], 4)
    monkeypatch.setattr(PdPlayback, "act", lambda self, *_: collapse)
    report = run_drive(DriveConfig(source="operator:quiet", seconds=10.0, controller="pd_playback"))
    assert not report["survived"]
    assert report["seconds"] < 10.0
    assert report["survival_ratio"] == pytest.approx(report["seconds"] / 10.0, abs=1e-4)


def test_files_of_recorded_frames_with_holes_and_nonsense_are_driven(tmp_path):
    path = tmp_path / "person.jsonl"
    lines = []
    for k, pose in enumerate(performed("quiet", 4.0)):
        if 30 <= k < 60:
            continue  # a second nobody was seen
        frame = {
            "t": k / 30.0,
            "skeleton": "studio",
            "positions": pose.joint_pos_w.tolist(),
            "confidence": pose.confidence.tolist(),
        }
        lines.append(json.dumps(frame if k != 90 else {**frame, "positions": "lost"}))
    path.write_text("\n".join(lines))
    whys = []
    report = run_drive(
        DriveConfig(source=f"frames:{path}"),
        on_tick=lambda tick: whys.append(tick.why),
    )
    check_shape(report)
    assert report["survived"]
    assert report["rejected_frames"] == 1
    assert any(why.startswith("stale") for why in whys[38:60])
    assert whys[29] == ""


def test_tilt_is_told_against_the_feet_and_about_the_states_neutral():
    ticks = []
    config = DriveConfig(source="operator:quiet", seconds=0.2)
    run_drive(config, on_tick=ticks.append)
    from dataclasses import replace

    for state in ("stand", "sit"):
        tilt = np.radians([4.0, -6.0, 5.0])
        neutral = NEUTRAL[state]
        feet = kinematics.foot_pos_w(neutral.base_pos, neutral.base_quat, neutral.joint_pos)
        robot = replace(ticks[-1].robot, base_quat=tilted(state, tilt), foot_pos_w=feet)
        reference = replace(ticks[-1].reference, foot_contact=neutral.foot_contact)
        tick = replace(ticks[-1], state=state, robot=robot, reference=reference)
        np.testing.assert_allclose(
            tilt_against_feet(tick, tick.robot.base_quat, tick.robot.foot_pos_w), tilt, atol=1e-9
        )


def test_an_empty_source_makes_an_empty_report_with_every_key():
    report = DriveReport().summary(0.0)
    assert set(report) >= KEYS
    assert report["frames"] == 0
    json.dumps(report)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_a_tour_visits_every_state_and_the_robot_survives(seed):
    speeds, ticks = {}, []
    report = run_drive(DriveConfig(source="operator", seed=seed), on_tick=ticks.append)
    check_shape(report)
    assert report["survived"], report["survival_ratio"]
    assert report["seconds"] == pytest.approx(40.0, abs=0.1)
    assert min(report["state_seconds"].values()) > 0.5
    for a, b in pairwise(ticks):
        if a.state == "transition" != b.state:
            speeds[b.index] = a.transition_to
    assert speeds
    targets = np.array([tick.target for tick in ticks])
    assert (targets >= a1.JOINT_LOWER).all()
    assert (targets <= a1.JOINT_UPPER).all()


@pytest.mark.slow
def test_real_clips_are_survived_with_paws_up_where_arms_are(clips):
    names = sorted(p for p in clips.iterdir() if p.suffix in (".bvh", ".jsonl"))
    assert names
    for path in names:
        kind = "bvh" if path.suffix == ".bvh" else "frames"
        report = run_drive(DriveConfig(source=f"{kind}:{path}"))
        check_shape(report)
        assert report["survived"], path.name
        if "arm_circles" in path.name or "arm_abduction" in path.name:
            paws = report["paw_height_m"]
            assert max(paws["FR"][1], paws["FL"][1]) >= 0.12
