"""One transport of clips and takes: the timeline's clock, and the robot that follows it."""

import numpy as np
import pytest
from fake_clock import FakeClock
from pydantic import ValidationError
from turning import DT, ask, run

from studio.errors import StudioError
from studio.human.calibration import calibrate
from studio.human.pose import HumanClip
from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.runtime import Runtime, RuntimeConfig
from studio.live.source_reader import OpenedSource, SourceReader
from studio.live.timeline import Timeline
from studio.mocap.between import pose_at
from studio.mocap.clip_source import ClipSource
from studio.synthetic.operator import OperatorSource


def turned(line: Timeline, periods: int, **how) -> list[float]:
    """The places of so many control periods more."""
    first = round(line.passed / DT)
    places = []
    for k in range(first + 1, first + periods + 1):
        line.advance(k * DT, **how)
        places.append(line.place)
    return places


# The clock -------------------------------------------------------------------------------------


def test_a_timeline_nobody_touched_is_its_source_s_own_clock():
    line = Timeline(10.0)
    assert turned(line, 60) == [k * DT for k in range(1, 61)]
    assert not line.moved
    assert line.runs


def test_a_pause_keeps_the_place_and_playing_goes_on_from_it():
    line = Timeline(10.0)
    turned(line, 30)
    line.seek(playing=False)
    assert turned(line, 30) == [1.0] * 30
    line.seek(playing=True)
    assert turned(line, 30)[-1] == pytest.approx(2.0)


def test_a_speed_is_that_many_seconds_a_second():
    line = Timeline(10.0)
    turned(line, 30)
    line.seek(speed=0.25)
    assert turned(line, 60)[-1] == pytest.approx(1.0 + 2.0 * 0.25)
    line.seek(speed=2.0)
    assert turned(line, 30)[-1] == pytest.approx(1.5 + 1.0 * 2.0)
    with pytest.raises(StudioError, match=r"between 0\.1 and 2"):
        line.seek(t=5.0, speed=3.0)
    assert line.place == pytest.approx(3.5)


def test_what_is_over_ends_and_plays_from_its_start():
    line = Timeline(1.0)
    line.seek(t=0.5)
    turned(line, 20)
    assert (line.place, line.ended, line.runs) == (1.0, True, False)
    line.seek(playing=True)
    assert (line.place, line.ended, line.runs) == (0.0, False, True)


def test_a_loop_begins_anew_but_not_while_a_take_is_recorded():
    line = Timeline(1.0)
    line.seek(loop=True)
    assert max(turned(line, 45)) < 1.0
    assert line.runs
    turned(line, 45, loops=False)
    assert line.ended


def test_a_stop_holds_it_and_whoever_releases_it_goes_on():
    line = Timeline(10.0)
    turned(line, 30)
    assert turned(line, 30, held=True)[-1] == pytest.approx(1.0)
    assert not line.runs
    assert turned(line, 1)[-1] == pytest.approx(1.0 + DT)


def test_it_is_a_jump_to_be_taken_far_and_to_begin_to_move_but_not_to_step():
    line = Timeline(10.0)
    turned(line, 30)
    assert not line.jumped()
    line.seek(t=5.0)
    turned(line, 1)
    assert line.jumped()
    assert not line.jumped()
    line.seek(playing=False)
    turned(line, 5)
    line.seek(t=line.place + DT)
    turned(line, 1)
    assert not line.jumped()
    line.seek(playing=True)
    turned(line, 1)
    assert line.jumped()


def test_a_place_beyond_either_end_is_the_end():
    line = Timeline(10.0)
    line.seek(t=-3.0)
    assert line.place == 0.0
    line.seek(t=99.0)
    assert line.place == 10.0


# Poses in between ------------------------------------------------------------------------------


def clip_of(task: str, seconds: float, seed: int = 0) -> HumanClip:
    """A synthetic person, recorded at 30 Hz."""
    source = OperatorSource(task, seed=seed)
    read = [source.read(k * DT) for k in range(round(seconds / DT))]
    poses = [pose for pose in read if pose is not None]
    return HumanClip(
        name="bvh:clip.bvh",
        t=np.arange(len(poses), dtype=np.float64) * DT,
        joint_pos_w=np.stack([pose.joint_pos_w for pose in poses]),
        confidence=np.stack([pose.confidence for pose in poses]),
    )


def test_a_pose_lies_between_its_neighbours_as_its_time_does():
    clip = clip_of("walk", 1.0)
    times = clip.t
    between = pose_at(0.25 * DT + 10 * DT, times, clip.__getitem__)
    assert between is not None
    wanted = 0.75 * clip.joint_pos_w[10] + 0.25 * clip.joint_pos_w[11]
    assert np.allclose(between.joint_pos_w, wanted, atol=1e-12)
    alike = pose_at(float(times[7]), times, clip.__getitem__)
    assert alike is not None
    assert np.allclose(alike.joint_pos_w, clip.joint_pos_w[7], atol=1e-12)


