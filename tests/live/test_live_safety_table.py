"""Every row of the safety table, acted out: what the robot does, how soon, and how it goes on."""

import errno
import json
import os
from pathlib import Path

import numpy as np
import pytest
from fake_clock import FakeClock
from human_frames import object_of
from turning import DT, ask, run

from studio.errors import StudioError
from studio.human.pose import HumanPose
from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.runtime import RuntimeConfig
from studio.live.safety_table import ROWS, page
from studio.mocap.gate import FrameGate
from studio.mocap.stream import StreamSource
from studio.robot import a1
from studio.synthetic.operator import OperatorSource
from studio.takes.record import recorder as recorder_module
from studio.takes.session_library import SessionLibrary
from studio.web.page_control import PageControl

MAX_TARGET_STEP = 0.7
"""rad in a period."""
BY_KEY = {row.key: row for row in ROWS}
DOCS = Path(__file__).parents[2] / "docs" / "safety.md"


class Studio:
    """A loop on a fake clock whose person comes over the line, as a phone's does."""

    def __init__(self, sessions: Path, task: str = "walk", spec: str = "stream") -> None:
        self.sessions = sessions
        config = RuntimeConfig(source=spec, sessions=sessions)
        self.loop = LiveLoop(config, clock=FakeClock())
        self.on_this_clock()
        self.person, self.t = OperatorSource(task, seed=3), 0.0
        self.pose: HumanPose | None = None
        self.tick = self.period(self.frame())
        if spec == "stream":
            self.do(c.Arm())
        self.go(3.0)
        assert self.state["reason"] == "", self.state["why"]

    def on_this_clock(self) -> None:
        """The line's rate and ages are held against the fake clock, too."""
        source = self.loop.runtime.source
        if isinstance(source, StreamSource):
            source._clock = self.loop.clock.now
            source._opened = source._clock()
            source._gate = FrameGate(live=True, clock=source._clock)

    def frame(self) -> dict:
        self.pose = self.person.read(self.t) or self.pose
        assert self.pose is not None
        return object_of(self.pose)

    def period(self, frame: dict | None = None):
        """One control period, in which a frame comes or none; its tick."""
        if frame is not None and self.loop.runtime.source.name.startswith("stream"):
            self.loop.push_frame(json.dumps(frame))
        (self.tick,) = run(self.loop, DT)
        self.t += DT
        return self.tick

    def go(self, seconds: float) -> list:
        """The person is seen in each period."""
        return [self.period(self.frame()) for _ in range(round(seconds / DT))]

    def do(self, command):
        answer = ask(self.loop, command)
        assert answer.ok, answer.why
        return answer.state

    @property
    def state(self) -> dict:
        return self.loop.state_dict()

    def until(self, reason: str, each) -> float:
        """s until the state says so; `each` is what happens in every period."""
        begun = self.loop.clock.now()
        for _ in range(120):
            each()
            if self.state["reason"] == reason:
                return self.loop.clock.now() - begun
        raise AssertionError(f"never {reason}: {self.state['why']}")

    def goes_on(self) -> None:
        """The robot follows the person again."""
        self.go(2.5)
        assert self.state["reason"] == "", self.state["why"]


@pytest.fixture
def studio(tmp_path):
    return Studio(tmp_path / "sessions")


def within(studio: Studio, key: str, each) -> None:
    row = BY_KEY[key]
    assert studio.until(row.reason, each) <= row.within + 1e-6
    assert studio.state["stopped"] == row.latched
    assert studio.state["needs_reset"] == row.latched


def latched_until_reset_and_armed(studio: Studio) -> None:
    studio.go(0.5)
    assert studio.state["stopped"]
    assert not ask(studio.loop, c.Arm()).ok
    studio.do(c.Reset())
    studio.go(0.5)
    assert studio.state["stopped"]  # it stands, and does not follow
    studio.do(c.Arm())
    studio.goes_on()


