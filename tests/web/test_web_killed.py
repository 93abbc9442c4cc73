"""The whole server killed (SIGKILL): no tick anybody saw is lost, nothing goes on or is left."""

import contextlib
import os
import signal
import threading
import time
from pathlib import Path

import httpx
import numpy as np
import pytest
from acted_takes import acted_take, record
from served import Served

from studio.synthetic.operator import OperatorSource
from studio.takes.export.bvh import write_bvh
from studio.takes.session_library import SessionLibrary

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]

KILLS = 6
TOKEN = "a-token-of-the-test"


def serve(sessions: Path) -> Served:
    served = Served(sessions, "--source", "operator", "--token", TOKEN)
    served.wait(lambda s: s["counters"]["frames"] > 5)
    return served


def kill(served: Served) -> dict[int, dict]:
    """SIGKILL, no word of warning; every tick that had reached the other side by then."""
    served.process.send_signal(signal.SIGKILL)
    served.process.wait(timeout=20.0)
    served._thread.join(timeout=20.0)  # reads what was still on its way
    served.client.close()
    for pipe in (served.process.stdout, served.process.stderr):
        if pipe is not None:
            pipe.close()
    return dict(served.ticks)


def assert_on_tape(sessions: Path, name: str, seen: dict[int, dict]) -> int:
    """Every tick seen since the take began is on its tape as it was seen; how many."""
    take = SessionLibrary(sessions).read(name)
    tape = {tick.index: tick for tick in take.ticks}
    first = take.ticks[0].index
    assert sorted(tape) == list(range(first, first + len(tape)))
    since = [i for i in seen if i >= first]
    assert set(since) <= set(tape)
    for i in since:
        for part in ("reference", "robot"):
            for key in ("base_pos", "base_quat", "joint_pos"):
                ours = getattr(getattr(tape[i], part), key)
                np.testing.assert_allclose(ours, seen[i][part][key], atol=1.1e-5)
        if seen[i]["human"] is not None:
            human = tape[i].human
            assert human is not None
            np.testing.assert_allclose(
                human.joint_pos_w, seen[i]["human"]["positions"], atol=1.1e-5
            )
    return len(since)


def test_a_server_killed_at_random_instants_loses_no_tick_and_the_next_lists_what_it_left(tmp_path):
    sessions, rng = tmp_path / "sessions", np.random.default_rng(0)
    found: dict[str, int] = {}
    for _ in range(KILLS):
        served = serve(sessions)
        listed = {take["name"]: take for take in served.client.get("/api/takes").json()}
        assert set(listed) == set(found)
        for name, count in found.items():
            assert listed[name]["recovered"], listed[name]
            assert not listed[name]["recording"]
            assert listed[name]["ticks"] >= count
        answer = served.client.post("/api/takes/start", json={"label": "killed"})
        name = answer.json()["name"]
        time.sleep(float(rng.uniform(0.1, 1.5)))
        seen = kill(served)
        found[name] = assert_on_tape(sessions, name, seen)
    assert len(found) == KILLS
    assert min(found.values()) >= 1
    assert sum(found.values()) > 20 * KILLS

    # What was left of them is used like any other take: reviewed, shown, exported, edited.
    served = serve(sessions)
    name = max(found, key=lambda n: found[n])
    assert served.client.get(f"/api/takes/{name}/review").json()["ticks"] >= found[name]
    assert served.client.post(f"/api/takes/{name}/show", json={}).json()["mode"] == "replay"
    assert served.client.get(f"/api/takes/{name}/export?format=npz").status_code == 200
    edited = served.client.patch(f"/api/takes/{name}", json={"label": "kept", "keep": True}).json()
    assert (edited["label"], edited["kept"], edited["recovered"]) == ("kept", True, True)
    served.end_well()


@pytest.mark.parametrize("after", [0.0, 0.01, 0.05])
def test_a_server_killed_as_it_stops_a_take_loses_no_tick(tmp_path, after):
    sessions = tmp_path / "sessions"
    served = serve(sessions)
    name = served.client.post("/api/takes/start", json={}).json()["name"]
    time.sleep(1.0)
    stopped = served.client.post("/api/takes/stop").json()
    time.sleep(after)  # the tape is being rewritten, compressed and indexed
    kill(served)
    (info,) = SessionLibrary(sessions).list()
    assert (info.name, info.ticks) == (name, stopped["ticks"])
    take = SessionLibrary(sessions).read(name)
    assert len(take) == stopped["ticks"]
    assert take.problems == ()


def nice(number: int) -> int:
    """How much a process leaves to others."""
    return os.getpriority(os.PRIO_PROCESS, number)


def children(parent: int) -> dict[int, str]:
    """Processes begun by `parent` that run: number and command line (Linux)."""
    found = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            state, above = (folder / "stat").read_text().rpartition(")")[2].split()[:2]
            if int(above) == parent and state != "Z":
                found[int(folder.name)] = (folder / "cmdline").read_text().replace("\0", " ")
        except OSError:
            continue  # it has ended
    return found


def until(true, seconds=120.0):
    """Wait for it."""
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline
        time.sleep(0.05)


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="processes are looked up in /proc")
def test_a_killed_server_takes_its_training_and_its_imports_along(tmp_path, monkeypatch):
    temporary, sessions = tmp_path / "tmp", tmp_path / "sessions"
    temporary.mkdir()
    monkeypatch.setenv("TMPDIR", str(temporary))
    record(acted_take("tilt", np.random.default_rng(0)), sessions, "acted")
    person = OperatorSource("walk", seed=1)
    joints = [pose.joint_pos_w for k in range(2700) if (pose := person.read(k / 30.0))]
    write_bvh(tmp_path / "walk.bvh", np.array(joints), 1.0 / 30.0)

    served = serve(sessions)
    body = {"takes": ["acted"], "states": ["stand"], "name": "mine", "steps": 100_000}
    assert served.client.post("/api/train", json=body).status_code == 200
    files = {"files": ("walk.bvh", (tmp_path / "walk.bvh").read_bytes())}

    def send():
        with contextlib.suppress(httpx.TransportError):  # it is killed before it can answer
            served.client.post("/api/takes/import", files=files, timeout=120.0)

    sending = threading.Thread(target=send)
    sending.start()

    def at_work() -> bool:
        commands = " ".join(children(served.process.pid).values())
        return "train mapper" in commands and bool(list(sessions.glob(".import-*")))

    until(at_work)
    theirs = children(served.process.pid)
    training = next(number for number, command in theirs.items() if "train mapper" in command)
    assert nice(training) == min(nice(served.process.pid) + 10, 19)
    assert len(list(temporary.glob("a1-studio-*"))) == 1
    kill(served)
    sending.join(30.0)
    until(lambda: not any(Path(f"/proc/{number}").is_dir() for number in theirs))
    assert list(sessions.glob(".import-*"))
    assert not (sessions / "mappers" / "mine").exists()

    served = serve(sessions)
    assert len(list(temporary.glob("a1-*"))) == 1  # its own
    assert not list(sessions.glob(".import-*"))
    assert [take["name"] for take in served.client.get("/api/takes").json()] == ["acted"]
    assert served.close()[0] == 0
    assert not list(temporary.glob("a1-*"))
