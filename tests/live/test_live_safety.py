"""Safety on a fake clock: what each situation calls for, and the line that says why."""

from itertools import pairwise
from typing import get_args

import pytest

from studio.control.drive_command import Directive, Reason
from studio.control.staleness import missing, stale_command, why_still
from studio.live.safety import OVERRUN_WINDOW, Safety


def decided(
    safety, now=0.0, *, human_at: float | str | None = "now", overrun=False, mode="live", **more
):
    """What `safety` decides; human_at: when somebody was last seen, None for never."""
    safety.seen_at = now if human_at == "now" else human_at
    for _ in range(OVERRUN_WINDOW):
        safety.period(late=overrun)
    return safety.command(now, mode, **more)


@pytest.mark.parametrize(
    ("age", "directive"),
    [
        (0.0, Directive.FOLLOW),
        (0.1, Directive.FOLLOW),
        (0.49, Directive.FOLLOW),
        (0.5, Directive.STAND),
        (60.0, Directive.STAND),
    ],
)
def test_a_person_who_goes_missing_is_first_reused_then_stood_for(age, directive):
    assert stale_command(age).directive is directive
    command = decided(Safety(armed=True), now=age, human_at=0.0)
    assert command.directive is directive
    assert not command.damping  # damping is never for somebody who stepped out of view
    assert command.why.startswith("stale") == (directive is not Directive.FOLLOW)
    assert (command.reason, command.why) == missing(age)


def test_nobody_seen_yet_is_no_reason_to_move():
    assert stale_command(float("inf")).directive is Directive.FOLLOW
    live = decided(Safety(armed=True), human_at=None)
    assert live.directive is Directive.REST
    # Whoever asks, it is said in the same words.
    lines = {(live.reason, live.why), missing(float("inf"))}
    assert lines == {why_still(float("inf"), "stand", {"stand": 1.0}, None)}


def test_an_emergency_stop_latches_until_reset_and_arm_in_that_order():
    safety = Safety(armed=True)
    safety.stop("emergency stop")
    assert decided(safety).damping
    assert "reset first" in safety.arm(1.0)
    assert safety.stopped
    safety.reset()
    standing = decided(safety, now=1.0)
    assert (standing.damping, standing.directive) == (False, Directive.STAND)
    assert safety.stopped
    assert standing.why.startswith("stopped")
    assert safety.arm(2.0) == ""
    assert not safety.stopped
    assert decided(safety, now=2.5).ramp == 1.0
    assert decided(safety, now=3.5).ramp is None


def test_the_stop_wins_over_everything_else():
    safety = Safety(armed=True)
    safety.take_control("page-1", now=0.0)
    safety.stop("emergency stop")
    command = decided(safety, now=9.0, mode="idle", human_at=None, overrun=True)
    assert command.damping
    assert command.why.startswith("stopped")


def test_a_lost_page_makes_the_robot_stand_within_half_a_second():
    safety = Safety(armed=True)
    safety.take_control("page-1", now=0.0)
    times = [k / 30.0 for k in range(60)]
    for t in times:
        if t <= 1.0:
            safety.beat("page-1", t)
        command = decided(safety, now=t)
        if command.directive is Directive.STAND:
            break
    assert 1.0 < t <= 1.5
    assert command.why.startswith("page lost")


def test_a_headless_client_that_never_took_control_is_no_lost_page():
    safety = Safety(armed=True)
    assert decided(safety, now=100.0).directive is Directive.FOLLOW
    safety.take_control("page-1", now=0.0)
    safety.release_control("page-1")
    assert decided(safety, now=100.0).directive is Directive.FOLLOW


def test_whoever_arms_takes_the_place_of_a_lost_page_until_it_is_back():
    safety = Safety(armed=True)
    safety.take_control("page-1", now=0.0)
    assert decided(safety, now=5.0).directive is Directive.STAND
    assert safety.arm(5.0) == ""
    assert decided(safety, now=9.0).directive is Directive.FOLLOW
    safety.beat("page-1", 9.0)
    assert decided(safety, now=9.1).directive is Directive.FOLLOW
    assert safety.page_lost(9.5)


def test_beats_of_a_page_that_only_watches_keep_nobody_alive():
    safety = Safety(armed=True)
    safety.take_control("page-1", now=0.0)
    safety.beat("page-2", 0.9)
    assert safety.page_lost(1.0)


@pytest.mark.parametrize(
    ("armed", "changes", "word", "reason"),
    [
        (True, {"mode": "idle"}, "idle", "idle"),
        (False, {"mode": "idle"}, "idle", "idle"),
        (False, {}, "unarmed", "unarmed"),
        (True, {"source_ended": True}, "ended", "source_ended"),
        (True, {"overrun": True}, "overrun", "overrun"),
        (True, {"human_at": None}, "nobody", "nobody"),
        (True, {"now": 9.0, "human_at": 8.4}, "stale", "stale"),
    ],
)
def test_one_line_and_one_word_always_say_why_nothing_moves(armed, changes, word, reason):
    command = decided(Safety(armed=armed), **changes)
    assert command.directive is not Directive.FOLLOW
    assert command.why.startswith(word)
    assert "\n" not in command.why
    assert command.reason == reason in get_args(Reason)


def test_a_slow_computer_keeps_the_robot_standing_until_it_is_in_time_again():
    safety = Safety(armed=True)
    safety.seen_at = 0.0
    asked = []
    for late in [True] * 25 + [True, True, False] * 40 + [False] * 25:
        safety.period(late=late)
        asked.append(safety.command(0.0, "live").directive)
    assert asked[23] is Directive.FOLLOW
    assert asked[24] is Directive.STAND
    assert asked[-25:-1].count(Directive.FOLLOW) < 10
    assert asked[-1] is Directive.FOLLOW
    changes = sum(a is not b for a, b in pairwise(asked))
    assert changes == 2  # it does not walk and stop by turns


def test_a_latched_stop_keeps_the_word_for_what_made_it_until_armed():
    safety = Safety(armed=True)
    assert (decided(safety).reason, decided(safety).why) == ("", "")
    for make, reason in (
        (lambda: safety.stop("emergency stop by page-1"), "stopped"),
        (lambda: safety.fall(0.0, demo=False), "fallen"),
        (lambda: safety.stop("a fault: no", "fault"), "fault"),
    ):
        make()
        assert decided(safety, mode="idle").reason == reason
        safety.reset()
        assert decided(safety).reason == reason
        assert safety.arm(0.0) == ""
        assert decided(safety).reason == ""
    safety.take_control("page-1", now=0.0)
    assert decided(safety, now=1.0).reason == "page_lost"


def test_the_age_of_what_was_seen_is_counted_on_the_same_clock_for_all():
    safety = Safety(armed=True)
    assert safety.stale_s(5.0) is None
    safety.see(5.0)
    assert safety.stale_s(5.25) == 0.25
    safety.forget_person()
    assert safety.stale_s(6.0) is None


@pytest.mark.parametrize(
    ("age", "expert", "lock", "reason"),
    [
        (float("inf"), "walk", None, "nobody"),
        (0.5, "walk", None, "stale"),
        (0.0, "unknown", None, "unknown"),
        (0.0, "walk", "sit", "locked"),
        (0.0, "walk", "walk", ""),
        (0.0, "unknown", "walk", ""),
        (0.0, "walk", None, ""),
    ],
)
def test_what_the_person_does_may_be_the_reason_too(age, expert, lock, reason):
    said, why = why_still(age, expert, {"walk": 0.8, "sit": 0.2}, lock)
    assert said == reason in get_args(Reason)
    assert bool(said) == bool(why)