def still(studio: Studio) -> None:
    """At the latest 1.5 s later the robot has come to a stand, upright."""
    ticks = [studio.period() for _ in range(75)]
    moved = np.ptp([tick.reference.joint_pos for tick in ticks[-15:]], axis=0)
    assert moved.max() < 0.01
    assert ticks[-1].robot.base_pos[2] > 0.2
    assert not ticks[-1].fallen


def test_the_table_has_a_test_for_each_row():
    acted = {name.removeprefix("test_row_") for name in globals() if name.startswith("test_row_")}
    assert acted == set(BY_KEY)


def test_the_page_in_the_docs_is_made_of_the_table():
    assert DOCS.read_text() == page(), "write it anew: make tables"


def test_row_stop(studio):
    begun = studio.loop.clock.now()
    state = studio.do(c.Stop())
    assert studio.loop.clock.now() - begun <= BY_KEY["stop"].within + 1e-6
    assert (state["stopped"], state["reason"]) == (True, "stopped")
    latched_until_reset_and_armed(studio)


def test_row_fall(studio):
    world = studio.loop.runtime.puppeteer.stage.world
    for _ in range(40):
        world.push(np.array([0.0, 6.0, 1.5]))
        fell = [tick for tick in studio.go(0.3) if tick.fallen]
        if fell:
            break
    assert fell
    # The loop says so in the period in which the fall is seen.
    assert (studio.state["reason"], studio.state["stopped"]) == ("fallen", True)
    assert studio.state["counters"]["falls"] == 1
    latched_until_reset_and_armed(studio)


def test_row_nan(studio, monkeypatch):
    controller = studio.loop.runtime.puppeteer.controller
    with monkeypatch.context() as broken:
        broken.setattr(controller, "act", lambda *_: np.full(12, np.nan))
        begun = studio.loop.clock.now()
        studio.loop.push_frame(json.dumps(studio.frame()))
        studio.loop.tick()
        assert studio.loop.clock.now() - begun <= BY_KEY["nan"].within
        assert (studio.state["stopped"], studio.state["needs_reset"]) == (True, True)
        studio.loop.wait()
        studio.t += DT
    assert np.isfinite(studio.loop.runtime.puppeteer.robot.joint_pos).all()
    studio.do(c.Reset())
    studio.do(c.Arm())
    studio.goes_on()


def test_row_hidden(studio):
    within(studio, "hidden", studio.period)
    still(studio)
    studio.goes_on()


def test_row_implausible(studio):
    refused = studio.state["counters"]["rejected"]
    bad = [
        {"positions": [[1, 2, 3]]},
        {"positions": [[float("nan")] * 3] * 19},
        {"positions": [[1e9] * 3] * 19},
        {"t": -1.0},
    ]

    def each() -> None:
        for change in bad:
            with pytest.raises(StudioError):
                studio.loop.push_frame(json.dumps({**studio.frame(), **change}))
        studio.period()

    within(studio, "implausible", each)
    assert studio.state["counters"]["rejected"] >= refused + 4 * len(bad)
    still(studio)
    studio.goes_on()


def test_row_jump(studio):
    before = studio.tick
    for k in range(30):
        frame = studio.frame()
        yaw = 0.35 * (-1) ** k  # there and back: 40 degrees and half a metre, at 15 m/s
        turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
        shift = [0.22 * (-1) ** k, 0.0, 0.0]
        frame["positions"] = (np.array(frame["positions"]) @ turn.T + shift).tolist()
        tick = studio.period(frame)
        assert np.abs(tick.target - before.target).max() <= MAX_TARGET_STEP + 1e-9
        assert not tick.fallen
        before = tick
    studio.goes_on()


def test_row_nobody(studio):
    studio.do(c.SetSource(source="stream"))
    studio.on_this_clock()
    studio.do(c.Arm())
    within(studio, "nobody", studio.period)
    still(studio)
    studio.person, studio.t = OperatorSource("quiet", seed=3), 0.0
    studio.goes_on()


