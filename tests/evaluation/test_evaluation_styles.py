"""The styles table: what counts as reached, and every style driven in physics."""

import pytest

from studio.evaluation.styles import (
    CASES,
    Case,
    Options,
    Outcome,
    attempt,
    row,
    run_styles,
)
from studio.options import STYLES
from studio.reference import gait
from studio.synthetic.impaired import walking


def outcome(m_s, deg_s, survived=True):
    return Outcome(
        asked_m_s=0.6,
        asked_deg_s=0.0,
        achieved_m_s=m_s,
        achieved_deg_s=deg_s,
        survived=survived,
        walk_share=1.0,
    )


def test_a_goal_is_reached_upright_fast_enough_and_to_the_right_side():
    forward, left, right = CASES
    assert outcome(0.5, 0.0).reached(forward)
    assert not outcome(0.49, 0.0).reached(forward)
    assert not outcome(0.6, 0.0, survived=False).reached(forward)
    assert outcome(0.3, 9.0).reached(left)
    assert not outcome(0.3, -9.0).reached(left)
    assert outcome(0.3, -9.0).reached(right)


def test_a_row_tells_the_mean_and_the_least():
    case = Case(name="right", m_s=0.3, deg_s=-10.0, least_deg_s=-8.0)
    made = row("march", case, [outcome(0.2, -12.0), outcome(0.4, -6.0)], 3)
    assert made["achieved_m_s"] == pytest.approx(0.3)
    assert made["achieved_deg_s"] == pytest.approx(-9.0)
    assert made["least_deg_s"] == pytest.approx(-6.0)
    assert made["reached"] == 1
    assert made["episodes"] == 2


@pytest.mark.parametrize("speed", [0.3, 0.5, 0.8])
def test_what_is_asked_for_means_that_speed(speed):
    intent = walking(speed, 0.0)
    assert float(gait.march_speed(intent.cadence, intent.lift)) == pytest.approx(speed, abs=0.01)


@pytest.mark.slow
@pytest.mark.long
def test_every_style_walks_and_turns_both_ways_in_physics():
    rows = run_styles(Options(episodes=1))["rows"]
    assert [r["case"] for r in rows] == [f"{s}, {c.name}" for s in STYLES for c in CASES]
    by = {r["case"]: r for r in rows}
    for style in STYLES:
        assert by[f"{style}, forward"]["achieved_m_s"] > 0.4
        assert by[f"{style}, left"]["achieved_deg_s"] > 0.0
        assert by[f"{style}, right"]["achieved_deg_s"] < 0.0
        assert all(by[f"{style}, {c.name}"]["expert_walk_share"] > 0.9 for c in CASES)


@pytest.mark.slow
def test_the_semantic_style_reaches_half_a_metre_a_second():
    forward = CASES[0]
    assert all(attempt("semantic", forward, k).reached(forward) for k in range(2))
