"""The live loop on a fake clock, with the real flow: modes, commands, safety, hostile frames."""

import errno
import os
from dataclasses import replace

import numpy as np
import pytest
from fake_clock import FakeClock
from pydantic import ValidationError
from turning import DT, ask, run

from studio.errors import StudioError
from studio.human.pose import HumanPose
from studio.live import commands as c
from studio.live.clock import WallClock
from studio.live.loop import LiveLoop
from studio.live.runtime import Runtime, RuntimeConfig
from studio.live.source_reader import OpenedSource, open_for
from studio.robot import a1
from studio.sources import Source, SourceEnded
from studio.synthetic.operator import OperatorSource
from studio.takes.record.tape import TapeWriter
from studio.takes.take import read_take


class Script(Source):
    """A source that a test writes: frame number -> what it gives."""

    name = "script"
    starts_live = True
    duration = None

    def __init__(self, change=lambda k, pose: pose, seed=0, task="quiet"):
        self._operator = OperatorSource(task, seed=seed)
        self._change = change
        self._k = -1

    def read(self, t):
        self._k += 1
        pose = self._operator.read(t)
        return self._change(self._k, pose)

    def calibration_poses(self):
        return self._operator.calibration_poses()

    def close(self):
        pass


@pytest.fixture
def make(tmp_path):
    """A loop on a fake clock that follows a given source."""

    def build(source=None, spec="operator") -> LiveLoop:
        config = RuntimeConfig(source=spec, sessions=tmp_path / "sessions")
        opened = open_for(spec, config.puppeteer, config.sessions)
        if source is not None:
            opened = OpenedSource(source=source, calibration=opened.calibration)
        return LiveLoop(clock=FakeClock(), runtime=Runtime(config, opened))

    return build


def within_limits(ticks):
    targets = np.array([tick.target for tick in ticks])
    assert np.isfinite(targets).all()
    assert (targets >= a1.JOINT_LOWER).all()
    assert (targets <= a1.JOINT_UPPER).all()
    return True


def test_an_operator_starts_live_and_armed_and_the_robot_follows(make):
    loop = make()
    ticks = run(loop, 2.0)
    state = loop.state_dict()
    assert (state["mode"], state["armed"], state["stopped"]) == ("live", True, False)
    assert state["counters"]["frames"] == 60
    assert state["counters"]["late"] == 0
    assert [tick.index for tick in ticks] == list(range(60))
    assert within_limits(ticks)


def test_the_state_has_every_key_the_contract_names(make):
    loop = make()
    run(loop, 0.1)
    state = loop.state_dict()
    keys = "mode state state_lock expert votes stopped armed why source scene latency_ms counters"
    assert set(keys.split()) | {"robot"} <= set(state)
    assert {"frames", "rejected", "stale", "clipped", "late"} <= set(state["counters"])
    assert set(state["robot"]) >= {"base_pos", "base_quat", "joint_pos", "foot_contact"}


def test_a_stream_starts_idle_until_armed_and_counts_frames_in_every_mode(make):
    loop = make(spec="stream")
    run(loop, 0.5)
    assert loop.state_dict()["mode"] == "idle"
    assert loop.state_dict()["why"].startswith("idle")
    answer = ask(loop, c.Arm())
    assert answer.ok
    assert (answer.state["mode"], answer.state["armed"]) == ("live", True)


def test_frames_are_counted_and_the_robot_rests_in_idle(make):
    loop = make()
    run(loop, 1.0)
    assert ask(loop, c.SetMode(mode="idle")).state["mode"] == "idle"
    before = loop.state_dict()["counters"]["frames"]
    ticks = run(loop, 2.0)
    assert loop.state_dict()["counters"]["frames"] == before + 60
    moved = np.ptp([tick.reference.joint_pos for tick in ticks[-20:]], axis=0)
    assert moved.max() < 1e-9
    assert loop.state_dict()["why"].startswith("idle")


