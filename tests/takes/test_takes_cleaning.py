"""Each fault is planted by hand in a clean, moving stream and must be found there, and only it."""

import numpy as np
import pytest

from studio.human.skeleton import INDEX, NUM_JOINTS
from studio.takes.dataset import cleaning


@pytest.fixture
def stream():
    """4 s at 30 Hz: every joint on a circle of its own, the arms and legs 0.4 m apart."""
    t = np.arange(120) / 30.0
    pos = np.zeros((120, NUM_JOINTS, 3))
    for j in range(NUM_JOINTS):
        pos[:, j, 0] = 0.1 * np.sin(2 * np.pi * 0.7 * t + j)
        pos[:, j, 2] = 0.1 * j + 0.1 * np.cos(2 * np.pi * 0.7 * t + j)
    for side, y in (("l", 0.2), ("r", -0.2)):
        for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe"):
            pos[:, INDEX[f"{side}_{name}"], 1] = y
    return t, pos, np.ones((120, NUM_JOINTS))


def kinds(found):
    return [s.kind for s in found]


def test_clean_motion_gives_no_suggestion(stream):
    assert cleaning.suggestions(*stream) == []


def test_dropped_frames_are_counted_in_the_gap(stream):
    t, pos, conf = stream
    keep = np.ones(120, bool)
    keep[50:53] = False
    found = cleaning.suggestions(t[keep], pos[keep], conf[keep])
    assert kinds(found) == ["dropped"]
    assert found[0].message == "3 frames lost"
    assert found[0].start == pytest.approx(49 / 30)
    assert found[0].end == pytest.approx(53 / 30)


def test_frozen_sensor_is_found_and_a_short_repeat_is_not(stream):
    t, pos, conf = stream
    pos[20:26] = pos[20]
    pos[80:82] = pos[80]
    found = cleaning.suggestions(t, pos, conf)
    assert kinds(found) == ["frozen"]
    assert found[0].start == pytest.approx(20 / 30)
    assert found[0].end == pytest.approx(25 / 30)
    assert "6 times" in found[0].message


def test_jitter_names_the_shaking_joint(stream):
    t, pos, conf = stream
    rng = np.random.default_rng(0)
    pos[40:70, INDEX["l_wrist"]] += rng.normal(0, 0.04, (30, 3))
    found = cleaning.suggestions(t, pos, conf)
    assert set(kinds(found)) == {"jitter"}
    assert all(s.message == "l_wrist shakes" for s in found)
    assert found[0].start == pytest.approx(40 / 30, abs=0.25)
    assert found[-1].end == pytest.approx(70 / 30, abs=0.25)


def test_jitter_of_a_joint_that_was_not_seen_is_no_news(stream):
    t, pos, conf = stream
    pos[40:70, INDEX["l_wrist"]] += np.random.default_rng(0).normal(0, 0.04, (30, 3))
    conf[:, INDEX["l_wrist"]] = 0.0
    assert cleaning.suggestions(t, pos, conf) == []


def test_low_confidence_is_a_stretch_in_which_a_quarter_is_hidden(stream):
    t, pos, conf = stream
    conf[60:75, :6] = 0.0
    found = cleaning.suggestions(t, pos, conf)
    assert kinds(found) == ["low_confidence"]
    assert found[0].share == pytest.approx(6 / 19)
    assert (found[0].start, found[0].end) == pytest.approx((2.0, 74 / 30))


@pytest.mark.parametrize(
    ("limb", "word"), [(("elbow", "wrist"), "arms"), (("knee", "ankle", "toe"), "legs")]
)
def test_swapped_limbs_are_bounded_exactly(stream, limb, word):
    t, pos, conf = stream
    left = [INDEX[f"l_{j}"] for j in limb]
    right = [INDEX[f"r_{j}"] for j in limb]
    pos[30:45, left], pos[30:45, right] = pos[30:45, right].copy(), pos[30:45, left].copy()
    found = [s for s in cleaning.suggestions(t, pos, conf) if s.kind == "limb_swap"]
    assert [(s.start, s.end) for s in found] == [pytest.approx((1.0, 1.5))]
    assert word in found[0].message


def test_two_frames_are_too_few_to_judge():
    assert cleaning.suggestions(np.zeros(2), np.zeros((2, 19, 3)), np.ones((2, 19))) == []
