"""Every cell of the table of modes, acted out: from each mode, everything that may happen."""

from pathlib import Path

import pytest
from fake_clock import FakeClock
from turning import ask, run

from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.mode_table import EVENTS, FROM, REFUSED, STAYS, page
from studio.live.runtime import RuntimeConfig
from studio.web.page_control import PageControl

DOCS = Path(__file__).parents[2] / "docs" / "modes.md"
COMMANDS = {
    "idle": c.SetMode(mode="idle"),
    "live": c.SetMode(mode="live"),
    "replay": c.SetMode(mode="replay"),
    "replay_nothing": c.SetMode(mode="replay"),
    "collect": c.SetMode(mode="collect"),
    "collect_recording": c.SetMode(mode="collect"),
    "replay_recording": c.SetMode(mode="replay"),
    "file": c.SetSource(source="operator:quiet"),
    "stream": c.SetSource(source="stream"),
    "arm": c.Arm(),
    "stop": c.Stop(),
    "reset": c.Reset(),
    "record": c.StartTake(),
}


def done(loop: LiveLoop, command) -> dict:
    answer = ask(loop, command)
    assert answer.ok, answer.why
    return answer.state


def studio_in(start: str, event: str, sessions: Path) -> LiveLoop:
    """A studio in a mode of FROM; with a take to replay, but where there is to be none."""
    config = RuntimeConfig(source="operator:quiet", sessions=sessions)
    loop = LiveLoop(config, clock=FakeClock())
    run(loop, 0.2)
    if event != "replay_nothing" or start == "replay":
        done(loop, c.StartTake())
        run(loop, 0.3)
        done(loop, c.StopTake())
    if event.endswith("_recording"):
        done(loop, c.SetMode(mode="live"))
        done(loop, c.StartTake())
    if start == "waiting":
        done(loop, c.SetSource(source="stream"))
    else:
        done(loop, c.SetMode(mode=start))
    run(loop, 0.1)
    return loop


def cells():
    for event in EVENTS:
        for start, to in zip(FROM, event.to, strict=True):
            if event.key.endswith("_recording") and start in ("replay", "collect"):
                continue  # nothing is recorded by hand there
            yield pytest.param(event, start, to, id=f"{event.key}-{start}")


@pytest.mark.parametrize(("event", "start", "to"), list(cells()))
def test_a_cell_of_the_table(event, start, to, tmp_path):
    loop = studio_in(start, event.key, tmp_path / "sessions")
    try:
        before = loop.state_dict()
        assert before["mode"] == ("idle" if start == "waiting" else start)
        if event.key == "page_lost":
            control = PageControl(loop.post, loop.beat, loop.silent)
            control.leave(control.join().name)
            run(loop, 2.0)
        else:
            answer = ask(loop, COMMANDS[event.key])
            assert answer.ok == (to != REFUSED), answer.why
            if to == REFUSED:
                assert event.why in answer.why
        run(loop, 0.2)
        after = loop.state_dict()["mode"]
        assert after == (before["mode"] if to in (STAYS, REFUSED) else to)
    finally:
        loop.runtime.close()


def test_the_page_is_the_table():
    assert DOCS.read_text("utf-8") == page()
