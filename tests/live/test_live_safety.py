"""Safety on a fake clock: what each situation calls for, and the line that says why."""

import pytest

from studio.control.controller import Directive
from studio.live.safety import Safety, Situation, stale_directive, stale_orders


def situation(now: float = 0.0, **changes) -> Situation:
    return Situation(**{"now": now, "mode": "live", "human_at": now, **changes})


@pytest.mark.parametrize(
    ("age", "directive"),
    [
        (0.0, Directive.FOLLOW),
        (0.1, Directive.FOLLOW),
        (0.29, Directive.FOLLOW),
        (0.3, Directive.HOLD),
        (0.49, Directive.HOLD),
        (0.5, Directive.STAND),
        (60.0, Directive.STAND),
    ],
)
def test_a_person_who_goes_missing_is_first_reused_then_held_then_stood_for(age, directive):
    assert stale_directive(age) is directive
    orders = Safety(armed=True).orders(situation(now=age, human_at=0.0))
    assert orders.directive is directive
    assert not orders.damping  # damping is never for somebody who stepped out of view
    assert orders.why.startswith("stale") == (directive is not Directive.FOLLOW)


def test_nobody_seen_yet_is_no_reason_to_move():
    assert stale_orders(float("inf")).directive is Directive.FOLLOW
    assert Safety(armed=True).orders(situation(human_at=None)).directive is Directive.REST


def test_an_emergency_stop_latches_until_reset_and_arm_in_that_order():
    safety = Safety(armed=True)
    safety.stop("emergency stop")
    assert safety.orders(situation()).damping
    assert "reset first" in safety.arm(1.0)
    assert safety.stopped
    safety.reset()
    standing = safety.orders(situation(now=1.0))
    assert (standing.damping, standing.directive) == (False, Directive.STAND)
    assert safety.stopped
    assert standing.why.startswith("stopped")
    assert safety.arm(2.0) == ""
    assert not safety.stopped
    assert safety.orders(situation(now=2.5)).ramp == 1.0
    assert safety.orders(situation(now=3.5)).ramp is None


def test_the_stop_wins_over_everything_else():
    safety = Safety(armed=True)
    safety.take_control("page-1", now=0.0)
    safety.stop("emergency stop")
    orders = safety.orders(situation(now=9.0, mode="idle", human_at=None, overrun=True))
    assert orders.damping
    assert orders.why.startswith("stopped")


def test_a_lost_page_makes_the_robot_stand_within_half_a_second():
    safety = Safety(armed=True)
    safety.take_control("page-1", now=0.0)
    times = [k / 30.0 for k in range(60)]
    for t in times:
        if t <= 1.0:
            safety.beat("page-1", t)
        orders = safety.orders(situation(now=t))
        if orders.directive is Directive.STAND:
            break
    assert 1.0 < t <= 1.5
    assert orders.why.startswith("page lost")


def test_a_headless_client_that_never_took_control_is_no_lost_page():
    safety = Safety(armed=True)
    assert safety.orders(situation(now=100.0)).directive is Directive.FOLLOW
    safety.take_control("page-1", now=0.0)
    safety.release_control("page-1")
    assert safety.orders(situation(now=100.0)).directive is Directive.FOLLOW


def test_whoever_arms_takes_the_place_of_a_lost_page_until_it_is_back():
    safety = Safety(armed=True)
    safety.take_control("page-1", now=0.0)
    assert safety.orders(situation(now=5.0)).directive is Directive.STAND
    assert safety.arm(5.0) == ""
    assert safety.orders(situation(now=9.0)).directive is Directive.FOLLOW
    safety.beat("page-1", 9.0)
    assert safety.orders(situation(now=9.1)).directive is Directive.FOLLOW
    assert safety.page_lost(9.5)


def test_beats_of_a_page_that_only_watches_keep_nobody_alive():
    safety = Safety(armed=True)
    safety.take_control("page-1", now=0.0)
    safety.beat("page-2", 0.9)
    assert safety.page_lost(1.0)


@pytest.mark.parametrize(
    ("armed", "changes", "word"),
    [
        (True, {"mode": "idle"}, "idle"),
        (False, {"mode": "idle"}, "idle"),
        (False, {}, "unarmed"),
        (True, {"source_ended": True}, "ended"),
        (True, {"overrun": True}, "overrun"),
        (True, {"human_at": None}, "stale"),
    ],
)
def test_one_line_always_says_why_nothing_moves(armed, changes, word):
    orders = Safety(armed=armed).orders(situation(**changes))
    assert orders.directive is not Directive.FOLLOW
    assert orders.why.startswith(word)
    assert "\n" not in orders.why
