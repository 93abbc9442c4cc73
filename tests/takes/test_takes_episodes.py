"""Episodes for learning: the observation comes before its action, and nothing jumps inside one."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from make_ticks import make_ticks

from studio.errors import StudioError
from studio.evaluation.drive import run_drive
from studio.options import DriveConfig
from studio.takes.edit.edits import edit
from studio.takes.export.episodes import episodes, words
from studio.takes.export.extent import steady_human, tick_range
from studio.takes.export.formats import export
from studio.takes.export.lerobot import NAMES, features
from studio.takes.record.recorder import Recorder
from studio.takes.take import Take, read_take


def recorded(root: Path, name: str, ticks, **about) -> Take:
    recorder = Recorder(root)
    recorder.start(name=name, about=about)
    for tick in ticks:
        recorder.append(tick)
    recorder.close()
    return read_take(root / name)


def r2(x: np.ndarray, y: np.ndarray) -> float:
    """Share of y's variance that a linear function of x, fitted on the first half, explains of the
    second."""
    half = len(x) // 2
    x = np.c_[x, np.ones(len(x))]
    weights = np.linalg.lstsq(x[:half], y[:half], rcond=None)[0]
    error = y[half:] - x[half:] @ weights
    return 1.0 - float(np.sum(error**2) / np.sum((y[half:] - y[half:].mean(0)) ** 2))


def test_an_action_explains_what_comes_after_its_observation(tmp_path: Path):
    """A real drive: how far a joint moves follows from where its action pulled it, best of all in
    the step that begins at the action's observation."""
    answer = run_drive(
        DriveConfig(source="operator:walk", seconds=15.0, sessions=tmp_path, record=True)
    )
    (episode,) = episodes(read_take(tmp_path / answer["take"]))
    found = features(episode)
    joints = found["observation.state"][:, 7:19]
    pull, moved = found["action"] - joints, np.diff(joints, axis=0)
    at = np.arange(60, len(joints) - 3)
    now = r2(pull[at], moved[at])
    assert now > 0.8
    assert now > r2(pull[at], moved[at - 1]) + 0.05
    assert now > r2(pull[at], moved[at + 1]) + 0.05


def test_features_are_as_wide_as_their_names_and_turn_with_the_robot(tmp_path: Path):
    (episode,) = episodes(recorded(tmp_path, "a", make_ticks(40)))
    found = features(episode)
    assert {key: x.shape[1] for key, x in found.items()} == {k: len(v) for k, v in NAMES.items()}
    # The twist is in the base's own frame: its length is that of the world's.
    speed = np.linalg.norm(found["observation.state"][:, 31:34], axis=1)
    np.testing.assert_allclose(
        speed, np.linalg.norm(episode.before["base_lin_vel_w"], axis=1), rtol=1e-5
    )


def test_a_reset_and_a_cut_part_episodes(tmp_path: Path):
    ticks = list(make_ticks(90))
    ticks[30:] = [
        replace(tick, robot=replace(tick.robot, t=tick.robot.t - 1.0)) for tick in ticks[30:]
    ]
    take = recorded(tmp_path, "a", ticks)
    assert [(e.tick[0], e.tick[-1]) for e in episodes(take)] == [(1, 29), (31, 89)]
    edit(tmp_path / "a", trim=(0.5, 2.5), cuts=[[1.2, 1.4]])
    take = read_take(tmp_path / "a")
    spans = [(e.tick[0], e.tick[-1]) for e in episodes(take)]
    assert spans == [(15, 29), (31, 35), (43, 74)]


@pytest.mark.parametrize("trim", [(0.51, 1.99), (0.5, 2.0), (0.4999, 2.0001)])
def test_every_format_cuts_a_trim_at_the_same_frame(tmp_path: Path, trim: tuple[float, float]):
    recorded(tmp_path, "a", make_ticks(90))
    edit(tmp_path / "a", trim=trim)
    take = read_take(tmp_path / "a")
    (episode,) = episodes(take)
    assert tick_range(take) == (episode.tick[0], episode.tick[-1] + 1)


def test_what_is_left_is_said_to_be_nothing(tmp_path: Path):
    recorded(tmp_path, "a", make_ticks(1))
    with pytest.raises(StudioError, match="nothing is left"):
        episodes(read_take(tmp_path / "a"))


def test_a_takes_words_are_its_label_its_note_or_what_was_collected(tmp_path: Path):
    take = recorded(tmp_path, "a", make_ticks(3), collect={"task": "raise_left"})
    assert words(take) == "raise left"
    edit(tmp_path / "a", note="wave like mad\nsecond try")
    assert words(read_take(tmp_path / "a")) == "wave like mad"
    edit(tmp_path / "a", label="wave with the_left hand")
    assert words(read_take(tmp_path / "a")) == "wave with the left hand"
    assert words(recorded(tmp_path, "b", make_ticks(3))) == "free motion"


def test_a_pause_lasts_as_long_in_a_bvh_as_it_did(tmp_path: Path):
    """gap_of_3_s.jsonl: 2 s, nothing for 3 s, 2 s more."""
    ticks = []
    for tick in make_ticks(210):
        seen = tick.index < 60 or tick.index >= 150
        human = tick.human if seen else ticks[-1].human
        ticks.append(replace(tick, human=human, human_fresh=seen))
    take = recorded(tmp_path, "gap", ticks)
    export(take, "bvh", tmp_path / "gap.bvh")
    lines = (tmp_path / "gap.bvh").read_text().splitlines()
    start = lines.index("MOTION")
    assert lines[start + 1 : start + 3] == ["Frames: 210", "Frame Time: 0.03333333"]
    rows = lines[start + 3 :]
    assert len(rows) == 210
    assert set(rows[59:150]) == {rows[59]}  # held
    edit(tmp_path / "gap", trim=(1.0, 6.0))
    assert len(steady_human(read_take(tmp_path / "gap"))) == 150


def test_a_slow_sensors_poses_are_joined_by_straight_lines(tmp_path: Path):
    take = recorded(tmp_path, "slow", make_ticks(40, human_every=4))
    joints = steady_human(take)
    np.testing.assert_allclose(joints[2], 0.5 * (joints[0] + joints[4]), atol=1e-6)
    assert len(joints) == 40
