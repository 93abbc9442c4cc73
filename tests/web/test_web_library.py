"""The library of takes over HTTP: many at once, pictures, scores, the bin, exports of many."""

import io
import time
import zipfile

import pytest
from acted_takes import acted_take, record
from conftest import PATIENCE
from numpy.random import default_rng

from studio.takes.names import RESERVED

NAMES = ("shelf-a", "shelf-b", "shelf-c")


def empty_the_bin(client) -> None:
    places = [one["place"] for one in client.get("/api/bin").json()["takes"]]
    client.post("/api/bin", json={"places": places, "action": "delete"})
    assert client.get("/api/bin").json() == {"bytes": 0, "takes": []}


@pytest.fixture
def shelf(studio_live, tmp_path):
    """Three takes of the running studio; whatever becomes of them, they are gone afterwards."""
    empty_the_bin(studio_live.client)  # of what tests before have deleted
    for i, name in enumerate(NAMES):
        # Recorded elsewhere: the studio keeps its own folder to itself once it has recorded there.
        record(acted_take("tilt", default_rng(i), seconds=3.0), tmp_path, name)
        (tmp_path / name).rename(studio_live.sessions / name)
    yield studio_live.client
    client = studio_live.client
    client.post("/api/takes/many", json={"names": NAMES, "action": "delete"})
    empty_the_bin(client)


def ended(client) -> dict:
    """The export, once it does not run any more."""
    deadline = time.monotonic() + PATIENCE
    while (export := client.get("/api/exports").json())["status"] == "running":
        assert time.monotonic() < deadline, export
        time.sleep(0.1)
    return export


def test_many_takes_are_kept_deleted_and_brought_back(shelf):
    names = [*NAMES, "nobody"]
    kept = shelf.post("/api/takes/many", json={"names": names, "action": "keep"}).json()
    assert kept["done"] == list(NAMES)
    assert list(kept["refused"]) == ["nobody"]
    assert all(shelf.get(f"/api/takes/{name}").json()["kept"] for name in NAMES)
    gone = shelf.post("/api/takes/many", json={"names": NAMES[:2], "action": "delete"}).json()
    bin = shelf.get("/api/bin").json()
    assert [one["place"] for one in bin["takes"]] == gone["binned"][::-1]
    assert bin["takes"][0]["take"]["kept"] is True
    assert bin["bytes"] == sum(one["bytes"] for one in bin["takes"]) > 10_000
    body = {"places": gone["binned"][:1], "action": "restore"}
    assert shelf.post("/api/bin", json=body).json()["done"] == gone["binned"][:1]
    assert shelf.get(f"/api/takes/{NAMES[0]}").status_code == 200
    again = shelf.post("/api/bin", json=body).json()
    assert list(again["refused"]) == gone["binned"][:1]
    body = {"places": gone["binned"][1:], "action": "delete"}
    assert shelf.post("/api/bin", json=body).json()["done"] == gone["binned"][1:]
    assert shelf.post(f"/api/takes/{NAMES[1]}/restore").status_code == 404


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("takes/many", {"names": [], "action": "keep"}),
        ("takes/many", {"names": ["a"], "action": "burn"}),
        ("takes/many", {"names": ["a"] * 10_001, "action": "keep"}),
        ("takes/thumbnails", {"names": ["a"] * 25}),
        ("takes/scores", {"names": "a"}),
        ("bin", {"places": ["a"], "action": "keep"}),
        ("exports", {"takes": ["shelf-a"], "format": "pdf"}),
        ("exports", {"takes": ["nobody"]}),
        ("exports", {"takes": ["shelf-a"], "session": "me"}),
        ("exports", {"session": "nobody"}),
        ("exports", {}),
    ],
)
def test_what_does_not_fit_is_refused_with_why(shelf, path, body):
    answer = shelf.post(f"/api/{path}", json=body)
    assert answer.status_code == 422
    assert answer.json()["why"]


def test_takes_have_pictures_and_scores(shelf):
    body = {"names": [*NAMES, "nobody"]}
    first = shelf.post("/api/takes/thumbnails", json=body).json()
    assert set(first["pictures"]) == set(NAMES)
    assert list(first["refused"]) == ["nobody"]
    assert all(svg.startswith("<svg ") for svg in first["pictures"].values())
    shelf.patch(f"/api/takes/{NAMES[0]}", json={"trim": [0.0, 0.5]})
    second = shelf.post("/api/takes/thumbnails", json=body).json()["pictures"]
    assert {n for n in NAMES if second[n] != first["pictures"][n]} == {NAMES[0]}
    (place,) = shelf.post("/api/takes/many", json={"names": NAMES[:1], "action": "delete"}).json()[
        "binned"
    ]
    binned = shelf.post("/api/takes/thumbnails", json={"names": [place]}).json()["pictures"]
    assert binned == {place: second[NAMES[0]]}  # as it was when it was thrown away
    shelf.post("/api/bin", json={"places": [place], "action": "restore"})
    found = shelf.post("/api/takes/scores", json=body).json()
    assert set(found["scores"]) == set(NAMES)
    listed = {t["name"]: t["score"] for t in shelf.get("/api/takes").json()}
    assert {name: listed[name] for name in NAMES} == found["scores"]


def test_many_takes_become_one_file_that_comes_back(shelf):
    started = shelf.post("/api/exports", json={"takes": NAMES, "format": "takes"}).json()
    assert started["total"] == 3
    done = ended(shelf)
    assert (done["status"], done["done"], done["left_out"]) == ("done", 3, {}), done
    got = shelf.get(f"/api/exports/{done['id']}/file")
    assert len(got.content) == done["bytes"]
    assert done["file"] in got.headers["content-disposition"]
    assert len([n for n in zipfile.ZipFile(io.BytesIO(got.content)).namelist()
                if n.endswith("tape.mcap")]) == 3  # fmt: skip
    answer = shelf.post("/api/takes/import", files={"files": (done["file"], got.content)})
    assert answer.status_code == 200, answer.text
    back = answer.json()["takes"]
    assert len(back) == 3
    shelf.post("/api/takes/many", json={"names": back, "action": "delete"})
    shelf.post("/api/exports", json={"takes": NAMES[:1], "format": "csv"})
    assert ended(shelf)["file"] == f"{NAMES[0]}-csv.zip"
    assert shelf.get(f"/api/exports/{done['id']}/file").status_code == 404  # only the last is kept


def test_an_export_can_be_cancelled_and_another_one_follows(shelf):
    shelf.post("/api/exports", json={"takes": NAMES, "format": "lerobot"})
    second = shelf.post("/api/exports", json={"takes": NAMES, "format": "lerobot"})
    cancelled = shelf.post("/api/exports/cancel")
    # Three short takes may be done before either is heard.
    assert (second.status_code, cancelled.status_code) in ((409, 200), (409, 409), (200, 200))
    shelf.post("/api/exports/cancel")
    shelf.post("/api/exports", json={"takes": NAMES, "format": "npz"})
    assert ended(shelf)["status"] == "done"


def test_the_library_s_own_paths_hide_no_take(shelf):
    """What is answered under /api/takes/ to POST alone may be a take's name as well."""
    assert not {"many", "thumbnails", "scores"} & set(RESERVED)
    assert shelf.get("/api/takes/many").json()["why"].startswith("unknown take 'many'")