def test_row_ended(tmp_path):
    frames = tmp_path / "a.jsonl"
    person = OperatorSource("walk", seed=3)
    poses = [person.read(k / 30.0) for k in range(150)]
    frames.write_text("\n".join(json.dumps(object_of(pose)) for pose in poses if pose))
    studio = Studio(tmp_path / "sessions", spec=f"frames:{frames}")
    while not studio.loop.runtime.reader.ended:
        studio.period()
        assert studio.t < 10.0
    within(studio, "ended", studio.period)
    still(studio)
    studio.do(c.Transport(action="again"))
    studio.go(2.5)
    assert studio.state["reason"] == ""


def test_row_swap(studio):
    begun = studio.loop.clock.now()
    state = studio.do(c.SetSource(source="stream"))
    studio.on_this_clock()
    assert studio.loop.clock.now() - begun <= BY_KEY["swap"].within + 1e-6
    assert (state["reason"], state["armed"]) == ("idle", False)
    studio.go(1.0)  # somebody is there, and is not followed
    assert studio.state["reason"] == "idle"
    still(studio)
    studio.do(c.Arm())
    studio.goes_on()


def test_row_page(studio):
    studio.do(c.TakeControl(page="laptop"))
    for _ in range(10):
        studio.loop.beat("laptop")
        studio.go(0.1)
    assert studio.state["reason"] == ""
    studio.loop.beat("laptop")
    within(studio, "page", lambda: studio.go(DT))
    still(studio)
    studio.loop.beat("laptop")
    studio.period(studio.frame())
    assert studio.state["reason"] == ""
    within(studio, "page", lambda: studio.go(DT))  # it hangs again, and somebody else arms
    studio.do(c.Arm())
    studio.goes_on()


def test_row_away(studio):
    control = PageControl(studio.loop.post, studio.loop.beat, studio.loop.silent)
    laptop = control.join()
    for _ in range(20):
        control.beat(laptop.name, visible=False, keys=frozenset(), round_trip_ms=1.0)
        studio.go(0.1)
    assert studio.state["reason"] == ""
    assert control.state()["away"]
    other = control.join()
    assert control.holder == laptop.name
    control.act("take", other.name)
    studio.go(DT)
    assert not control.state()["away"]
    assert studio.state["reason"] == ""


def test_row_overrun(studio):
    def late() -> None:
        studio.loop.push_frame(json.dumps(studio.frame()))
        studio.loop.tick()
        studio.loop.clock.advance(1.9 * DT)  # what a period costs this computer
        studio.loop.wait()
        studio.t = studio.loop.clock.now()

    within(studio, "overrun", late)
    assert not any(tick.fallen for tick in studio.go(1.5))
    studio.goes_on()


def test_row_limits(studio, monkeypatch):
    controller = studio.loop.runtime.puppeteer.controller
    rng = np.random.default_rng(0)
    monkeypatch.setattr(controller, "act", lambda *_: rng.uniform(-50.0, 50.0, 12))
    before = studio.tick
    for _ in range(45):
        tick = studio.period(studio.frame())
        assert (tick.target >= a1.JOINT_LOWER - 1e-9).all()
        assert (tick.target <= a1.JOINT_UPPER + 1e-9).all()
        assert np.abs(tick.target - before.target).max() <= MAX_TARGET_STEP + 1e-9
        assert np.abs(tick.robot.torque).max() <= a1.TORQUE_LIMIT[0] + 1e-6
        before = tick
        if studio.state["stopped"]:
            break


def test_row_disk(studio, monkeypatch):
    name = studio.do(c.StartTake())["recording"]["name"]
    studio.go(0.5)

    def full(handle: int, data: bytes) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(recorder_module.os, "write", full)
    studio.go(2.0)
    assert studio.state["reason"] == ""  # it is driven on
    assert studio.state["recording"] is None
    monkeypatch.undo()
    assert name in {take.name for take in SessionLibrary(studio.sessions).list()}
