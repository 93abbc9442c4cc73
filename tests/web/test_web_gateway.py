"""Commands, sockets, files and takes over the real gateway and the real loop."""

import asyncio
import json
import re
import socket
import time
from dataclasses import replace

import numpy as np
import pytest
from browsing import PATIENCE
from bvh_writer import Layout, Names, write

from studio.errors import StudioError
from studio.human.skeleton import NUM_JOINTS
from studio.options import ServeConfig
from studio.robot.pose import RobotState
from studio.synthetic.operator import OperatorSource
from studio.takes.tick import Tick
from studio.web.http_server import bind
from studio.web.serve import serve
from studio.web.tokens import checked_token

TOKEN = "test-token-0123456789"
STATE_KEYS = {
    "mode", "state", "state_lock", "expert", "votes", "stopped", "armed", "why", "source", "scene",
    "latency_ms", "counters", "robot", "needs_reset", "stale_s", "reason", "source_report",
    "arrivals",
}  # fmt: skip


@pytest.fixture(scope="module")
def poses():
    """A second and a half of a quiet person."""
    source = OperatorSource("quiet", seed=3)
    return [source.read(k / 30.0) for k in range(45)]


def frame(pose, t):
    """A frame of docs/contract.md."""
    positions = np.round(pose.joint_pos_w, 4).tolist()
    return {"t": t, "skeleton": "studio", "positions": positions}


def test_the_state_has_the_keys_of_the_contract(studio_live):
    state = studio_live.state()
    assert state.keys() >= STATE_KEYS
    assert state["counters"].keys() >= {"frames", "rejected", "stale", "clipped", "late"}
    assert state["robot"].keys() >= {"base_pos", "base_quat", "joint_pos", "foot_contact"}
    # Whether a period was late at this very moment is the machine's business.
    assert studio_live.client.get("/api/health").json()["status"] in ("ok", "degraded")


def test_modes_and_locks_are_applied_before_they_are_answered(studio_live):
    post = studio_live.client.post
    assert post("/api/mode", json={"mode": "idle"}).json()["mode"] == "idle"
    assert studio_live.state()["why"].startswith("idle")
    assert post("/api/mode", json={"mode": "live"}).json()["mode"] == "live"
    assert post("/api/state", json={"state": "sit"}).json()["state_lock"] == "sit"
    studio_live.wait(lambda s: s["state"] == "sit")
    assert post("/api/state", json={"state": "auto"}).json()["state_lock"] == "auto"


@pytest.mark.parametrize(
    ("path", "body", "says"),
    [
        ("/api/mode", {"mode": "fly"}, "live"),
        ("/api/state", {"state": "run"}, "walk"),
        ("/api/source", {"source": "telepathy"}, "operator"),
        ("/api/source", {"source": "bvh:/nowhere/x.bvh"}, "x.bvh"),
        ("/api/source", {"source": "operator:fly"}, "walk"),
        ("/api/scene", {"scene": "moon"}, "empty"),
        ("/api/gain", {"name": "tilt_gain", "value": 99}, "between"),
        ("/api/gain", {"name": "charm", "value": 1}, "tilt_gain"),
        ("/api/controller", {"controller": "magic"}, "pd_playback"),
        ("/api/seek", {"t": 1.0}, "replay"),
        ("/api/takes/stop", None, "take"),
    ],
)
def test_what_cannot_be_done_gets_409_and_says_what_can(studio_live, path, body, says):
    studio_live.client.post("/api/mode", json={"mode": "live"})  # another test may have replayed
    answer = studio_live.client.post(path, json=body)
    assert answer.status_code == 409
    assert says in answer.json()["why"]


