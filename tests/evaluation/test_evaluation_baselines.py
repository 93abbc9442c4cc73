"""The rivals' table: a smoke version of it, its figures by hand, and the page."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.errors import StudioError
from studio.evaluation import baseline_figures as figures
from studio.evaluation.baselines import MAPPERS, Options, run_baselines
from studio.evaluation.baselines_followed import FRAMES, acted
from studio.evaluation.baselines_report import Report, report, verdicts
from studio.evaluation.pairs import SETTLE
from studio.retarget.baselines.frames import Memoryless, Targets
from studio.retarget.baselines.simple import NearestPair, StandStill
from studio.retarget.mapper import Mapped
from studio.training.synthetic_pairs import make_pairs

SMOKE = Options(
    episodes=2,
    train_seconds=40.0,
    steps=40,
    states=("stand", "walk"),
    mappers=("expert", "shipped", "stand_still", "kim2020", "yamane2010"),
    people=1,
    seconds=2.0,
    needed=False,
)


@pytest.fixture(scope="module")
def rows() -> list[dict]:
    return run_baselines(SMOKE)["rows"]


@pytest.mark.slow
def test_every_mapper_has_a_row_a_state_and_a_refusal_says_why(rows: list[dict]) -> None:
    assert [(row["state"], row["controller"]) for row in rows] == [
        (state, name) for state in SMOKE.states for name in SMOKE.mappers
    ]
    by = {(row["state"], row["controller"]): row for row in rows}
    assert "--state walk" in by["stand", "kim2020"]["refused"]
    assert "joint_rmse_deg" not in by["stand", "kim2020"]
    assert by["walk", "kim2020"]["dimensions"] == 2
    assert by["walk", "yamane2010"]["dimensions"] == 3
    assert by["walk", "stand_still"]["dimensions"] == 0
    assert by["stand", "expert"]["inference_ratio"] == 1.0
    assert by["walk", "expert"]["other_style_rmse_deg"] > 0.0
    for row in rows:
        if not row["refused"]:
            assert 0.0 <= row["tracked_time_ratio"] <= row["success_time_ratio"] <= 1.0
            assert row["driven_s"] > 0.0
    json.dumps(rows, default=float)


@pytest.mark.slow
def test_the_page_shows_what_the_paper_says_beside_what_was_measured(
    rows: list[dict], tmp_path: Path
) -> None:
    with pytest.raises(StudioError, match="evaluate baselines"):
        report(Report(out=tmp_path / "page.md", tables=tmp_path))
    (tmp_path / "baselines.json").write_text(json.dumps(rows, default=float))
    report(Report(out=tmp_path / "page.md", tables=tmp_path))
    text = (tmp_path / "page.md").read_text()
    assert "| Mapping dimension | 2D; 2D |" in text
    assert "stand: refused" in text
    assert "marches lift feet and go a quarter" in text
    for name in SMOKE.mappers:
        assert f"**{name}**" in text


def test_an_unknown_mapper_is_answered_with_the_known_ones() -> None:
    with pytest.raises(StudioError, match="seol2013"):
        run_baselines(replace(SMOKE, mappers=("merlin",)))
    assert MAPPERS[0] == "expert"


def test_verdicts_follow_their_figures() -> None:
    still = {"state": "walk", "controller": "stand_still", "refused": "", "dimensions": 0}
    still |= {"inference_p99_ms": 0.1, "mapped_joint_rmse_deg": 9.0, "other_style_rmse_deg": 9.0}
    good = still | {"controller": "gmr", "dimensions": 3, "other_style_rmse_deg": 5.0}
    good |= {"mapped_joint_rmse_deg": 5.0, "success_time_ratio": 0.99, "tracked_time_ratio": 0.9}
    assert verdicts([still, good], "gmr") == {
        "Mapping dimension": "3D",
        "Real-time": "Y, 0.1 ms",
        "Dynamics": "Y, 0.99",
        "Mapping flexibility": "Y, 5.0°",
        "Sim2Real": "not measured",
        "States": "walk",
        "Tracked, least": "0.90",
    }
    bad = good | {"inference_p99_ms": 12.0, "success_time_ratio": 0.5, "other_style_rmse_deg": 6.6}
    said = verdicts([still, bad], "gmr")
    assert [said[k][0] for k in ("Real-time", "Dynamics", "Mapping flexibility")] == ["N"] * 3


def test_who_moves_in_the_plane_alone_has_two_dimensions() -> None:
    pairs = make_pairs("stand", 20.0, 0)
    whole = Mapped(
        joint_pos=pairs.joint_pos.astype(float),
        base_quat=pairs.base_quat.astype(float),
        rates=pairs.rates.astype(float),
        contact_prob=pairs.contact.astype(float),
    )
    flat = whole.joint_pos.copy()
    flat[:, 0::3] = 0.0
    level = np.tile([1.0, 0.0, 0.0, 0.0], (len(flat), 1))
    plane = replace(whole, joint_pos=flat, base_quat=level)
    assert figures.dimensions("stand", [pairs], [whole]) == 3
    assert figures.dimensions("stand", [pairs], [plane]) == 2
    assert figures.dimensions("stand", [pairs], [StandStill("stand")(pairs.triplet)]) == 0


def test_pairs_needed_are_the_fewest_that_do() -> None:
    known, held = make_pairs("stand", 40.0, 0), [make_pairs("stand", 10.0, 9)]

    def fit(pairs):
        return Memoryless(NearestPair(pairs.triplet, Targets.of(pairs)))

    assert figures.pairs_needed(fit, known, held, fit(known)) <= len(known)
    nothing = Memoryless(StandStill("stand"))
    fewest = figures.pairs_needed(lambda pairs: nothing, known, held, nothing)
    assert fewest == np.sum(known.clip == known.clip[0])  # one performance


def test_people_act_as_long_as_an_episode_and_before() -> None:
    people = acted("walk", 2, 5)
    assert [len(each.motion) for each in people] == [FRAMES] * 2
    assert [len(each.triplet) for each in people] == [FRAMES + SETTLE] * 2
    # A walk goes somewhere, and its heading is the world's.
    assert max(np.ptp(each.motion.base_pos[:, 0]) for each in people) > 0.05
