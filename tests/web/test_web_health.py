"""Health tells the truth; what ended is started again; one page's trouble is nobody else's."""

import json
import threading
import time

import pytest
from browsing import PATIENCE

from studio.live.commands import SetSource
from studio.live.loop import LiveLoop
from studio.web import feed, supervisor

ENDS = pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
"""The test ends a thread, of which pytest would complain."""


def health(studio) -> tuple[int, dict]:
    answer = studio.client.get("/api/health")
    return answer.status_code, answer.json()


def wait_for(true, seconds=PATIENCE):
    """The first value that is true."""
    deadline = time.monotonic() + seconds
    while not (value := true()):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    return value


def why(studio) -> str:
    """What health complains about."""
    return health(studio)[1].get("why", "")


@pytest.fixture
def well(studio_live, monkeypatch):
    """A studio that was well, and is well again afterwards; what happened in it is remembered for
    as long as a busy machine may need to ask."""
    wait_for(lambda: health(studio_live)[0] == 200)
    monkeypatch.setattr(supervisor, "REMEMBERED_S", 1e6)
    yield studio_live
    wait_for(lambda: health(studio_live)[0] == 200)


def test_a_studio_that_works_is_ok_and_says_which_version(well, monkeypatch):
    import studio

    monkeypatch.setattr(supervisor, "REMEMBERED_S", 0.0)  # what other tests have done to it
    wait_for(lambda: health(well)[1] == {"status": "ok", "version": studio.__version__}, 60.0)


def test_a_tick_that_cannot_be_encoded_is_lost_alone(well, monkeypatch):
    encode, failed = feed.tick_json, []

    def sometimes(tick):
        if tick.index % 10 == 0:
            failed.append(tick.index)
            raise ValueError("no such number")
        return encode(tick)

    monkeypatch.setattr(feed, "tick_json", sometimes)
    with well.ws("/api/ticks") as ws:
        seen = [json.loads(ws.recv(timeout=PATIENCE))["index"] for _ in range(40)]
    assert failed
    assert not set(seen) & set(failed)
    assert max(seen) > min(failed)
    _, said = wait_for(lambda: (h := health(well))[0] == 200 and "feed" in why(well) and h)
    assert said["status"] == "degraded"


@ENDS
def test_a_feed_that_ended_is_started_again_and_health_says_so(well, monkeypatch):
    encode, ended = feed.tick_json, threading.Event()

    def end_once(tick):
        if not ended.is_set():
            ended.set()
            raise SystemExit  # which ends a thread without a word
        return encode(tick)

    monkeypatch.setattr(feed, "tick_json", end_once)
    with well.ws("/api/ticks") as ws:
        wait_for(ended.is_set)
        before = well.state()["t"]
        while json.loads(ws.recv(timeout=PATIENCE))["t"] <= before:
            pass
    assert "the feed ended and was started again" in why(well)


@ENDS
def test_a_view_that_ended_is_started_again(well, monkeypatch):
    from studio.web.scene import StudioScene

    update, ended = StudioScene.update, threading.Event()

    def end_once(self, tick, dt):
        if not ended.is_set():
            ended.set()
            raise SystemExit
        update(self, tick, dt)

    monkeypatch.setattr(StudioScene, "update", end_once)
    wait_for(ended.is_set)
    wait_for(lambda: "the view ended and was started again" in why(well))


def test_a_control_loop_that_ended_is_started_again_with_its_robot_stopped(well, monkeypatch):
    collect, ended = LiveLoop._collect_garbage, threading.Event()

    def end_once(self, count):
        if not ended.is_set():
            ended.set()
            raise RuntimeError("the loop's own mistake")
        collect(self, count)

    monkeypatch.setattr(LiveLoop, "_collect_garbage", end_once)
    wait_for(ended.is_set)
    state = well.wait(lambda s: s["stopped"])
    assert "control loop had ended" in state["why"]
    assert not state["armed"]
    before = well.state()["t"]
    well.wait(lambda s: s["t"] > before)
    assert "the control loop ended and was started again" in why(well)