def test_nobody_knows_what_was_in_a_gap():
    clip = clip_of("walk", 1.0)
    times = np.concatenate([clip.t[:10], 3.0 + clip.t[10:]])
    assert pose_at(1.6, times, clip.__getitem__) is None
    assert pose_at(0.1, times, clip.__getitem__) is not None


def test_stamps_run_forward_however_late_a_period_was():
    reader = SourceReader(ClipSource(clip_of("walk", 4.0)))
    assert reader.timeline is not None
    late = (0.0, 0.030, 0.062, 0.099, 0.101, 0.133, 0.170, 0.171, 0.200)
    stamps = []
    for k, now in enumerate(late):
        if k == 4:
            reader.timeline.seek(playing=False)
        pose = reader.read(now)
        stamps += [] if pose is None else [pose.t]
    assert len(stamps) >= 8
    assert (np.diff(stamps) > 0.0).all()


# The robot -------------------------------------------------------------------------------------


@pytest.fixture
def playing(tmp_path):
    """A loop on a fake clock that plays a clip of a task."""

    def build(task="walk", seconds=12.0, seed=3) -> LiveLoop:
        source = ClipSource(clip_of(task, seconds, seed))
        config = RuntimeConfig(sessions=tmp_path / "sessions")
        calibration = calibrate(source.calibration_poses())
        opened = OpenedSource(source=source, calibration=calibration)
        return LiveLoop(clock=FakeClock(), runtime=Runtime(config, opened))

    return build


def transport(loop: LiveLoop, action: str, **more) -> dict:
    """Ask, and be told where we are."""
    result = ask(loop, c.Transport(action=action, **more))
    assert result.ok, result.why
    return loop.state_dict()["transport"]


def test_a_walker_that_is_paused_stands_and_one_that_plays_on_walks(playing):
    loop = playing()
    assert any(tick.state == "walk" for tick in run(loop, 5.0))
    at = transport(loop, "pause")
    ticks = run(loop, 5.0)
    assert loop.state_dict()["transport"] == at
    assert not any(tick.fallen for tick in ticks)
    assert ticks[-1].state == "stand"
    assert ticks[-1].why == "paused: play to go on"
    assert loop.state_dict()["reason"] == "paused"
    assert all(tick.human_fresh for tick in ticks)  # nobody has gone missing
    assert loop.state_dict()["counters"]["rejected"] == 0
    speeds = [np.hypot(*tick.robot.base_lin_vel_w[:2]) for tick in ticks[-30:]]
    assert max(speeds) < 0.1
    transport(loop, "play")
    assert any(tick.state == "walk" for tick in run(loop, 4.0))


def test_a_person_who_is_paused_in_a_lean_is_followed_in_it(playing):
    loop = playing("tilt", 20.0)
    rolled = 0.0
    while abs(rolled) < np.radians(5.0):
        tick = run(loop, DT)[0]
        rolled = float(np.arcsin(2.0 * (np.prod(tick.reference.base_quat[:2]))))
    transport(loop, "pause")
    poses = [tick.reference.base_quat for tick in run(loop, 4.0)]
    assert loop.state_dict()["state"] == "stand"
    assert np.ptp(poses[-30:], axis=0).max() < 1e-3
    assert abs(poses[-1][1]) > np.sin(np.radians(2.0))


def test_a_seek_is_met_standing_and_refuses_nothing(playing):
    loop = playing(seconds=20.0)
    run(loop, 4.0)
    for place in (15.0, 2.0, 9.5):
        assert transport(loop, "seek", position_s=place)["position_s"] == pytest.approx(place)
        ticks = run(loop, 4.0)
        assert not any(tick.fallen for tick in ticks)
        assert any(tick.state == "walk" for tick in ticks)
    state = loop.state_dict()
    assert state["counters"]["rejected"] == 0
    assert not state["stopped"]
    assert state["transport"]["position_s"] > 9.5


def test_an_ended_clip_says_so_and_plays_again(playing):
    loop = playing(seconds=3.0)
    run(loop, 4.0)
    state = loop.state_dict()
    assert state["reason"] == "source_ended"
    assert state["transport"] == {
        "position_s": 3.0, "length_s": 3.0, "playing": False,
        "loop": False, "speed": 1.0, "ended": True,
    }  # fmt: skip
    again = transport(loop, "again")
    assert (again["ended"], again["playing"]) == (False, True)
    ticks = run(loop, 1.0)
    assert all(tick.human_fresh for tick in ticks)
    assert loop.state_dict()["reason"] != "source_ended"


def test_steps_are_frames_and_pause(playing):
    loop = playing()
    run(loop, 2.0)
    at = transport(loop, "pause")["position_s"]
    stepped = transport(loop, "step", frames=3)
    assert stepped["position_s"] == pytest.approx(at + 3 * DT, abs=2e-3)
    assert transport(loop, "step", frames=-3)["position_s"] == pytest.approx(at, abs=2e-3)
    assert not stepped["playing"]


