"""Collecting, reviewing and training over HTTP, against a real server."""

import shutil
import time
from dataclasses import replace

import numpy as np
import pytest
from acted_takes import acted_take, record
from browsing import PATIENCE

from studio.retarget.store import style_dir
from studio.takes.edit.edits import read_edits
from studio.takes.export.adding import add_take
from studio.takes.record.recorder import Recorder

QUICK = {"task": "tilt", "takes": 1, "seconds": 2.0}


def until(studio, phase, seconds=PATIENCE):
    return studio.wait(lambda s: s["collect"]["phase"] == phase, seconds)


@pytest.fixture
def collecting(studio_live):
    yield studio_live
    studio_live.client.post("/api/collect/action", json={"action": "abort"})
    studio_live.client.post("/api/mapper", json={"name": "shipped"})
    studio_live.client.post("/api/mode", json={"mode": "live"})


def collect(studio, **plan) -> list[str]:
    """Takes collected hands free; their names."""
    body = {"items": [QUICK], "operator": "Ada", "preview": False, "hands_free": True, **plan}
    before = set(studio.state()["collect"]["kept"])
    assert studio.client.post("/api/collect/plan", json=body).status_code == 200
    assert studio.client.post("/api/mode", json={"mode": "collect"}).status_code == 200
    state = until(studio, "done", 90.0)
    return [name for name in state["collect"]["kept"] if name not in before]


@pytest.mark.slow
def test_a_take_is_collected_reviewed_trimmed_aligned_and_split(collecting):
    client = collecting.client
    # Long enough for several key poses: the lag of one short movement is anybody's guess.
    (name,) = collect(collecting, items=[{**QUICK, "seconds": 8.0}])
    sessions = client.get("/api/collect/sessions").json()
    assert any(name in s["takes"] and s["operator"] == "Ada" for s in sessions)

    found = client.get(f"/api/takes/{name}/review").json()
    assert 0.0 <= found["score"] <= 1.0
    assert found["found"]["lag"] == pytest.approx(0.033, abs=0.15)  # periods come late here
    lines = client.get(f"/api/takes/{name}/timeline", params={"points": 100}).json()
    assert len(lines["t"]) == len(lines["human"]) == len(lines["robot"]) == 100
    assert len(lines["channels"]) == len(lines["human"][0])

    shown = client.post(f"/api/takes/{name}/show", json={"t": 1.5, "loop": True}).json()
    assert shown["mode"] == "replay"
    assert shown["replay"]["name"] == name
    assert shown["replay"]["t"] == pytest.approx(1.5)
    assert shown["replay"]["loop"] is True

    aligned = client.post(f"/api/takes/{name}/align", json={"accept": True}).json()
    assert aligned["lag"] == pytest.approx(found["found"]["lag"], abs=1e-3)
    assert client.post(f"/api/takes/{name}/align", json={"accept": False}).json()["lag"] == 0.0
    assert client.post(f"/api/takes/{name}/undo").json()["lag"] == aligned["lag"]

    halves = client.post(f"/api/takes/{name}/split", json={"at": 2.5}).json()["takes"]
    assert halves[0]["trim"][1] == halves[1]["trim"][0] == 2.5
    assert client.delete(f"/api/takes/{halves[1]['name']}").status_code == 200
    assert halves[1]["name"] in client.get("/api/takes/deleted").json()
    assert client.post(f"/api/takes/{halves[1]['name']}/restore").status_code == 200

    data = client.get("/api/collect/map").json()
    assert data["states"]["stand"]["seconds"] > 2.0
    tasks = {row["task"] for row in client.get("/api/collect/tasks").json()}
    assert data["proposals"]
    assert {row["task"] for row in data["proposals"]} <= tasks  # each can be added by one click