def test_a_stop_latches_changes_neither_mode_nor_lock_and_damps(make):
    loop = make()
    run(loop, 1.0)
    ask(loop, c.SetStateLock(state="stand"))
    state = ask(loop, c.Stop()).state
    assert (state["mode"], state["state_lock"]) == ("live", "stand")
    assert (state["stopped"], state["armed"]) == (True, False)
    run(loop, 1.5)
    assert loop.state_dict()["robot"]["base_pos"][2] < 0.2  # it sinks to the floor, slowly
    refused = ask(loop, c.Arm())
    assert not refused.ok
    assert "reset" in refused.why
    up = ask(loop, c.Reset())
    assert up.ok
    assert up.state["stopped"]
    run(loop, 3.0)
    assert loop.state_dict()["stopped"]
    assert loop.state_dict()["robot"]["base_pos"][2] == pytest.approx(0.26, abs=0.02)
    armed = ask(loop, c.Arm()).state
    assert (armed["stopped"], armed["armed"], armed["why"]) == (False, True, "")


def test_the_state_has_a_word_for_why_and_how_long_ago_somebody_was_seen(make):
    loop = make(Script(lambda k, pose: pose if 10 < k < 40 else None))
    told = []
    for _ in range(70):
        loop.tick()
        told.append(loop.state_dict())
        loop.wait()
    assert [(s["reason"], s["stale_s"]) for s in told[:11]] == [("nobody", None)] * 11
    assert told[20]["reason"] == ""
    assert told[20]["stale_s"] == 0.0
    assert told[54]["reason"] == "stale"
    assert told[54]["stale_s"] == pytest.approx(15 * DT, abs=1e-3)  # the last came in period 39
    words = [ask(loop, command).state for command in (c.Stop(), c.Reset(), c.Arm())]
    assert [(s["reason"], s["needs_reset"]) for s in words[:2]] == [
        ("stopped", True),
        ("stopped", False),
    ]
    assert words[2]["reason"] == "stale"
    assert ask(loop, c.SetMode(mode="idle")).state["reason"] == "idle"
    assert all(bool(s["reason"]) == bool(s["why"]) for s in told + words)


def test_a_command_is_answered_after_the_tick_that_applied_it_or_with_why(make):
    loop = make()
    run(loop, 0.2)
    assert ask(loop, c.SetStateLock(state="sit")).state["state_lock"] == "sit"
    for command, word in (
        (c.SetMode(mode="replay"), "nothing to replay"),
        (c.SetSource(source="telepathy"), "unknown source"),
        (c.SetSource(source="bvh:/nowhere.bvh"), "/nowhere.bvh"),
        (c.StopTake(), "recorded"),
        (c.Seek(t=1.0), "replay"),
    ):
        answer = ask(loop, command)
        assert not answer.ok
        assert word in answer.why
        assert answer.state["mode"] == "live"


@pytest.mark.parametrize(
    ("command", "fields", "word"),
    [
        (c.SetStateLock, {"state": "fly"}, "unknown state"),
        (c.SetMode, {"mode": "party"}, "unknown mode"),
        (c.SetMode, {"mode": "live", "leaving": "party"}, "unknown mode"),
        (c.SetGain, {"name": "tilt_gain", "value": 99.0}, "between"),
        (c.SetGain, {"name": "charm", "value": 1.0}, "unknown gain"),
        (c.SetController, {"controller": "magic"}, "unknown controller"),
    ],
)
def test_a_command_outside_its_limits_cannot_even_be_made(command, fields, word):
    with pytest.raises(ValidationError, match=word):
        command(**fields)


def test_the_controller_is_switched_to_the_pd_and_back_while_the_robot_tilts(make):
    loop = make(Script(task="tilt"))
    run(loop, 3.0)
    assert loop.state_dict()["controller"] == "policy"
    for name in ("pd_playback", "policy"):
        answer = ask(loop, c.SetController(controller=name))
        assert answer.ok, answer.why
        assert answer.state["controller"] == name
        ticks = run(loop, 3.0)
        assert {tick.state for tick in ticks} == {"stand"}
        after = loop.state_dict()
        assert (after["controller"], after["stopped"]) == (name, False)
        assert after["robot"]["base_pos"][2] > 0.2