@pytest.mark.parametrize(
    ("path", "body", "key", "value"),
    [
        ("/api/gain", {"name": "tilt_gain", "value": 1.5}, ("gains", "tilt_gain"), 1.5),
        ("/api/mirror", {"mirror": True}, ("mirror",), True),
        ("/api/mirror", {"mirror": False}, ("mirror",), False),
        ("/api/steps", {"steps": "generated"}, ("steps",), "generated"),
        ("/api/steps", {"steps": "mapped"}, ("steps",), "mapped"),
        ("/api/travel", {"travel": "off"}, ("travel", "mode"), "off"),
        ("/api/travel", {"travel": "auto"}, ("travel", "mode"), "auto"),
        ("/api/controller", {"controller": "pd_playback"}, ("controller",), "pd_playback"),
        ("/api/controller", {"controller": "policy"}, ("controller",), "policy"),
        ("/api/disarm", None, ("armed",), False),
        ("/api/arm", None, ("armed",), True),
        ("/api/calibrate", None, ("stopped",), False),
    ],
)
def test_what_a_panel_sets_is_in_the_state_that_answers(studio_live, path, body, key, value):
    answer = studio_live.client.post(path, json=body)
    assert answer.status_code == 200, answer.text
    found = answer.json()
    for name in key:
        found = found[name]
    assert found == value


@pytest.mark.parametrize("path", ["/api/mode", "/api/state"])
@pytest.mark.parametrize(
    "body", [b"", b"{", b"[]", b'{"%s": 3}', b'{"mood": "live"}', b"\xff\xfe", b'{"%s": null}']
)
def test_a_malformed_body_gets_409_says_why_and_changes_nothing(studio_live, path, body):
    key = path.rpartition("/")[2]
    before = studio_live.state()
    headers = {"Content-Type": "application/json"}
    content = body.replace(b"%s", key.encode())
    answer = studio_live.client.post(path, content=content, headers=headers)
    assert answer.status_code == 409
    assert answer.json()["why"]
    after = studio_live.state()
    assert (after["mode"], after["state_lock"]) == (before["mode"], before["state_lock"])


def test_an_answer_does_not_wait_for_the_clients_acknowledgement():
    """What is accepted sends at once (TCP_NODELAY): asyncio sees to it for TCP by name only."""

    async def accepted():
        found = asyncio.get_running_loop().create_future()

        async def answer(_, writer):
            accepted = writer.get_extra_info("socket")
            found.set_result(accepted.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))
            writer.close()

        listener = bind("127.0.0.1", 0)
        async with await asyncio.start_server(answer, sock=listener):
            _, writer = await asyncio.open_connection(*listener.getsockname())
            writer.close()
            return await found

    assert asyncio.run(accepted())


def test_a_stop_latches_through_reset_until_armed(studio_live):
    post = studio_live.client.post
    stopped = post("/api/stop").json()
    assert stopped["stopped"] is True
    assert stopped["mode"] == "live"
    assert "stopped" in stopped["why"]
    refused = post("/api/arm")
    assert refused.status_code == 409
    assert "reset" in refused.json()["why"]
    reset = post("/api/reset")
    assert reset.status_code == 200
    assert reset.json()["stopped"] is True
    assert reset.json()["needs_reset"] is False
    armed = post("/api/arm").json()
    assert armed["stopped"] is False
    assert armed["armed"] is True


def test_ticks_come_in_order_with_all_three_figures(studio_live):
    with studio_live.ws("/api/ticks") as ws:
        ticks = [json.loads(ws.recv(timeout=PATIENCE)) for _ in range(31)]
    indices = [tick["index"] for tick in ticks]
    assert indices == sorted(set(indices))
    tick = ticks[-1]
    assert np.shape(tick["human"]["positions"]) == (NUM_JOINTS, 3)
    for figure in ("reference", "robot"):
        assert np.shape(tick[figure]["base_pos"]) == (3,)
        assert np.linalg.norm(tick[figure]["base_quat"]) == pytest.approx(1.0, abs=1e-4)
        assert np.shape(tick[figure]["joint_pos"]) == (12,)
    times = [tick["t"] for tick in ticks]
    assert times == sorted(times)
    assert times[0] < times[-1]


