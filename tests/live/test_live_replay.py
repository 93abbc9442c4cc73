"""A take under review, played as its edits leave it; and the map of what takes cover."""

import numpy as np
import pytest
from make_ticks import make_ticks  # type: ignore[import-not-found]

from studio.errors import StudioError
from studio.live.replay import Replay
from studio.takes.columns import columns
from studio.takes.dataset.datamap import DataMap
from studio.takes.edit.edited import Viewed
from studio.takes.edit.edits import Edits
from studio.takes.record.recorder import Recorder
from studio.takes.session_library import SessionLibrary

DT = 1.0 / 30.0


@pytest.fixture
def folder(tmp_path):
    """A take of 4 s of a swaying robot that mostly walks."""
    recorder = Recorder(tmp_path)
    recorder.start("sway", name="sway")
    for tick in make_ticks(120):
        recorder.append(tick)
    recorder.close()
    return tmp_path / "sway"


def play(playback, steps):
    return [playback.step() for _ in range(steps)]


def test_playing_shows_every_tick_once_and_ends_paused(folder):
    playback = Replay("sway", columns(folder), Edits())
    playback.seek(playing=True)
    ticks = play(playback, 125)
    assert [t.index for t in ticks[:120]] == list(range(120))
    assert ticks[-1].index == 119
    assert not playback.playing
    assert ticks[-1].why.startswith("review: paused")


def test_speed_skips_and_repeats(folder):
    playback = Replay("sway", columns(folder), Edits())
    playback.seek(playing=True, speed=2.0)
    assert [t.index for t in play(playback, 5)] == [0, 2, 4, 6, 8]
    playback.seek(t=0.0, speed=0.5)
    ticks = play(playback, 4)
    assert [t.index for t in ticks] in ([0, 0, 1, 2], [0, 0, 1, 1])  # halves round either way
    with pytest.raises(StudioError, match=r"between 0\.1 and 4"):
        playback.seek(speed=9.0)


def test_a_loop_stays_within_the_trim(folder):
    playback = Replay("sway", columns(folder), Edits(trim=(1.0, 2.0)))
    playback.seek(playing=True, loop=True)
    indices = {t.index for t in play(playback, 200)}
    assert min(indices) == 30
    assert max(indices) in (59, 60)
    assert playback.playing


def test_the_person_is_moved_by_the_lag_and_the_robot_is_not(folder):
    table = columns(folder)
    as_acted = Viewed("sway", table, Edits(lag=0.2), aligned=False).at(1.0)
    aligned = Viewed("sway", table, Edits(lag=0.2)).at(1.0)
    assert aligned.human is not None
    assert as_acted.human is not None
    assert np.allclose(aligned.human.joint_pos_w, table.rows["human"][36], atol=1e-6)
    assert np.allclose(as_acted.human.joint_pos_w, table.rows["human"][30], atol=1e-6)
    assert np.array_equal(aligned.reference.joint_pos, as_acted.reference.joint_pos)


def test_scrubbing_goes_where_it_is_told_within_the_take(folder):
    playback = Replay("sway", columns(folder), Edits())
    playback.seek(t=2.0)
    assert playback.step().index == 60
    playback.seek(t=1e9)
    assert playback.step().index == 119
    playback.seek(playing=True)  # from the end, it begins again
    assert playback.step().index == 0


def test_the_map_counts_each_take_once_and_forgets_rejected_ones(folder):
    library, data = SessionLibrary(folder.parent), DataMap(folder.parent)
    first = data.read()
    assert first.seconds["walk"] == pytest.approx(2.0)  # the other half is in transition
    assert first.counts["walk"]["speed"].sum() == 60
    assert data.read().counts["walk"]["speed"].sum() == 60
    library.edit("sway", trim=(0.0, 0.5))
    assert data.read().seconds["walk"] == pytest.approx(0.5)
    library.edit("sway", keep=False)
    assert data.read().seconds["walk"] == 0.0
    assert {p["task"] for p in data.as_dict()["proposals"]} >= {"walk", "turn", "tilt"}