def test_a_locked_state_is_kept_whatever_the_person_does(make):
    loop = make(Script(task="walk"))
    run(loop, 0.2)
    ask(loop, c.SetStateLock(state="stand"))
    ticks = run(loop, 6.0)
    assert {tick.state for tick in ticks[60:]} == {"stand"}
    assert ticks[-1].why.startswith("locked")
    assert loop.state_dict()["reason"] == "locked"


def test_a_new_source_is_followed_from_its_start_without_a_jump(make):
    loop = make()
    before = run(loop, 1.0)[-1]
    answer = ask(loop, c.SetSource(source="operator:crouch"))
    assert answer.ok, answer.why
    assert answer.state["source"] == "operator:crouch"
    after = run(loop, 1.0)
    joints = np.array([tick.reference.joint_pos for tick in (before, *after)])
    # One or two ticks passed in between, while the source was opened: 4 degrees each.
    assert np.degrees(np.abs(np.diff(joints, axis=0)).max()) < 13.0


def test_frames_that_stop_coming_are_reused_then_the_robot_stands(make):
    loop = make(Script(lambda k, pose: pose if k < 150 else None, task="walk"))
    ticks = run(loop, 9.0)
    assert ticks[149].state == "walk"
    assert ticks[149 + 13].why == ""  # the march goes on as it went
    assert ticks[149 + 16].why.startswith("stale")
    at_half_a_second = ticks[149 + 16]
    assert at_half_a_second.transition_to == "stand"
    assert ticks[-1].state == "stand"
    assert loop.state_dict()["counters"]["stale"] > 100
    assert not any(tick.fallen for tick in ticks)


def test_the_robot_stands_when_the_source_has_ended(make):
    def ends(k, pose):
        if k >= 60:
            raise SourceEnded("script")
        return pose

    loop = make(Script(ends))
    ticks = run(loop, 5.0)
    assert ticks[-1].why.startswith("ended")
    assert ticks[-1].state == "stand"
    assert loop.state_dict()["mode"] == "live"


def test_a_page_that_goes_away_makes_the_robot_stand_within_half_a_second(make):
    loop = make(Script(task="walk"))
    run(loop, 3.0)
    ask(loop, c.TakeControl(page="page-1"))
    for _ in range(30):
        loop.beat("page-1")
        run(loop, DT)
    assert loop.state_dict()["why"] == ""
    gone = run(loop, 0.5)
    assert gone[-1].why.startswith("page lost")
    assert gone[-1].transition_to == "stand"
    assert run(loop, 3.0)[-1].state == "stand"


