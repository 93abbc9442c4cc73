"""A paw follows a hand from where it hangs, and nothing else lifts one."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.control.drive_command import PuppeteerConfig
from studio.control.staleness import stale_command
from studio.evaluation import hands
from studio.evaluation.hands import UP_M, Options, Seen, acted, clip, run_hands
from studio.human.calibration import calibrate
from studio.puppeteer import Puppeteer
from studio.robot.a1 import FOOT_RADIUS
from studio.robot.kinematics import foot_pos_w
from studio.synthetic import Person, play
from studio.synthetic import signals as sig
from studio.synthetic.person import HELD_OUT_SEED

CONFIG = PuppeteerConfig(controller="pd_playback")
"""The reference alone is looked at; whatever tracks it."""
MOVED_M = 0.05


def at_shoulder(seen: Seen, arm: int = 0) -> np.ndarray:
    """(T,) frames in which one hand is as high as the shoulder and the other hangs."""
    hand = seen.wrist[:, arm]
    return (hand > 0.85) & (hand < 1.15) & (seen.wrist[:, 1 - arm] < 0.3)


@pytest.mark.parametrize("arm", [0, 1])
@pytest.mark.parametrize("elbow", [0.0, 1.0])
def test_a_hand_at_the_shoulder_is_a_paw_in_the_air_and_ahead(elbow: float, arm: int):
    people = [acted(seed, elbow, CONFIG, arm) for seed in range(HELD_OUT_SEED, HELD_OUT_SEED + 3)]
    paw = np.concatenate([each.asked[at_shoulder(each, arm)] for each in people])
    ahead = np.concatenate([each.forward[at_shoulder(each, arm)] for each in people])
    assert len(paw) > 100
    assert np.median(paw[:, arm]) >= MOVED_M
    assert np.median(ahead[:, arm]) >= MOVED_M
    assert np.median(paw[:, 1 - arm]) < 0.01


@pytest.mark.parametrize("name", ["bandai_call_normal.bvh", "bandai_guide_normal.bvh"])
def test_a_real_hand_that_is_raised_to_the_shoulder_raises_the_paw(clips: Path, name: str):
    path = clips / "moving" / name
    if not path.is_file():
        pytest.skip(f"no {name}")
    seen = clip(path, CONFIG)
    assert seen.wrist[:, 0].max() < 1.0  # no higher than that
    assert seen.asked[:, 0].max() >= MOVED_M
    assert seen.asked[:, 1].max() < 0.02


@pytest.mark.parametrize("task", ["quiet", "march"])
def test_arms_that_hang_or_swing_lift_no_paw(task: str):
    """Standing: not up. Marching: no higher than the same person's with arms that do not swing."""
    highest = []
    for swing in (0.0, 1.0):
        rng = np.random.default_rng(HELD_OUT_SEED)
        person = Person.sample(rng, "held_out", sensor="mocap").still()
        habits = replace(person.habits, arm_swing=swing * np.radians(45.0))
        if task == "quiet" and swing:
            habits = replace(habits, idle_gesture_gap_s=0.5, idle_gestures=("swinging",))
        person = replace(person, habits=habits)
        signal = np.zeros((360, sig.NUM))
        if task == "march":
            signal[90:, sig.WALK] = 1.0
            signal[90:, sig.CADENCE] = 0.8
            signal[90:, sig.LIFT] = 0.5
            signal[90:, sig.PHASE] = 0.8 * np.arange(270) * sig.DT
        shown = play(signal, person, rng, task).clip
        puppeteer = Puppeteer(CONFIG, calibrate([shown[i] for i in range(0, 60, 3)]))
        paws = []
        for i in range(len(shown)):
            ref = puppeteer.step(shown[i], stale_command).reference
            feet = foot_pos_w(ref.base_pos, ref.base_quat, ref.joint_pos)
            paws.append(feet[:2, 2] - FOOT_RADIUS)
        highest.append(np.max(paws))
    assert highest[1] < max(highest[0] + 1e-6, UP_M)


def test_a_row_is_of_its_people_and_of_its_heights(monkeypatch: pytest.MonkeyPatch):
    one = Seen(
        wrist=np.array([[0.0, 0.1], [0.8, 0.1], [0.8, 0.75], [1.0, 0.0]]),
        asked=np.array([[0.0, 0.0], [0.05, 0.0], [0.0, 0.0], [0.08, 0.01]]),
        forward=np.zeros((4, 2)),
        done=np.zeros((4, 2)),
    )
    monkeypatch.setattr(hands, "acted", lambda *_: one)
    rows = {
        row["case"]: row
        for row in run_hands(Options(episodes=2))["rows"]
        if row["kind"] == "elbow first"
    }
    assert {case: row["frames"] for case, row in rows.items()} == {
        "both hang": 2,
        "one at 0.7 to 0.9": 2,
        "one at 0.9 to 1.1": 2,
        "both alike, below the shoulders": 2,
    }
    assert rows["one at 0.9 to 1.1"]["asked_m"] == 0.08
    assert rows["one at 0.7 to 0.9"]["up"] == 1.0
    assert rows["both hang"]["up"] == 0.0
