"""Best runs: each person's best, in a file that survives whatever is in it."""

import json

import pytest
from fake_clock import FakeClock
from turning import ask, run

from studio.control.drive_command import PuppeteerConfig
from studio.errors import StudioError
from studio.live import commands as c
from studio.live.best_runs import FILE, MAX_PEOPLE, BestRuns, checked_name
from studio.live.loop import LiveLoop
from studio.live.runtime import RuntimeConfig
from studio.scenes.stage import Done


def test_a_person_keeps_their_best_run_and_the_best_come_first(tmp_path):
    best = BestRuns(tmp_path)
    best.add("push", "Ann", 150, 20.0, "webcam")
    best.add("push", "Bo", 170, 30.0, "operator")
    best.add("push", "Ann", 120, 10.0, "webcam")  # worse
    best.add("push", "Bo", 170, 25.0, "stream")  # as good, and sooner
    runs = BestRuns(tmp_path).of("push")
    assert [(run["person"], run["score"], run["time_s"]) for run in runs] == [
        ("Bo", 170, 25.0),
        ("Ann", 150, 20.0),
    ]
    assert runs[0]["source"] == "stream"
    assert BestRuns(tmp_path).of("slalom") == []


@pytest.mark.parametrize(
    "held",
    [
        b"", b"[]", b"{", b"\xff\xfe", b'{"push": {"Ann": {"score": 1e999}}}',
        b'{"push": {"Ann": {"score": -5, "time_s": 1, "source": "", "when": ""}}}',
        b'{"push": ' * 5000, b"0" * 2_000_000,
    ],
)  # fmt: skip
def test_a_file_that_is_none_counts_as_empty_and_is_replaced(tmp_path, held):
    (tmp_path / FILE).write_bytes(held)
    best = BestRuns(tmp_path)
    assert best.of("push") == []
    best.add("push", "Ann", 150, 20.0, "webcam")
    assert [run["person"] for run in best.of("push")] == ["Ann"]


def test_a_pipe_in_its_place_holds_nobody_up(tmp_path):
    import os

    os.mkfifo(tmp_path / FILE)
    assert BestRuns(tmp_path).of("push") == []


def test_only_so_many_people_are_kept(tmp_path):
    best = BestRuns(tmp_path)
    for k in range(MAX_PEOPLE + 3):
        best.add("push", f"P{k}", k, 1.0, "webcam")
    runs = best.of("push")
    assert len(runs) == MAX_PEOPLE
    assert runs[-1]["score"] == 3
    assert [path.name for path in tmp_path.iterdir()] == [FILE]


def test_names_are_what_can_be_shown():
    assert checked_name("  Ann   Lee ") == "Ann Lee"
    assert checked_name("") == ""
    for name in ("x" * 41, "a\x00b", "‮evil"):
        with pytest.raises(StudioError, match="letters"):
            checked_name(name)


def test_whoever_finishes_a_scene_is_kept_once_and_nobody_without_a_name(tmp_path):
    config = RuntimeConfig(
        source="operator:quiet", sessions=tmp_path, puppeteer=PuppeteerConfig(scene="push")
    )
    loop = LiveLoop(config, clock=FakeClock())
    runs = loop.runtime.runs

    def finish() -> None:
        stage = loop.runtime.puppeteer.stage
        stage.done = [Done(t=3.0, points=90.0), Done(t=9.0, points=80.0)]
        stage.time = 9.0
        run(loop, 0.2)

    run(loop, 0.2)
    finish()
    assert ask(loop, c.SetPerson(name="Ann")).state["person"] == "Ann"
    run(loop, 0.2)
    assert ask(loop, c.SetScene(scene="push")).ok
    run(loop, 0.2)
    finish()
    runs.close()
    kept = json.loads((tmp_path / FILE).read_text())
    assert kept["push"]["Ann"]["score"] == 170
    assert kept["push"]["Ann"]["source"] == "operator"
    with pytest.raises(ValueError, match="letters"):
        c.SetPerson(name="a\nb\x07")