def test_one_flaw_is_cut_out_of_a_take_and_undo_takes_it_back(studio_live, tmp_path):
    acted = acted_take(
        "tilt", np.random.default_rng(4), lag=0.3, idle_gestures=False, sensor="mocap"
    )
    pos = acted.human_pos.copy()
    pos[60:90], pos[150:180] = pos[60], pos[150]
    record(replace(acted, human_pos=pos), tmp_path, "flawed")
    name = add_take(studio_live.sessions, tmp_path / "flawed")
    client, path = studio_live.client, f"/api/takes/{name}"
    found = client.get(f"{path}/review").json()["suggestions"]
    which = [i for i, s in enumerate(found) if s["kind"] == "frozen"]
    assert len(which) == 2
    done = client.post(f"{path}/clean", json={"which": which[1:]}).json()
    assert done["undoable"] == 1
    folder = studio_live.sessions / name
    assert read_edits(folder).edits.cuts == (pytest.approx((5.0, 179 / 30.0), abs=1e-3),)
    left = client.get(f"{path}/review").json()["suggestions"]
    assert [s["message"] for s in left] == [s["message"] for s in found[: which[1]]]
    assert client.post(f"{path}/undo").json()["undoable"] == 0
    assert read_edits(folder).edits.cuts is None
    assert client.get(f"{path}/review").json()["suggestions"] == found

    assert client.post(f"{path}/clean").status_code == 200
    assert client.get(f"{path}/review").json()["suggestions"] == []
    refused = client.post(f"{path}/clean", json={"which": [0]})
    assert refused.status_code == 422
    assert "there is no suggestion 0" in refused.json()["why"]


def test_what_does_not_fit_is_refused_with_what_would_work(collecting):
    client = collecting.client

    def why(answer, status):
        assert answer.status_code == status, answer.text
        return answer.json()["why"]

    plan = {"items": [{"task": "fly"}]}
    assert "known: " in why(client.post("/api/collect/plan", json=plan), 422)
    plan = {"items": [{"task": "tilt", "takes": 90}] * 3}
    assert "at most 200" in why(client.post("/api/collect/plan", json=plan), 422)
    answer = client.post("/api/collect/action", json={"action": "go"})
    assert "choose mode collect first" in why(answer, 409)
    for path in ("review", "timeline", "series"):
        assert "unknown take" in why(client.get(f"/api/takes/nobody/{path}"), 404)
    assert why(client.post("/api/takes/..%2f..%2fetc/show", json={}), 404)
    assert "unknown take" in why(client.post("/api/train", json={"takes": ["nobody"]}), 422)
    assert "no training is running" in why(client.post("/api/train/cancel"), 409)
    assert "unknown mapper" in why(client.post("/api/mapper", json={"name": "nobody"}), 409)


@pytest.mark.parametrize(
    ("file", "content"),
    [("walk.safetensors", b"torn"), ("walk.json", b"{"), ("mapper.json", b"[]")],
)
def test_a_damaged_mapper_is_409_with_its_file_and_the_robot_goes_on(collecting, file, content):
    folder = collecting.sessions / "mappers" / "damaged"
    shutil.copytree(style_dir("march"), folder)
    try:
        (folder / "mapper.json").write_text("{}")
        (folder / file).write_bytes(content)
        answer = collecting.client.post("/api/mapper", json={"name": "damaged"})
        assert answer.status_code == 409
        assert f"damaged/{file} cannot be used" in answer.json()["why"]
        state = collecting.state()
        assert (state["mapper"]["name"], state["stopped"]) == ("shipped", False)
    finally:
        shutil.rmtree(folder)


def test_every_route_is_in_the_schema_and_behind_the_door(collecting):
    import httpx

    paths = collecting.client.get("/api/docs").json()["paths"]
    for path in ("/api/collect/plan", "/api/takes/{name}/review", "/api/train", "/api/mapper"):
        assert path in paths
    with httpx.Client(base_url=collecting.base, trust_env=False) as stranger:
        assert stranger.post("/api/train", json={"takes": ["x"]}).status_code == 401
        assert stranger.get("/api/collect/map").status_code == 401