# Human frames -----------------------------------------------------------------------------------


def hostile(pose):
    """Frames no robot should see, by name."""
    good = frame(pose, 1.0)
    nan = [[float("nan")] * 3] * NUM_JOINTS
    return {
        "not JSON": "{",
        "not an object": "[1, 2, 3]",
        "empty": "",
        "no positions": json.dumps({"t": 1.0, "skeleton": "studio"}),
        "an unknown skeleton": json.dumps({**good, "skeleton": "octopus"}),
        "too few joints": json.dumps({**good, "positions": good["positions"][:5]}),
        "two coordinates": json.dumps({**good, "positions": [[0.0, 1.0]] * NUM_JOINTS}),
        "NaN": json.dumps({**good, "positions": nan}),
        "infinite": json.dumps({**good, "positions": [[1e999, 0.0, 0.0]] * NUM_JOINTS}),
        "text for numbers": json.dumps({**good, "positions": [["a", "b", "c"]] * NUM_JOINTS}),
        "far away": json.dumps({**good, "positions": [[1e6, 0.0, 0.0]] * NUM_JOINTS}),
        "no time": json.dumps({**good, "t": "now"}),
        "deep nesting": "[" * 5000 + "]" * 5000,
        "900 kB": json.dumps({**good, "note": "x" * 900_000}).replace('"t": 1.0', '"t": "x"'),
        "900 kB of joints": json.dumps({**good, "positions": [[0.0, 0.0, 1.0]] * 60_000}),
        "not UTF-8": b"\xff\xfe\x00",
    }


def test_hostile_frames_are_answered_and_counted_and_close_nothing(studio_live, poses):
    studio_live.client.post("/api/source", json={"source": "stream"})
    bad = hostile(poses[0])
    before = studio_live.state()["counters"]
    with studio_live.ws("/api/human") as socket:
        for name, raw in bad.items():
            socket.send(raw)
            answer = json.loads(socket.recv(timeout=PATIENCE))
            assert set(answer) == {"error"}, name
            assert len(answer["error"]) > 10, name
        now = studio_live.wait(
            lambda s: s["counters"]["rejected"] >= before["rejected"] + len(bad)
        )["counters"]
        assert now["rejected"] == before["rejected"] + len(bad)
        assert now["frames"] == before["frames"]
        for k, pose in enumerate(poses):  # the same socket still carries good frames
            socket.send(json.dumps(frame(pose, 10.0 + k / 30.0)))
            time.sleep(1 / 60)
        studio_live.wait(lambda s: s["counters"]["frames"] > before["frames"] + 10)


def test_a_flood_of_frames_neither_stalls_the_loop_nor_kills_it(studio_live, poses):
    studio_live.client.post("/api/source", json={"source": "stream"})
    with studio_live.ws("/api/human") as socket:
        for k in range(400):
            socket.send(json.dumps(frame(poses[k % len(poses)], 20.0 + 0.001 * k)))
        first = studio_live.state()["t"]
    state = studio_live.wait(lambda s: s["t"] != first)
    assert state["stopped"] is False


def test_frames_for_another_source_are_refused_with_what_to_do(studio_live, poses):
    with studio_live.ws("/api/human") as socket:
        socket.send(json.dumps(frame(poses[0], 1.0)))
        assert "stream" in json.loads(socket.recv(timeout=PATIENCE))["error"]


# Pages: control and the emergency stop ------------------------------------------------------------


def join(studio_live, sockets):
    """Open a page's socket; (socket, its name)."""
    socket = studio_live.ws("/api/control")
    sockets.append(socket)
    while True:
        message = json.loads(socket.recv(timeout=PATIENCE))
        if message["type"] == "state":
            return socket, message["page"]


