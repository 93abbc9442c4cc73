"""One transport over HTTP: of a clip that drives the robot, and of a recorded take that does."""

import shutil

import pytest

from studio.client import ClientError, Studio
from studio.paths import package_folder

TOKEN = "test-token-0123456789"
SAMPLE = package_folder("web_assets") / "samples/lean-march-reach.bvh"
TAKE = SAMPLE.parents[2] / "sessions/example-tilt-and-reach"


@pytest.fixture
def clip(studio_live):
    """A studio that plays the sample."""
    answer = studio_live.client.post("/api/source", json={"source": f"bvh:{SAMPLE}"})
    assert answer.status_code == 200
    return studio_live


def asked(studio, status: int = 200, **body) -> dict:
    """The answer to what the transport is asked."""
    answer = studio.client.post("/api/transport", json=body)
    assert answer.status_code == status, answer.text
    return answer.json()


def test_a_clip_is_paused_moved_sped_up_and_played_on(clip):
    clip.wait(lambda s: s["transport"]["playing"] and s["transport"]["position_s"] > 0.2)
    paused = asked(clip, action="pause")
    at = paused["transport"]["position_s"]
    assert not paused["transport"]["playing"]
    clip.wait(lambda s: s["reason"] == "paused" and s["why"] == "paused: play to go on")
    assert asked(clip, action="step", frames=1)["transport"]["position_s"] == pytest.approx(
        at + 1 / 30, abs=2e-3
    )
    assert asked(clip, action="seek", position_s=3.0)["transport"]["position_s"] == 3.0
    assert asked(clip, action="speed", speed=0.5)["transport"]["speed"] == 0.5
    played = asked(clip, action="play")["transport"]
    assert played["playing"]
    assert played["length_s"] > 10.0
    clip.wait(lambda s: s["transport"]["position_s"] > 3.2 and s["stale_s"] < 0.2)


def test_a_clip_ends_and_is_played_again_and_in_a_loop(clip):
    state = clip.state()
    length, refused = state["transport"]["length_s"], state["counters"]["rejected"]
    asked(clip, action="seek", position_s=length - 0.2)
    ended = clip.wait(lambda s: s["transport"]["ended"])
    assert ended["transport"]["position_s"] == length
    assert ended["reason"] == "source_ended"
    assert asked(clip, action="again")["transport"]["playing"]
    asked(clip, action="loop", on=True)
    asked(clip, action="seek", position_s=length - 0.2)
    clip.wait(lambda s: s["transport"]["playing"] and 0.2 < s["transport"]["position_s"] < 5.0)
    assert clip.state()["counters"]["rejected"] == refused  # wherever it was taken


def test_a_stop_wins(clip):
    asked(clip, action="play")
    clip.client.post("/api/stop")
    stopped = clip.wait(lambda s: not s["transport"]["playing"])
    assert stopped["stopped"]
    why = asked(clip, 409, action="play")["why"]
    assert "reset, then arm; then play" in why
    assert clip.state()["stopped"]


def test_what_a_recorded_take_would_not_bear_is_refused(clip):
    asked(clip, action="again")
    name = clip.client.post("/api/takes/start", json={"label": "whole"}).json()["name"]
    try:
        why = asked(clip, 409, action="seek", position_s=1.0)["why"]
        assert why == f"take {name} is being recorded: stop it first, then seek"
    finally:
        clip.client.post("/api/takes/stop")
    asked(clip, action="seek", position_s=1.0)


def test_a_take_drives_by_the_same_transport(studio_live):
    target = studio_live.sessions / TAKE.name
    shutil.copytree(TAKE, target)
    try:
        client = Studio(f"{studio_live.base}/?token={TOKEN}")
        client.set_source(f"take:{TAKE.name}")
        moved = client.transport("seek", position_s=5.0)["transport"]
        assert moved is not None
        assert moved["position_s"] == pytest.approx(5.0, abs=0.1)
        assert moved["length_s"] == pytest.approx(15.7, abs=0.05)
        with pytest.raises(ClientError, match="seek needs position_s"):
            client.transport("seek")
    finally:
        studio_live.client.post("/api/source", json={"source": "operator:quiet"})
        shutil.rmtree(target)


def test_who_lives_has_no_transport(studio_live):
    assert studio_live.state()["transport"] is None
    why = asked(studio_live, 409, action="pause")["why"]
    assert why == "operator:quiet has no timeline: choose a clip or a take"


def test_a_misfit_is_answered_with_what_would_fit(clip):
    assert (
        "known: again, loop, pause, play, seek, speed, step"
        in asked(clip, 409, action="rewind")["why"]
    )
    assert "speed" in asked(clip, 409, action="speed", speed=50.0)["why"]
    assert "play needs nothing more" in asked(clip, 409, action="play", frames=3)["why"]
