"""The schema's types against real answers: each key that is sent is declared, and the other way."""

import json
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from acted_takes import acted_take, record
from pydantic import TypeAdapter

from studio.cli import main
from studio.live import tick_message
from studio.takes.edit.review import Review
from studio.takes.export.adding import add_take
from studio.takes.listing import TakeInfo
from studio.web import answers, answers_takes


def check(kind: Any, text: str | bytes) -> None:
    """Whether an answer holds what its type says, and nothing besides."""
    adapter = TypeAdapter(kind)
    assert adapter.dump_python(adapter.validate_json(text), mode="json") == json.loads(text)


@pytest.fixture(scope="module")
def take(studio_at, tmp_path_factory):
    """The name of a take of both sides."""
    acted = acted_take("tilt", np.random.default_rng(0), lag=0.3, seconds=3.0)
    elsewhere = tmp_path_factory.mktemp("elsewhere")  # the studio may hold its own folder's lock
    record(acted, elsewhere, "declared", keep=True)
    add_take(studio_at.sessions, elsewhere / "declared")
    yield "declared"
    studio_at.client.delete("/api/takes/declared")


def test_the_state_and_both_sockets_send_what_is_declared(studio_live):
    check(answers.State, studio_live.client.get("/api/state").content)
    with studio_live.ws("/api/ticks") as ws:
        check(tick_message.TickMessage, ws.recv(timeout=10))
    with studio_live.ws("/api/control") as ws:
        check(answers.StateMessage, ws.recv(timeout=10))


def test_collecting_reviewing_and_recording_answer_what_is_declared(studio_live, take):
    client = studio_live.client

    def post(path: str, body: dict | None = None) -> bytes:
        answer = client.post(f"/api/{path}", json=body or {})
        assert answer.status_code == 200, answer.text
        return answer.content

    check(list[answers_takes.Task], client.get("/api/collect/tasks").content)
    check(answers.State, post("collect/plan", {"items": [{"task": "tilt"}]}))
    post("mode", {"mode": "collect"})
    studio_live.wait(lambda state: state["collect"]["phase"] == "ready")
    check(answers.State, client.get("/api/state").content)
    check(answers.Judged, post("collect/action", {"action": "next"}))
    check(list[answers_takes.CollectSession], client.get("/api/collect/sessions").content)
    check(answers_takes.CoverageMap, client.get("/api/collect/map").content)

    check(answers.State, post(f"takes/{take}/show"))
    check(answers_takes.Timeline, client.get(f"/api/takes/{take}/timeline?points=9").content)
    check(answers_takes.Series, client.get(f"/api/takes/{take}/series?points=9").content)
    assert client.get(f"/api/takes/{take}/series?points=9999").status_code == 422
    check(Review, client.get(f"/api/takes/{take}/review").content)
    check(answers_takes.Aligned, post(f"takes/{take}/align"))
    check(answers_takes.Split, post(f"takes/{take}/split", {"at": 1.5}))
    check(list[TakeInfo], client.get("/api/takes").content)
    check(TakeInfo, client.patch(f"/api/takes/{take}", json={"label": "seen"}).content)

    post("mode", {"mode": "live"})
    check(answers_takes.Started, post("takes/start"))
    check(answers.State, client.get("/api/state").content)
    check(answers_takes.Stopped, post("takes/stop"))
    check(answers_takes.Deleted, client.delete(f"/api/takes/{take}").content)
    check(TakeInfo, post(f"takes/{take}/restore"))


def test_the_schema_made_without_a_server_is_the_one_that_is_served(studio_live, tmp_path):
    with pytest.raises(SystemExit) as ended:
        main(["openapi", "--json", str(tmp_path / "openapi.json")])
    assert ended.value.code == 0
    made = json.loads((tmp_path / "openapi.json").read_text())
    assert made == studio_live.client.get("/api/openapi.json").json()


WITH_MORE = '''
"""A studio whose state has a key more, in a process of its own."""
import json, sys

from studio.live import state

state.KEYS["mood"] = state.Key(dict[str, float], lambda seen: {"calm": 1.0})

from pathlib import Path
from pydantic import TypeAdapter
from studio.live.loop import LiveLoop, RuntimeConfig
from studio.web import answers
from studio.web.gateway import openapi

loop = LiveLoop(RuntimeConfig(source="operator:quiet", sessions=Path(sys.argv[1])))
loop.tick()
parts = openapi()["components"]["schemas"]
print(json.dumps({
    "said": loop.state_dict()["mood"],
    **{name: parts[name]["properties"]["mood"] for name in ("State", "StateMessage", "Judged")},
}))
'''


def test_a_key_added_to_the_state_is_said_and_in_all_of_the_schema(tmp_path):
    told = [sys.executable, "-c", WITH_MORE, str(tmp_path)]
    done = subprocess.run(told, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found.pop("said") == {"calm": 1.0}
    assert len(found) == 3
    for kind in found.values():
        assert kind["additionalProperties"] == {"type": "number"}