def hostile(k, pose):
    """One in three frames is something no person could be."""
    if k < 30 or k % 3:
        return pose
    rng = np.random.default_rng(k)
    joints = pose.joint_pos_w.copy()
    kind = (k // 3) % 8
    if kind == 0:
        joints[rng.integers(19)] = np.nan
    elif kind == 1:
        joints[rng.integers(19), 0] = np.inf
    elif kind == 2:
        joints += 50.0
    elif kind == 3:
        joints *= 1000.0
    elif kind == 4:
        return replace(pose, t=pose.t - 1.0)
    elif kind == 5:
        return replace(pose, t=float("nan"))
    elif kind == 6:
        return "a string"
    else:
        broken = object.__new__(HumanPose)
        object.__setattr__(broken, "t", pose.t)
        object.__setattr__(broken, "joint_pos_w", np.zeros((4, 2)))
        object.__setattr__(broken, "confidence", np.ones(19))
        return broken
    return replace(pose, joint_pos_w=joints)


def test_hostile_poses_are_refused_and_counted_and_the_robot_goes_on(make):
    loop = make(Script(hostile))
    ticks = run(loop, 8.0)
    counters = loop.state_dict()["counters"]
    assert counters["frames"] == 240
    assert counters["rejected"] == 70  # every third of the 210 frames after the first second
    assert within_limits(ticks)
    assert not any(tick.fallen for tick in ticks)
    for tick in ticks:
        assert np.isfinite(tick.reference.joint_pos).all()
        assert np.isfinite(tick.robot.joint_pos).all()


def test_hostile_frames_from_a_socket_are_refused_counted_and_close_nothing(make):
    loop = make(spec="stream")
    run(loop, 0.1)
    bad = [
        b"", "nonsense", "{}", '{"t": 0}', "[" * 5000, b"\xff\xfe", "x" * 1_000_000,
        '{"t": 1, "skeleton": "studio", "positions": [[1,2,3]]}',
        '{"t": NaN, "skeleton": "studio", "positions": []}', {"t": 1}, None, 3,
    ]  # fmt: skip
    for raw in bad:
        with pytest.raises(Exception, match=r".+") as error:
            loop.push_frame(raw)
        assert "\n" not in str(error.value)
    ticks = run(loop, 0.5)
    assert loop.state_dict()["counters"]["rejected"] == len(bad)
    assert within_limits(ticks)


def test_a_source_that_raises_leaves_the_robot_standing_and_the_loop_alive(make):
    def breaks(k, pose):
        if k == 40:
            raise RuntimeError("cable pulled")
        return pose

    loop = make(Script(breaks))
    ticks = run(loop, 3.0)
    assert len(ticks) == 90
    assert ticks[-1].why.startswith("ended")


def test_a_fault_in_the_flow_stops_the_robot_and_the_loop_lives_to_be_reset(make, monkeypatch):
    loop = make()
    run(loop, 0.5)
    monkeypatch.setattr(loop.runtime.puppeteer.controller, "act", lambda *_: np.full(12, np.nan))
    run(loop, 0.2)
    assert loop.state_dict()["stopped"]
    assert "fault" in loop.state_dict()["why"]
    assert loop.state_dict()["reason"] == "fault"
    monkeypatch.undo()
    assert ask(loop, c.Reset()).ok
    assert ask(loop, c.Arm()).ok
    assert run(loop, 1.0)[-1].why == ""


def test_a_late_period_is_counted_and_a_slow_computer_is_told(make):
    loop = make()
    run(loop, 0.5)
    loop.clock.advance(0.05)
    run(loop, 0.2)
    assert loop.state_dict()["counters"]["late"] == 1
    for _ in range(40):
        loop.tick()
        loop.clock.advance(0.05)
        loop.wait()
    assert loop.runtime.safety.overrun
    loop.tick()
    assert loop.state_dict()["why"].startswith("overrun")
    assert loop.state_dict()["reason"] == "overrun"


def test_what_was_recorded_can_be_replayed_paused_and_left(make):
    loop = make()
    name = ask(loop, c.StartTake(label="wave")).data["name"]
    live = run(loop, 1.0)
    stopped = ask(loop, c.StopTake()).data
    assert stopped["name"] == name
    assert stopped["ticks"] >= 30
    assert ask(loop, c.SetMode(mode="replay")).state["mode"] == "replay"
    ask(loop, c.Seek(t=0.0, playing=True))
    shown = run(loop, 0.5)
    assert all(tick.mode == "replay" for tick in shown)
    recorded = np.array([tick.robot.joint_pos for tick in live])
    apart = np.abs(recorded - shown[8].robot.joint_pos).max(axis=1)
    assert apart.min() < 1e-5  # the tape keeps float32
    ask(loop, c.Seek(playing=False))
    assert "nothing new to record" in ask(loop, c.StartTake()).why
    paused = run(loop, 0.3)
    assert len({tick.index for tick in paused}) == 1
    assert paused[-1].why.startswith("replay")
    assert loop.state_dict()["reason"] == "paused"
    assert ask(loop, c.SetMode(mode="live", leaving="replay")).state["mode"] == "live"
    loop.runtime.close()


def test_a_mode_that_was_chosen_meanwhile_is_not_left(make):
    loop = make()
    assert ask(loop, c.SetMode(mode="idle")).state["mode"] == "idle"
    assert ask(loop, c.SetMode(mode="live", leaving="replay")).state["mode"] == "idle"


def full(*_):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_a_full_disk_ends_the_take_keeps_it_and_the_state_says_why(make, monkeypatch):
    loop = make()
    name = ask(loop, c.StartTake(label="wave")).data["name"]
    run(loop, 1.0)
    before = loop.state_dict()
    assert before["recording_error"] is None
    with monkeypatch.context() as patch:
        patch.setattr(TapeWriter, "write", full)
        ticks = run(loop, 0.5)
    state = loop.state_dict()
    assert len(ticks) == 15
    assert not state["stopped"]
    assert state["recording"] is None
    assert "No space left" in state["recording_error"]
    kept = before["recording"]["ticks"]
    assert f"take {name} keeps its first {kept} ticks" in state["recording_error"]
    assert len(read_take(loop.config.sessions / name)) == kept >= 30
    again = ask(loop, c.StartTake(label="again"))
    assert again.ok
    assert again.state["recording_error"] is None
    loop.runtime.close()


@pytest.mark.parametrize(
    "error", [OSError(errno.ENOSPC, "full"), StudioError("gone"), KeyError("x")]
)
def test_a_take_that_cannot_be_indexed_is_kept_and_the_state_says_why(make, monkeypatch, error):
    def fails(*_):
        raise error

    loop = make()
    name = ask(loop, c.StartTake(label="wave")).data["name"]
    run(loop, 0.5)
    with monkeypatch.context() as patch:
        patch.setattr(TapeWriter, "finish", fails)
        ticks = ask(loop, c.StopTake()).data["ticks"]
        loop.runtime.recorder.wait()
    run(loop, DT)
    assert loop.state_dict()["recording_error"].startswith(f"take {name} is kept, but not indexed")
    assert len(read_take(loop.config.sessions / name)) == ticks
    loop.runtime.close()


def test_a_full_queue_answers_at_once_and_still_lets_a_stop_through(make):
    loop = make()
    run(loop, 0.1)
    while loop.post(c.SetMirror(mirror=False)):
        pass
    assert "try again" in loop.submit(c.SetMirror(mirror=True), timeout=0.1).why
    assert loop.post(c.Stop())
    run(loop, 0.1)
    assert loop.state_dict()["stopped"]


def test_the_thread_ticks_thirty_times_a_second_and_ends_in_good_order(tmp_path):
    loop = LiveLoop(RuntimeConfig(sessions=tmp_path), clock=WallClock())
    loop.start()
    try:
        version, tick = loop.ticks.wait(20, timeout=120.0)
        assert version > 20
        assert tick is not None
        assert loop.submit(c.SetStateLock(state="stand")).ok
    finally:
        loop.stop()
    assert loop.ticks.version < 400
    after = loop.ticks.version
    assert loop.submit(c.Arm(), timeout=0.2).ok is False
    assert loop.ticks.version == after


@pytest.mark.parametrize(("waits", "played"), [(True, 2.0), (False, 3.0)])
def test_a_played_person_waits_for_a_robot_that_lost_time_and_a_seen_one_does_not(
    make, waits, played
):
    source = Script()
    source.starts_live = waits
    asked = []
    read = source.read
    source.read = lambda t: asked.append(t) or read(t)
    loop = make(source)
    for _ in range(60):
        loop.tick()
        loop.clock.advance(1.5 * DT)  # a computer that does 20 periods a second
        loop.wait()
    # 60 periods of the robot are 2 s, of the clock 3 s; up to 3 periods may still be caught up.
    assert asked[-1] == pytest.approx(played, abs=6 * DT)
    assert max(np.diff(asked)) < (2.6 if waits else 5) * DT


def test_a_stop_in_replay_says_what_frees_it_until_the_robot_is_armed(make):
    loop = make()
    ask(loop, c.StartTake(label="x"))
    run(loop, 0.5)
    ask(loop, c.StopTake())
    assert ask(loop, c.SetMode(mode="replay")).state["mode"] == "replay"
    said = []
    for command in (c.Stop(by="test"), c.Reset(), c.Arm()):
        said.append(ask(loop, command).state)
    assert [s["mode"] for s in said] == ["replay"] * 3
    assert "reset, then arm" in said[0]["why"]
    assert "arm to go on" in said[1]["why"]
    assert "stopped" not in said[2]["why"]