@pytest.fixture
def pages(studio_live):
    """Two pages; both leave in good order."""
    sockets = []
    first, second = join(studio_live, sockets), join(studio_live, sockets)
    yield first, second
    holder = studio_live.state()["control"]["holder"]
    if holder in (first[1], second[1]):
        studio_live.client.post("/api/control", json={"page": holder, "action": "release"})
    for ws in sockets:
        ws.close()


def beat(socket, keys=()):
    socket.send(json.dumps({"type": "beat", "sent": 1.0, "keys": list(keys), "visible": True}))


def test_the_first_page_drives_and_hands_over(studio_live, pages):
    (a, first), (b, second) = pages
    post = studio_live.client.post
    beat(a)
    beat(b)
    assert studio_live.state()["control"]["holder"] == first
    watching = post("/api/mode", json={"mode": "idle"}, headers={"X-Studio-Page": second})
    assert watching.status_code == 409
    assert "control" in watching.json()["why"]
    driving = post("/api/mode", json={"mode": "live"}, headers={"X-Studio-Page": first})
    assert driving.status_code == 200
    handed = post("/api/control", json={"page": first, "action": "hand_over", "to": second})
    assert handed.json()["control"]["holder"] == second
    lost = post("/api/control", json={"page": first, "action": "release"})
    assert lost.status_code == 409
    assert post("/api/control", json={"page": "page-zz"}).status_code == 409
    taken = post("/api/control", json={"page": first, "action": "take"})
    assert taken.json()["control"]["holder"] == first


def test_a_page_that_asks_is_handed_control_or_it_is_kept(studio_live, pages):
    (a, first), (b, second) = pages
    beat(a)
    beat(b)

    def control(page, action, to=None):
        body = {"page": page, "action": action, "to": to}
        answer = studio_live.client.post("/api/control", json=body)
        assert answer.status_code == 200, answer.text
        return answer.json()["control"]

    asked = control(second, "ask")
    assert (asked["holder"], asked["asking"]) == (first, [second])
    assert control(second, "ask")["asking"] == [second]  # once is enough
    assert control(first, "ask")["asking"] == [second]  # who has it asks nobody
    kept = studio_live.client.post("/api/control", json={"page": second, "action": "keep"})
    assert kept.status_code == 409  # not theirs to refuse
    assert control(first, "keep")["asking"] == []
    control(second, "ask")
    handed = control(first, "hand_over", second)
    assert (handed["holder"], handed["asking"]) == (second, [])
    control(first, "ask")
    assert control(first, "take")["asking"] == []
    assert control(second, "ask")["asking"] == [second]
    b.close()
    assert wait_until(lambda: studio_live.state()["control"]["asking"] == [])


def test_where_nobody_drives_who_asks_drives(studio_live, pages):
    (a, first), (b, second) = pages
    beat(a)
    beat(b)
    post = studio_live.client.post
    assert post("/api/control", json={"page": first, "action": "release"}).status_code == 200
    given = post("/api/control", json={"page": second, "action": "ask"}).json()["control"]
    assert (given["holder"], given["asking"]) == (second, [])


def wait_until(true) -> bool:
    deadline = time.monotonic() + PATIENCE
    while not true():
        assert time.monotonic() < deadline
        time.sleep(0.05)
    return True


def test_any_page_may_stop_and_once_that_is_answered_the_robot_is_stopped(studio_live, pages):
    (a, _), (b, second) = pages
    beat(a)
    b.send(json.dumps({"type": "stop"}))
    while json.loads(b.recv(timeout=PATIENCE)).get("type") != "stopped":
        pass
    state = studio_live.state()
    assert state["stopped"] is True
    assert second in state["why"]


def test_when_the_page_in_control_goes_silent_the_robot_stands(studio_live, pages):
    (a, first), _ = pages
    for _ in range(5):
        beat(a)
        time.sleep(0.05)
    assert studio_live.state()["control"]["holder"] == first
    state = studio_live.wait(lambda s: "page" in s["why"])
    assert "page lost" in state["why"]
    studio_live.wait(lambda s: beat(a) or "page" not in s["why"])


