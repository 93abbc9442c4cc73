"""A fault that comes again is told once and counted; the loop says that the robot is stopped."""

import logging
import threading

import numpy as np
import pytest
from fake_clock import FakeClock

from studio.live import commands as c
from studio.live.disk_writer import DiskWriter
from studio.live.faults import AGAIN_S, RECENT_S, Faults
from studio.live.loop import LiveLoop
from studio.live.runtime import RuntimeConfig

log = logging.getLogger("test")


def fail(number=0):
    raise ValueError(f"number {number}")


def caught(work, *args) -> Exception:
    try:
        work(*args)
    except Exception as error:
        return error
    raise AssertionError("nothing was raised")


def test_the_same_fault_is_told_in_full_once_then_with_its_number_once_a_minute(caplog):
    clock = FakeClock()
    faults = Faults(log, clock.now)
    for number in range(1000):
        faults.tell("it failed", caught(fail, number))
    assert [record.exc_info is not None for record in caplog.records] == [True]
    clock.advance(AGAIN_S)
    faults.tell("it failed", caught(fail))
    assert caplog.records[1].getMessage() == "it failed: number 0 (1001 times so far)"
    assert caplog.records[1].exc_info is None
    assert faults.count == 1001


def test_another_fault_is_told_in_full_though_one_is_told_already(caplog):
    faults = Faults(log)
    faults.tell("it failed", caught(fail))
    faults.tell("it failed", caught(int, "x"))
    faults.tell("something else failed", caught(fail))
    assert len([record for record in caplog.records if record.exc_info]) == 3


def test_a_fault_is_recent_for_two_seconds():
    clock = FakeClock(100.0)
    faults = Faults(log, clock.now)
    assert not faults.recent
    faults.tell("it failed", caught(fail))
    assert faults.recent
    clock.advance(RECENT_S + 0.01)
    assert not faults.recent


@pytest.fixture
def loop(tmp_path):
    """A loop on a fake clock that follows a quiet person."""
    config = RuntimeConfig(source="operator:quiet", sessions=tmp_path / "sessions")
    loop = LiveLoop(config, clock=FakeClock())
    for _ in range(30):
        loop.tick()
        loop.wait()
    assert loop.state_dict()["armed"]
    return loop


def test_a_policy_that_says_nan_stops_the_robot_and_fills_no_log(loop, caplog):
    for policy in loop.runtime.puppeteer.controller._policies.values():
        policy.layers.weights[0][:] = np.nan
    ticks = loop.ticks.version
    for _ in range(90):
        loop.tick()
        loop.wait()
    state = loop.state_dict()
    assert (state["stopped"], state["armed"], state["needs_reset"]) == (True, False, True)
    assert "finite" in state["why"]
    assert loop.faults.count == 90
    assert loop.faults.recent
    assert loop.ticks.version == ticks  # nobody is shown a robot that was not computed
    assert len(caplog.records) == 1


def test_whatever_fails_in_a_period_stops_the_robot(loop, monkeypatch):
    monkeypatch.setattr(loop.runtime, "_collect", fail)
    loop.tick()
    state = loop.state_dict()
    assert (state["stopped"], state["armed"]) == (True, False)
    assert "number 0" in state["why"]


class StandingClock(FakeClock):
    """Time that does not pass until whoever sleeps has been woken."""

    woken = False

    def sleep_until(self, t, wake=None):
        assert wake is not None
        self.woken = self.woken or wake.wait(120.0)


def test_a_stop_is_applied_and_answered_between_two_ticks(loop):
    loop._metronome._clock = StandingClock()
    ticks = loop.ticks.version
    threading.Thread(target=loop.wait, daemon=True).start()
    result = loop.submit(c.Stop(by="somebody"), timeout=120.0)
    assert result.ok
    assert (result.state["stopped"], result.state["armed"]) == (True, False)
    assert "somebody" in result.state["why"]
    assert result.state["stops"] == loop.stops == 1
    assert loop.ticks.version == ticks


def test_what_would_release_the_robot_and_was_sent_before_such_a_stop_is_refused(loop):
    loop._metronome._clock = StandingClock()
    seen = loop.stops
    threading.Thread(target=loop.wait, daemon=True).start()
    assert loop.submit(c.Stop(), timeout=120.0).ok
    answers = []
    asks = [
        threading.Thread(target=lambda x=command: answers.append(loop.submit(x, 20.0, seen)))
        for command in (c.Reset(), c.Arm())
    ]
    for ask in asks:
        ask.start()
    while any(ask.is_alive() for ask in asks):
        loop.tick()
    assert [answer.ok for answer in answers] == [False, False]
    assert loop.state_dict()["stopped"]


def test_disk_work_that_fails_is_told_of_and_the_next_is_done():
    disk, done = DiskWriter(), []
    disk.do(fail)
    disk.do(lambda: done.append(1))
    disk.close()
    assert done == [1]
    assert "number 0" in disk.problem