@pytest.mark.slow
def test_takes_train_a_mapper_that_is_swapped_in_compared_and_rolled_back(collecting):
    client = collecting.client
    names = collect(collecting, items=[{**QUICK, "takes": 2, "seconds": 3.0}])
    assert len(names) == 2
    told = client.post("/api/train/pairs", json={"takes": names}).json()
    assert told["counts"]["stand"] > 100
    assert set(told["left_out"]) == {"walk", "sit"}
    assert client.post("/api/train/pairs", json={"takes": ["nobody"]}).status_code == 422
    assert client.post("/api/train/pairs", json={"dataset": "none"}).status_code == 422
    body = {"takes": names, "name": f"t{int(time.time())}", "steps": 60}
    assert client.post("/api/train", json=body).status_code == 200
    assert client.post("/api/train", json={**body, "name": "two"}).status_code == 409
    deadline = time.monotonic() + PATIENCE
    while (job := client.get("/api/train").json())["status"] == "running":
        assert time.monotonic() < deadline, job
        time.sleep(0.2)
    assert job["status"] == "done", job["why"]
    assert list(job["states"]) == ["stand"]
    assert job["left_out"] == told["left_out"]
    result = job["states"]["stand"]["result"]
    assert set(result["scores"]) == {"yours", "nearest_pair", "ridge", "shipped"}
    assert len(job["states"]["stand"]["curve"]) == 3  # 60 steps, twenty apart
    (about,) = [m for m in client.get("/api/mappers").json() if m["name"] == body["name"]]
    assert about["takes"] == names
    assert about["left_out"] == told["left_out"]
    version = {"dataset": about["dataset"]}
    of = client.post("/api/train/pairs", json=version).json()
    assert of["counts"] == job["counts"]
    assert of["left_out"] == told["left_out"]

    state = client.post("/api/mapper", json={"name": body["name"]}).json()
    assert state["mapper"] == {
        "name": body["name"], "style": "march", "before": "shipped", "refused": {}, "fitting": None,
    }  # fmt: skip
    assert client.post("/api/mapper/back").json()["mapper"]["name"] == "shipped"
    assert client.post("/api/mapper/back").json()["mapper"]["name"] == body["name"]


@pytest.mark.slow
def test_a_training_can_be_cancelled(collecting):
    client = collecting.client
    names = collect(collecting)
    body = {"takes": names, "states": ["stand"], "name": "never", "steps": 50_000}
    assert client.post("/api/train", json=body).status_code == 200
    assert client.post("/api/train/cancel").json()["status"] == "cancelled"
    assert client.get("/api/train").json()["status"] == "cancelled"
    assert all(m["name"] != "never" for m in client.get("/api/mappers").json())


def test_a_damaged_and_an_empty_take_are_told_of_and_hurt_nobody(studio_live, tmp_path):
    recorder = Recorder(studio_live.sessions / "elsewhere")
    recorder.start(name="empty")
    recorder.close()
    client = studio_live.client
    for name, file, data in (("empty", "", b""), ("deep", "edits.jsonl", b"[" * 100_000)):
        folder = studio_live.sessions / name
        shutil.copytree(studio_live.sessions / "elsewhere" / "empty", folder)
        if file:
            (folder / file).write_bytes(data)
    (studio_live.sessions / "deep" / "meta.json").write_bytes(b"[" * 100_000)
    listed = {take["name"]: take for take in client.get("/api/takes").json()}
    assert {"empty", "deep"} <= set(listed)
    assert "no tick" in listed["deep"]["damaged"]
    for name in ("empty", "deep"):
        for path in ("timeline", "series", "review", "export?format=lerobot", "export?format=html"):
            answer = client.get(f"/api/takes/{name}/{path}")
            assert answer.status_code == 422, (path, answer.text)
            assert "no tick" in answer.text
        assert client.delete(f"/api/takes/{name}").status_code == 200
    assert client.get("/api/collect/map").status_code == 200