@pytest.mark.parametrize(
    "raw", ["", "{", "[]", "null", '{"type": 7}', '{"type": "beat", "keys": 3}']
)
def test_nonsense_on_a_pages_socket_is_answered(studio_live, pages, raw):
    socket, _ = pages[0]
    socket.send(raw)
    for _ in range(50):
        message = json.loads(socket.recv(timeout=PATIENCE))
        if message["type"] == "error":
            return
    pytest.fail("no answer")


@pytest.mark.slow
def test_held_keys_drive_the_operator_and_the_robot_walks(studio_live, pages):
    (a, first), _ = pages
    post = studio_live.client.post
    headers = {"X-Studio-Page": first}
    answer = post("/api/source", json={"source": "operator:interactive"}, headers=headers)
    assert answer.status_code == 200, answer.text
    deadline = time.monotonic() + PATIENCE
    while studio_live.state()["expert"] != "walk":
        beat(a, ["W"])
        time.sleep(0.05)
        assert time.monotonic() < deadline, studio_live.state()


# Files and takes ----------------------------------------------------------------------------------


ITALIAN = Layout(names=Names(leg=("{}Gamba", "{}Polpaccio", "{}Foot", "{}Toe")), seconds=1.0)
ITALIAN_MAP = {"l_hip": "LeftGamba", "r_hip": "RightGamba",
               "l_knee": "LeftPolpaccio", "r_knee": ["RightPolpaccio"]}  # fmt: skip


def drop(studio_live, name, content):
    return studio_live.client.post("/api/files", params={"name": name}, content=content)


@pytest.mark.slow
def test_a_dropped_recording_becomes_the_source(studio_live, poses):
    lines = "\n".join(json.dumps(frame(pose, k / 30.0)) for k, pose in enumerate(poses))
    answer = drop(studio_live, "../../quiet person.jsonl", lines.encode())
    assert answer.status_code == 200, answer.text
    assert answer.json()["source"].startswith("frames:")
    assert answer.json()["source"].endswith("/quiet person.jsonl")
    studio_live.wait(lambda s: s["why"].startswith("ended"))


@pytest.mark.parametrize(
    ("name", "content", "status", "says"),
    [
        ("march.fbx", b"x", 415, ".bvh"),
        ("broken.bvh", b"HIERARCHY\nROOT Hips\n{\n  OFFSET a b c\n", 422, "line 4"),
        ("empty.bvh", b"", 422, "empty.bvh"),
        ("noise.bvh", bytes(range(256)) * 40, 422, "noise.bvh"),
        ("bad.jsonl", b'{"t": 0}\n', 422, "bad.jsonl"),
        ("empty.jsonl", b"", 422, "empty.jsonl"),
        ("italian.bvh", write(ITALIAN).encode(), 422, "LeftGamba"),
        ("a march (2).bvh", b"HIERARCHY\n", 422, "a march (2).bvh"),
        ("C:\\clips\\ümlaut.jsonl", b"[]\n", 422, "ümlaut.jsonl"),
    ],
)
def test_a_file_that_cannot_be_read_is_refused_in_words(studio_live, name, content, status, says):
    answer = drop(studio_live, name, content)
    assert answer.status_code == status
    assert says in answer.json()["why"]
    assert "/tmp" not in answer.json()["why"]
    assert not re.search(r"[0-9a-f]{8}_", answer.json()["why"])  # as it is called here
    assert studio_live.state()["source"] == "operator:quiet"


