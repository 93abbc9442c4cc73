"""A recorded human, replayed: the same poses at the same control periods."""

from pathlib import Path

import numpy as np
import pytest
from make_ticks import make_ticks  # type: ignore[import-not-found]

from studio.errors import StudioError
from studio.mocap.source import Source, SourceEnded
from studio.mocap.take_source import TakeSource
from studio.robot import a1
from studio.takes.record.recorder import Recorder
from studio.takes.session_library import SessionLibrary


@pytest.fixture
def sessions(tmp_path: Path) -> Path:
    recorder = Recorder(tmp_path)
    recorder.start(name="walk")
    for tick in make_ticks(30, human_every=3):
        recorder.append(tick)
    recorder.close()
    return tmp_path


def read_all(source: TakeSource) -> list[tuple[int, object]]:
    out = []
    for n in range(1000):
        try:
            pose = source.read(n * a1.CONTROL_DT)
        except SourceEnded:
            return out
        if pose is not None:
            out.append((n, pose))
    raise AssertionError("it never ended")


def test_poses_return_in_the_period_that_first_used_them(sessions: Path):
    source = TakeSource("walk", sessions)
    assert isinstance(source, Source)
    assert source.name == "take:walk"
    assert source.duration == pytest.approx(1.0)
    got = read_all(source)
    assert [n for n, _ in got] == list(range(0, 30, 3))
    originals = [tick.human for tick in make_ticks(30, human_every=3) if tick.human_fresh]
    for (n, pose), original in zip(got, originals):
        assert original is not None
        np.testing.assert_allclose(pose.joint_pos_w, original.joint_pos_w, atol=6e-7)
        assert pose.t == pytest.approx(n / 30, abs=1e-6)


def test_a_trimmed_take_replays_its_trim(sessions: Path):
    SessionLibrary(sessions).edit("walk", trim=(0.2, 0.7))
    source = TakeSource("walk", sessions)
    assert source.duration == pytest.approx(0.5)
    got = read_all(source)
    assert [n for n, _ in got] == [0, 3, 6, 9, 12]
    assert got[0][1].t == pytest.approx(0.0)


def test_a_reader_that_skips_gets_the_newest_pose(sessions: Path):
    source = TakeSource("walk", sessions)
    pose = source.read(0.5)
    assert pose is not None
    assert pose.t == pytest.approx(0.5, abs=0.02)
    assert len(source.calibration_poses()) == 10
    assert source.rejected == 0
    source.close()


def test_unknown_takes_and_empty_ones_say_so(sessions: Path):
    with pytest.raises(StudioError, match="known: walk"):
        TakeSource("other", sessions)
    recorder = Recorder(sessions)
    recorder.start(name="empty")
    recorder.close()
    with pytest.raises(StudioError, match="no human motion"):
        TakeSource("empty", sessions)