def test_control_periods_that_fail_are_degraded_and_503_until_they_do_not(well, monkeypatch):
    from studio.live.runtime import Runtime

    def fail(self, now):
        raise ValueError("a secret path /home/somebody")

    with monkeypatch.context() as patched:
        patched.setattr(Runtime, "step", fail)
        state = well.wait(lambda s: s["stopped"])
        assert (state["armed"], state["needs_reset"]) == (False, True)
        assert "somebody" in state["why"]  # for who has the token
        _, said = wait_for(lambda: "fail" in why(well) and (h := health(well))[0] == 503 and h)
        assert said["status"] == "degraded"
        assert "control periods fail" in said["why"]
        assert "somebody" not in said["why"]  # for everybody
    wait_for(lambda: health(well)[0] == 200)
    assert well.state()["stopped"] is True


def test_a_loop_that_hangs_is_degraded(well, monkeypatch):
    from studio.live.runtime import Runtime

    step, hang, go_on = Runtime.step, threading.Event(), threading.Event()

    def slow(self, now):
        hang.set()
        assert go_on.wait(PATIENCE)
        return step(self, now)

    with monkeypatch.context() as patched:
        patched.setattr(Runtime, "step", slow)
        try:
            wait_for(hang.is_set)
            _, said = wait_for(lambda: (h := health(well))[0] == 503 and h)
            assert "silent" in said["why"]
        finally:
            go_on.set()


# Commands, and what takes long --------------------------------------------------------------------


def test_sources_that_take_long_to_open_hold_up_no_reset(studio_live, monkeypatch):
    prepare, go_on, waiting = SetSource.prepare, threading.Event(), threading.Event()

    def slow(self, session):
        waiting.set()
        assert go_on.wait(PATIENCE)
        return prepare(self, session)

    monkeypatch.setattr(SetSource, "prepare", slow)
    post = studio_live.client.post
    asks = [
        threading.Thread(target=post, args=("/api/source",), kwargs={"json": {"source": "stream"}})
        for _ in range(12)
    ]
    for ask in asks:
        ask.start()
    try:
        assert waiting.wait(PATIENCE)
        assert post("/api/reset").status_code == 200
        assert post("/api/mode", json={"mode": "idle"}).json()["mode"] == "idle"
    finally:
        go_on.set()
        for ask in asks:
            ask.join(30.0)


# A stop's delivery --------------------------------------------------------------------------------


def acknowledged(ws) -> dict:
    while True:
        message = json.loads(ws.recv(timeout=PATIENCE))
        if message["type"] == "stopped":
            return message


@pytest.mark.parametrize("binary", [False, True])
def test_a_stop_is_acknowledged_with_its_number_as_text_and_in_binary(studio_live, binary):
    before = studio_live.state()["stops"]
    message = json.dumps({"type": "stop", "number": 41})
    with studio_live.ws("/api/control") as ws:
        ws.send(message.encode() if binary else message)
        first = acknowledged(ws)
        ws.send(message.replace("41", "42"))
        second = acknowledged(ws)
    assert (first["number"], second["number"]) == (41, 42)
    assert first["ok"]
    assert first["stops"] == before + 1
    assert second["stops"] == before + 2
    assert studio_live.state()["stopped"] is True


def test_a_stop_by_post_is_acknowledged_with_how_many_there_were(studio_live):
    first = studio_live.client.post("/api/stop").json()
    second = studio_live.client.post("/api/stop").json()
    assert first["stopped"] is True
    assert second["stops"] == first["stops"] + 1


@pytest.mark.parametrize("number", ['"7"', "null", "[]", "1e400", "7.5", "{}"])
def test_a_stop_with_an_odd_number_stops_all_the_same(studio_live, number):
    with studio_live.ws("/api/control") as ws:
        ws.send(f'{{"type": "stop", "number": {number}}}')
        assert acknowledged(ws)["ok"]
    assert studio_live.state()["stopped"] is True


def test_a_message_too_large_for_a_page_is_answered_and_not_read(studio_live):
    with studio_live.ws("/api/control") as ws:
        ws.send(json.dumps({"type": "stop", "note": "x" * 1_000_000}))
        while (message := json.loads(ws.recv(timeout=PATIENCE)))["type"] == "state":
            pass
        assert "bytes" in message["error"]
    assert studio_live.state()["stopped"] is False