def test_a_joint_map_is_asked_for_said_and_used_again(studio_live):
    client = studio_live.client
    refused = drop(studio_live, "uno.bvh", write(ITALIAN).encode())
    assert refused.status_code == 422
    source = refused.json()["source"]  # it is kept, for the map that it needs
    asked = client.get("/api/joint-map", params={"source": source}).json()
    assert "LeftGamba" in asked["joints"]
    assert asked["found"]["l_ankle"] == ["LeftFoot"]
    assert set(asked["missing"]) == set(ITALIAN_MAP)
    assert set(asked["missing"]) <= set(asked["needed"])
    assert asked["map"] == {}
    for said, why in (
        ({}, "no joint for"),
        ({"l_hip": "LeftGamba"}, "no joint for r_hip"),
        ({"l_hip": "Nobody"}, "there is Hips"),
        ({"tail": "LeftGamba"}, "no joint 'tail'"),
        ({"l_hip": 7}, "a joint map is"),
    ):
        answer = client.post("/api/joint-map", json={"source": source, "map": said})
        assert answer.status_code == 422, said
        assert why in answer.json()["why"]
    assert studio_live.state()["source"] == "operator:quiet"
    answer = client.post("/api/joint-map", json={"source": source, "map": ITALIAN_MAP})
    assert answer.status_code == 200, answer.text
    report = answer.json()["source_report"]
    assert answer.json()["source"] == source
    assert report["joints_missing"] == []
    assert report["joints_found"]["r_knee"] == ["RightPolpaccio"]
    # another file of the same joints needs nothing said
    again = drop(studio_live, "due.bvh", write(replace(ITALIAN, seconds=2.0)).encode())
    assert again.status_code == 200, again.text
    asked = client.get("/api/joint-map").json()  # of the source in use
    assert asked["source"] == again.json()["source"]
    assert asked["map"]["l_hip"] == ["LeftGamba"]
    # forgotten
    client.post("/api/joint-map", json={"map": {}})
    assert drop(studio_live, "tre.bvh", write(ITALIAN).encode()).status_code == 422


@pytest.mark.parametrize("source", ["operator", "bvh:", "bvh:/dev/zero", "nonsense"])
def test_a_source_without_joints_of_its_own_has_no_map(studio_live, source):
    answer = studio_live.client.get("/api/joint-map", params={"source": source})
    assert answer.status_code == 422
    assert answer.json()["why"]
    answer = studio_live.client.post("/api/joint-map", json={"source": source, "map": {}})
    assert answer.status_code == 422


def test_the_state_says_what_was_found_in_the_source(studio_live):
    report = studio_live.state()["source_report"]
    assert len(report["joints_found"]) == 19
    assert report["joints_missing"] == []
    assert report["refused"] == {"frames": 0, "why": []}


def test_a_file_that_is_too_large_is_refused_before_it_is_read(studio_live):
    with socket.create_connection(("127.0.0.1", studio_live.port), timeout=PATIENCE) as raw:
        raw.sendall(
            f"POST /api/files?name=a.bvh HTTP/1.1\r\nHost: localhost:{studio_live.port}\r\n"
            f"Authorization: Bearer {TOKEN}\r\nContent-Length: 1000000000\r\n\r\n".encode()
        )
        assert raw.recv(4096).startswith(b"HTTP/1.1 413")


def test_a_take_is_recorded_edited_exported_and_thrown_away(studio_live):
    client = studio_live.client
    name = client.post("/api/takes/start", json={"label": "hello"}).json()["name"]
    again = client.post("/api/takes/start", json={})
    assert again.status_code == 409
    studio_live.wait(lambda s: s["recording"] and s["recording"]["ticks"] >= 10)
    stopped = client.post("/api/takes/stop").json()
    assert stopped["name"] == name
    assert stopped["ticks"] >= 10
    listed = {take["name"]: take for take in client.get("/api/takes").json()}
    assert listed[name].keys() >= {"name", "label", "seconds", "ticks", "score", "kept"}
    assert listed[name]["label"] == "hello"
    edited = client.patch(f"/api/takes/{name}", json={"label": "bye", "keep": True})
    assert edited.json()["label"] == "bye"
    assert edited.json()["kept"] is True
    assert client.post(f"/api/takes/{name}/undo").json()["label"] == "hello"
    assert client.patch(f"/api/takes/{name}", json={"trim": [0.0, 1e6]}).status_code == 422
    assert client.patch(f"/api/takes/{name}", json={"colour": 1}).status_code == 422
    exported = client.get(f"/api/takes/{name}/export", params={"format": "csv"})
    assert exported.status_code == 200
    assert len(exported.text.splitlines()) == stopped["ticks"] + 1
    assert client.get(f"/api/takes/{name}/export", params={"format": "pdf"}).status_code == 422
    assert client.delete(f"/api/takes/{name}").json()["deleted"] is True
    assert client.get(f"/api/takes/{name}").status_code == 404