def test_half_the_speed_is_half_the_speed_of_every_joint(playing):
    fast, slow = playing("tilt", 20.0), playing("tilt", 20.0)
    transport(slow, "speed", speed=0.5)
    moved = []
    for loop, seconds in ((fast, 3.0), (slow, 6.0)):
        poses = [tick.human.joint_pos_w for tick in run(loop, seconds) if tick.human is not None]
        steps = np.linalg.norm(np.diff(poses, axis=0), axis=-1).max(axis=-1)
        moved.append(np.percentile(steps, 90))
    assert moved[1] == pytest.approx(0.5 * moved[0], rel=0.1)
    stamps = [tick.t for tick in run(slow, 1.0)]
    assert np.allclose(np.diff(stamps), DT)


def test_nobody_is_walked_with_who_hurries(playing):
    loop = playing(seconds=20.0)
    run(loop, 4.0)
    transport(loop, "speed", speed=2.0)
    ticks = run(loop, 4.0)
    assert ticks[-1].state == "stand"
    assert not any(tick.fallen for tick in ticks)
    assert loop.state_dict()["reason"] == "hurried"
    assert "played at 2 times its speed, the robot does not walk" in ticks[-1].why
    transport(loop, "speed", speed=1.0)
    assert any(tick.state == "walk" for tick in run(loop, 4.0))


def test_a_stop_pauses_and_arming_goes_on(playing):
    loop = playing()
    run(loop, 2.0)
    assert ask(loop, c.Stop()).ok
    run(loop, 1.0)
    stopped = loop.state_dict()["transport"]
    run(loop, 1.0)
    assert loop.state_dict()["transport"] == stopped
    assert not stopped["playing"]
    for action in ("play", "again"):
        refused = ask(loop, c.Transport(action=action))
        assert not refused.ok
        assert "reset, then arm; then play" in refused.why
    moved = transport(loop, "seek", position_s=1.0)  # whoever is stopped may look around
    assert moved["position_s"] == 1.0
    run(loop, 1.0)
    assert loop.state_dict()["stopped"]
    ask(loop, c.Reset())
    ask(loop, c.Arm())
    run(loop, 2.0)
    assert loop.state_dict()["transport"]["position_s"] > 1.5


def test_a_take_being_recorded_is_not_torn(playing):
    loop = playing(seconds=4.0)
    run(loop, 1.0)
    transport(loop, "loop", on=True)
    assert ask(loop, c.StartTake(name="kept_whole")).ok
    for asked in (
        c.Transport(action="seek", position_s=0.0),
        c.Transport(action="pause"),
        c.Transport(action="speed", speed=2.0),
        c.Transport(action="step", frames=1),
        c.Transport(action="again"),
    ):
        refused = ask(loop, asked)
        assert not refused.ok
        assert "take kept_whole is being recorded: stop it first" in refused.why
    run(loop, 4.0)
    assert loop.state_dict()["transport"]["ended"]  # a loop would tear it as well
    assert ask(loop, c.StopTake()).ok


def test_a_take_shown_again_has_the_same_transport(playing):
    loop = playing()
    ask(loop, c.StartTake(name="shown"))
    run(loop, 3.0)
    ask(loop, c.StopTake())
    assert ask(loop, c.SetMode(mode="replay")).ok
    run(loop, 1.0)
    assert transport(loop, "pause")["playing"] is False
    assert transport(loop, "seek", position_s=0.5)["position_s"] == pytest.approx(0.5)
    assert loop.state_dict()["replay"]["t"] == pytest.approx(0.5)
    transport(loop, "play")
    run(loop, 4.0)
    assert loop.state_dict()["transport"]["ended"]
    assert transport(loop, "again")["playing"]


def test_a_clip_waits_while_a_take_is_shown(playing):
    loop = playing()
    ask(loop, c.StartTake(name="meanwhile"))
    run(loop, 2.0)
    ask(loop, c.StopTake())
    at = loop.state_dict()["transport"]["position_s"]
    ask(loop, c.SetMode(mode="replay"))
    run(loop, 5.0)
    ask(loop, c.SetMode(mode="live"))
    assert loop.state_dict()["transport"]["position_s"] == pytest.approx(at, abs=0.2)


def test_who_has_no_timeline_has_no_transport(tmp_path):
    loop = LiveLoop(RuntimeConfig(source="operator:quiet", sessions=tmp_path), FakeClock())
    run(loop, 0.2)
    assert loop.state_dict()["transport"] is None
    refused = ask(loop, c.Transport(action="pause"))
    assert refused.why == "operator:quiet has no timeline: choose a clip or a take"


@pytest.mark.parametrize(
    "body",
    [{"action": "seek"}, {"action": "play", "speed": 1.0}, {"action": "loop"},
     {"action": "speed", "speed": 9.0}, {"action": "rewind"},
     {"action": "seek", "position_s": float("nan")}],
)  # fmt: skip
def test_an_action_says_what_it_needs_and_no_more(body):
    with pytest.raises(ValidationError):
        c.Transport(**body)
