"""The collect state machine, period by period: phases, actions, hands free, refusals."""

import numpy as np
import pytest

from studio.errors import StudioError
from studio.live.collect_stages import COUNTDOWN_S, HANDS_FREE_REVIEW_S, Collect, CollectPlan
from studio.live.collecting import draw_slots
from studio.live.shown_motion import QUIET_S, PlanItem, draw_motion
from studio.reference.check import check
from studio.reference.library import TASKS
from studio.reference.realize import realize
from studio.reference.rest_padding import beats, between_rests
from studio.reference.stances import NEUTRAL

DT = 1.0 / 30.0


def machine(*items: PlanItem, **options) -> Collect:
    items = items or (PlanItem(task="tilt", takes=2, seconds=2.0),)
    collect = Collect()
    collect.begin(CollectPlan(items=items, **options), draw_slots(items, seed=1))
    return collect


def run(collect: Collect, seconds: float) -> list:
    return [collect.step() for _ in range(round(seconds / DT))]


def until(collect: Collect, phase: str, limit: float = 60.0) -> list:
    steps = []
    while not steps or steps[-1].phase != phase:
        steps.append(collect.step())
        assert len(steps) * DT < limit, (collect.phase, phase)
    return steps


def test_a_take_goes_through_preview_countdown_record_and_review():
    collect = machine()
    run(collect, 5.0)
    assert collect.phase == "ready"  # nobody has said go
    collect.act("go")
    steps = until(collect, "review")
    phases = [s.phase for s in steps]
    length = len(collect.slots[0].motion)
    assert phases.count("preview") == phases.count("record") == length
    assert phases.count("countdown") == round(COUNTDOWN_S / DT)
    events = [(s.event, s.phase) for s in steps if s.event]
    assert events == [("start", "record"), ("stop", "review")]


def test_every_frame_of_the_motion_is_shown_once_while_recording():
    collect = machine(preview=False)
    collect.act("go")
    steps = until(collect, "review")
    assert [s.frame for s in steps if s.phase == "record"] == list(
        range(len(collect.slots[0].motion))
    )
    assert {s.frame for s in steps if s.phase == "countdown"} == {None}


def test_keep_goes_on_and_redo_shows_the_same_motion_without_preview():
    collect = machine()
    collect.act("go")
    until(collect, "review")
    first = collect.slot
    assert first is not None
    collect.act("redo")
    assert collect.phase == "countdown"
    assert collect.slot is first
    until(collect, "review")
    assert first.tries == 2
    collect.act("keep")
    assert first.verdict == "kept"
    assert collect.slot is collect.slots[1]
    assert collect.slots[1].motion.poses[80] is not first.motion.poses[80]
    collect.act("next")
    assert collect.phase == "done"
    assert [s.verdict for s in collect.slots] == ["kept", "skipped"]


def test_hands_free_collects_the_whole_plan_without_a_button():
    collect = machine(hands_free=True, preview=False)
    steps = until(collect, "done", 120.0)
    assert [s.event for s in steps if s.event] == ["start", "stop"] * 2
    assert sum(s.phase == "review" for s in steps) == 2 * round(HANDS_FREE_REVIEW_S / DT)
    assert all(s.verdict == "kept" for s in collect.slots)


def test_abort_throws_a_running_take_away_and_waits():
    collect = machine(preview=False)
    collect.act("go")
    run(collect, COUNTDOWN_S + 1.0)
    assert collect.phase == "record"
    collect.act("abort")
    assert collect.step().event == "abort"
    assert collect.phase == "ready"
    assert collect.slot is collect.slots[0]


def test_an_action_that_means_nothing_now_says_what_does():
    collect = machine()
    with pytest.raises(StudioError, match="keep means nothing in phase ready; may be: go, next"):
        collect.act("keep")
    with pytest.raises(StudioError, match="unknown action"):
        collect.act("dance")
    with pytest.raises(StudioError, match="first make a plan"):
        Collect().act("go")


def test_a_new_plan_is_refused_while_a_take_is_recorded():
    collect = machine(preview=False)
    collect.act("go")
    run(collect, COUNTDOWN_S + 1.0)
    with pytest.raises(StudioError, match="being recorded"):
        collect.begin(CollectPlan(items=()), [])


def test_takes_added_to_a_finished_plan_make_it_ready_again():
    collect = machine(PlanItem(task="crouch", takes=1, seconds=2.0), preview=False)
    collect.act("next")
    assert collect.phase == "done"
    collect.add(draw_slots((PlanItem(task="tilt", takes=1, seconds=2.0),), 1, first=1))
    assert collect.phase == "ready"
    assert collect.slot is not None
    assert collect.slot.item.task == "tilt"


@pytest.mark.parametrize("bad", [{"takes": 0}, {"seconds": 900.0}, {"difficulty": 2.0}])
def test_a_plan_that_cannot_be_done_is_refused(bad):
    with pytest.raises(StudioError):
        draw_slots((PlanItem(task="tilt", **bad),), 0)
    with pytest.raises(StudioError, match="unknown task"):
        draw_slots((PlanItem(task="fly"),), 0)


@pytest.mark.parametrize("task", TASKS)
def test_what_is_shown_begins_and_ends_quiet_and_is_within_the_robots_limits(task):
    track = between_rests(TASKS[task].sample(np.random.default_rng(3), 4.0, 0.7), QUIET_S)
    motion = realize(track)
    assert check(motion) == []
    quiet = round(QUIET_S / DT)
    neutral = NEUTRAL[track.state].joint_pos
    # A walk ends with its feet down, not each straight under its hip.
    for rest, near in ((motion.joint_pos[:quiet], 1e-6), (motion.joint_pos[-quiet + 1 :], 0.4)):
        assert np.ptp(rest, axis=0).max() < 1e-6
        assert np.abs(rest[0] - neutral).max() < (near if track.state == "walk" else 1e-3)
    assert motion.foot_contact[-1].min() == (0.0 if track.state == "sit" else 1.0)


def test_the_metronome_ticks_when_a_foot_lifts():
    motion = draw_motion(PlanItem(task="walk", seconds=6.0), (4, 0))
    assert len(motion.beats) > 3
    contact = np.array([pose.foot_contact for pose in motion.poses])
    lifts = np.flatnonzero((np.diff((contact > 0.5).astype(int), axis=0) < 0).any(axis=1)) * DT
    apart = np.abs(lifts[:, None] - np.array(motion.beats)).min(axis=1)
    # At full tempo feet lift on the tick; the first steps, which grow, come early.
    assert np.median(apart) <= 2.0 * DT
    assert apart.max() < 0.4
    assert draw_motion(PlanItem(task="tilt"), (4, 0)).beats == ()


def test_beats_are_half_a_stride_apart():
    track = between_rests(TASKS["walk"].sample(np.random.default_rng(5), 6.0, 0.7), QUIET_S)
    ticks = beats(track)
    cadence = np.median(track.cadence[track.cadence > 0.1])
    assert np.median(np.diff(ticks)) == pytest.approx(0.5 / cadence, abs=1.5 * DT)
