"""Scenes over HTTP: what there is to do, who plays, who did best; and the page's list of them."""

import re

from studio.live.best_runs import BestRuns
from studio.options import SCENES
from studio.scenes.registry import scene as scene_of
from studio.web.gateway import assets_folder

NAMES = [name for name in SCENES if name != "empty"]


def test_every_scene_says_what_to_do_and_what_a_person_does_for_it(studio_live):
    scenes = studio_live.client.get("/api/scenes").json()["scenes"]
    assert [scene["name"] for scene in scenes] == NAMES
    for scene in scenes:
        declared = scene_of(scene["name"])
        assert [step["goal"] for step in scene["steps"]] == [s.goal for s in declared.steps]
        assert all(step["body"] for step in scene["steps"])
        assert len(scene["props"]) == len(declared.props)
    slope = next(p for s in scenes for p in s["props"] if p["name"] == "slope")
    assert not slope["round"]
    assert not slope["moves"]


def test_best_runs_are_told_and_a_name_that_cannot_be_shown_is_refused(studio_live):
    client = studio_live.client
    name = "<img src=x>"
    BestRuns(studio_live.sessions).add("push", name, 150, 20.0, "webcam")
    scenes = client.get("/api/scenes").json()["scenes"]
    best = {scene["name"]: scene["best"] for scene in scenes}
    assert [run["person"] for run in best["push"]] == [name]
    assert best["slalom"] == []
    assert client.post("/api/person", json={"name": "  Ann  Lee "}).json()["person"] == "Ann Lee"
    for bad in ({"name": "a\x07"}, {"name": "x" * 41}, {"name": 5}, {}):
        assert client.post("/api/person", json=bad).status_code == 409
    assert client.get("/api/state").json()["person"] == "Ann Lee"
    client.post("/api/person", json={"name": ""})


def test_the_page_lists_the_scenes_by_their_titles():
    page = (assets_folder() / "index.html").read_text("utf-8")
    listed = re.search(r'<select id="scene-name".*?</select', page, re.S)
    assert listed is not None
    options = re.findall(r'<option value="(.*?)">(.*?)</option>', listed[0])
    assert options == [(name, scene_of(name).title) for name in NAMES]