@pytest.mark.parametrize("name", ["..", "%2e%2e", "..%2f..%2fetc", "a b", ".bin", "x" * 200])
def test_no_name_of_a_take_leads_out_of_the_folder(studio_live, name):
    for method in ("GET", "PATCH", "DELETE"):
        answer = studio_live.client.request(method, f"/api/takes/{name}", json={"label": "x"})
        assert answer.status_code in (404, 405, 422), (method, answer.text)


# The rest -----------------------------------------------------------------------------------------


def test_the_schema_is_served_without_any_other_host(studio_live):
    schema = studio_live.client.get("/api/docs").json()
    assert "/api/takes/{name}/export" in schema["paths"]
    page = studio_live.client.get("/api/docs", headers={"Accept": "text/html"})
    assert page.headers["content-type"].startswith("text/html")
    assert "://" not in page.text


def test_a_taken_port_is_an_error_that_says_what_to_do(studio_live):
    with pytest.raises(StudioError, match="--port"):
        bind("127.0.0.1", studio_live.port)
    with pytest.raises(StudioError, match="--host"):
        bind("203.0.113.7", 0)


@pytest.mark.parametrize(
    "token", ["", "has space in it", "x" * 300, "semi;colon;;", "ümlaut-token"]
)
def test_a_token_unfit_for_a_url_is_refused(token):
    with pytest.raises(StudioError, match="token"):
        checked_token(token)


def test_a_short_token_is_the_users_choice_and_is_warned_of(caplog):
    assert checked_token("secret") == "secret"
    assert "guessed" in caplog.text
    assert len(checked_token(None)) >= 32


def test_an_unknown_source_is_an_error_before_anything_is_served(tmp_path):
    with pytest.raises(StudioError, match="operator"):
        serve(ServeConfig(source="telepathy", port=0, sessions=tmp_path))


def test_a_tick_is_json_even_when_the_robot_is_not_finite(studio_live):
    from dataclasses import fields, replace

    from studio.robot.pose import ReferencePose
    from studio.takes.as_json import tick_json

    zero = np.zeros(12)
    pose = {"base_pos": np.zeros(3), "base_quat": np.array([1.0, 0, 0, 0]), "joint_pos": zero}
    pose["foot_contact"] = np.ones(4)
    robot = RobotState(
        **pose, t=0.0, base_lin_vel_w=np.zeros(3), base_ang_vel_b=np.zeros(3), joint_vel=zero,
        foot_pos_w=np.zeros((4, 3)), torque=zero,
    )  # fmt: skip
    tick = Tick(
        index=0, t=0.0, human=None, human_fresh=False, expert="stand", votes={"stand": 1.0},
        state="stand", transition_to=None, mode="live", controller="x", action=zero, target=zero,
        reference=ReferencePose(**pose), robot=replace(robot, joint_pos=np.full(12, np.nan)),
        clipped=False, fallen=False,
    )  # fmt: skip
    data = json.loads(tick_json(tick))
    assert data["robot"]["joint_pos"] == [None] * 12
    assert set(data) >= {f.name for f in fields(Tick)} - {"action"}
