"""Mode collect in the live loop on a fake clock: what is shown, acted out, recorded and judged."""

import errno
import json
import os

import numpy as np
import pytest
from fake_clock import FakeClock
from turning import DT, ask, run

from studio.human.pose import HumanClip
from studio.human.skeleton import NEUTRAL
from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.runtime import Runtime, RuntimeConfig
from studio.live.shown_motion import PlanItem
from studio.mocap.clip_source import ClipSource
from studio.mocap.stream import StreamSource
from studio.synthetic.impaired import IMPAIRMENTS, Impaired
from studio.synthetic.operator import InteractiveOperator, OperatorSource
from studio.takes.align import lag
from studio.takes.export.bvh import write_bvh
from studio.takes.record.tape import TapeWriter
from studio.takes.session_library import SessionLibrary
from studio.takes.sessions import SessionBook

STILL = HumanClip(
    name="still",
    t=np.arange(2) / 30,
    joint_pos_w=np.stack([NEUTRAL] * 2),
    confidence=np.ones((2, 19)),
)


@pytest.fixture
def loop(tmp_path):
    config = RuntimeConfig(source="operator", sessions=tmp_path / "sessions")
    loop = LiveLoop(clock=FakeClock(), runtime=Runtime(config))
    yield loop
    loop.runtime.close()


def plan(*items, **options):
    return c.SetPlan(items=items, operator="Ada", notes="first day", **{"seed": 0, **options})


def phase(loop):
    return loop.state_dict()["collect"]["phase"]


def until(loop, wanted, limit=60.0):
    for _ in range(round(limit / DT)):
        if phase(loop) == wanted:
            return
        run(loop, DT)
    raise AssertionError((phase(loop), wanted, loop.state_dict()["collect"]["why"]))


def test_a_collected_take_holds_what_was_shown_and_a_person_who_acts_it_out_late(loop):
    assert ask(loop, plan(PlanItem(task="tilt", takes=1, seconds=6.0), preview=False)).ok
    assert ask(loop, c.SetMode(mode="collect")).ok
    assert loop.state_dict()["source"] == "operator:follow"
    assert ask(loop, c.CollectAction(action="go")).ok
    until(loop, "review")
    answer = ask(loop, c.CollectAction(action="keep"))
    assert answer.ok
    assert answer.data["keep"] is True
    assert phase(loop) == "done"
    motion = loop.runtime.collector.machine.slots[0].motion
    person = loop.runtime.source.person
    loop.runtime.close()

    take = SessionLibrary(loop.config.sessions).read(answer.data["take"])
    assert take.label == "tilt"
    assert take.edits.keep is True
    assert len(take) == len(motion)
    shown = np.array([pose.joint_pos for pose in motion.poses])
    assert np.abs(take.arrays.reference["joint_pos"] - shown).max() < 1e-6
    # The simulated robot does what is shown: it is not left standing.
    moved = np.ptp(take.arrays.robot["joint_pos"], axis=0).max()
    assert moved > 0.5 * np.ptp(shown, axis=0).max()
    ref = take.arrays.reference
    assert take.human is not None
    found = lag.align(
        lag.human_side(take.human.joint_pos_w),
        lag.robot_side(*(ref[k] for k in ("base_pos", "base_quat", "joint_pos", "foot_contact"))),
        DT,
    )
    assert found.lag == pytest.approx(person.delay_s, abs=2.5 * DT)
    assert found.correlation > 0.6


def test_a_full_disk_is_told_when_the_motion_is_over_and_what_was_acted_is_kept(loop, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    ask(loop, plan(PlanItem(task="crouch", takes=1, seconds=2.0), preview=False))
    ask(loop, c.SetMode(mode="collect"))
    ask(loop, c.CollectAction(action="go"))
    until(loop, "record")
    run(loop, 1.0)
    with monkeypatch.context() as patch:
        patch.setattr(TapeWriter, "write", full)
        until(loop, "review")
    collect = loop.state_dict()["collect"]
    assert "No space left" in collect["why"]
    assert loop.state_dict()["recording_error"] == collect["why"]
    loop.runtime.close()
    assert len(SessionLibrary(loop.config.sessions).read(collect["take"])) >= 30


@pytest.mark.slow
def test_a_take_knows_its_session_operator_and_calibration(loop):
    ask(loop, plan(PlanItem(task="crouch", takes=1, seconds=2.0), preview=False))
    ask(loop, c.SetMode(mode="collect"))
    ask(loop, c.CollectAction(action="go"))
    until(loop, "review")
    name = ask(loop, c.CollectAction(action="keep")).data["take"]
    loop.runtime.close()
    (session,) = SessionBook(loop.config.sessions).list()
    assert session.operator == "Ada"
    assert session.notes == "first day"
    assert session.takes == [name]
    assert session.calibration is not None
    assert len(session.calibration["bone_length"]) == 18
    about = json.loads((loop.config.sessions / name / "meta.json").read_text())["about"]
    assert about["collect"]["session"] == session.name
    assert about["collect"]["task"] == "crouch"
    assert about["calibration"]["leg_length"] == pytest.approx(0.85, abs=0.2)


@pytest.mark.slow
def test_redo_rejects_a_take_and_records_the_same_motion_again(loop):
    ask(loop, plan(PlanItem(task="crouch", takes=1, seconds=2.0), preview=False))
    ask(loop, c.SetMode(mode="collect"))
    ask(loop, c.CollectAction(action="go"))
    until(loop, "review")
    first = ask(loop, c.CollectAction(action="redo")).data
    assert first["keep"] is False
    until(loop, "review")
    second = ask(loop, c.CollectAction(action="keep")).data
    loop.runtime.close()
    kept = {info.name: info.kept for info in SessionLibrary(loop.config.sessions).list()}
    assert kept == {first["take"]: False, second["take"]: True}


@pytest.mark.slow
def test_what_is_shown_does_not_jump_when_the_robot_has_to_hold(loop):
    ask(loop, plan(PlanItem(task="walk", takes=1, seconds=4.0), preview=False))
    ask(loop, c.SetMode(mode="collect"))
    ask(loop, c.CollectAction(action="go"))
    until(loop, "record")
    run(loop, 3.0)
    source = loop.runtime.source
    read, source.read = source.read, lambda t: None  # nobody is seen for a second
    run(loop, 1.0)
    assert not loop.runtime.puppeteer.state_machine.following
    source.read = read
    until(loop, "review")
    name = ask(loop, c.CollectAction(action="keep")).data["take"]
    poses = loop.runtime.collector.machine.slots[0].motion.poses
    loop.runtime.close()
    recorded = SessionLibrary(loop.config.sessions).read(name).arrays.reference["base_pos"]
    shown = np.array([pose.base_pos for pose in poses])
    assert np.ptp(shown[:, 0]) > 0.3
    steps = np.linalg.norm(np.diff(recorded, axis=0), axis=-1)
    assert steps == pytest.approx(np.linalg.norm(np.diff(shown, axis=0), axis=-1), abs=1e-5)


def test_an_emergency_stop_throws_the_running_take_away_and_says_so(loop):
    ask(loop, plan(PlanItem(task="tilt", takes=1, seconds=3.0), preview=False))
    ask(loop, c.SetMode(mode="collect"))
    ask(loop, c.CollectAction(action="go"))
    until(loop, "record")
    run(loop, 1.0)
    assert ask(loop, c.Stop()).ok
    assert phase(loop) == "ready"
    assert "thrown away" in loop.state_dict()["collect"]["why"]
    loop.runtime.close()
    (info,) = SessionLibrary(loop.config.sessions).list()
    assert info.kept is False


def test_leaving_collect_gives_the_source_back_and_lets_it_go_on(loop):
    run(loop, 2.0)
    before = loop.runtime.source
    assert ask(loop, c.SetMode(mode="collect")).ok
    assert loop.runtime.source is not before
    run(loop, 3.0)
    assert ask(loop, c.SetMode(mode="live")).ok
    assert loop.runtime.source is before
    frames = loop.state_dict()["counters"]["frames"]
    run(loop, 1.0)
    assert loop.state_dict()["counters"]["frames"] == frames + 30
    assert loop.state_dict()["why"] == ""


@pytest.mark.slow
def test_a_sitting_task_is_shown_sitting_and_acted_out_sitting(loop):
    ask(loop, plan(PlanItem(task="sit_tilt", takes=1, seconds=3.0), preview=False))
    ask(loop, c.SetMode(mode="collect"))
    ask(loop, c.CollectAction(action="go"))
    until(loop, "record")
    run(loop, 1.0)
    tick = loop.ticks.get()
    assert tick.state == "sit"
    assert tick.expert == "sit"
    until(loop, "review")


def test_what_cannot_be_done_in_collect_is_refused_with_words(loop):
    assert "choose mode collect first" in ask(loop, c.CollectAction(action="go")).why
    assert ask(loop, c.SetMode(mode="collect")).ok
    assert "first make a plan" in ask(loop, c.CollectAction(action="go")).why
    bad = ask(loop, plan(PlanItem(task="fly")))
    assert "unknown task" in bad.why
    assert "no mapper to go back to" in ask(loop, c.MapperBack()).why
    assert "unknown mapper" in ask(loop, c.SetMapper(name="nobody")).why
    assert "choose mode live" in ask(loop, c.StartTake()).why  # which nothing here would end


@pytest.fixture
def short(tmp_path):
    """A loop whose source, a file of a second and a half, ends while it is looked at."""
    source = OperatorSource("quiet", seed=1)
    poses = [pose for k in range(45) if (pose := source.read(k * DT))]
    clip = tmp_path / "1a2b3c4d_stand_still.bvh"
    write_bvh(clip, np.array([pose.joint_pos_w for pose in poses]), DT)
    config = RuntimeConfig(source=f"bvh:{clip}", sessions=tmp_path / "sessions")
    loop = LiveLoop(clock=FakeClock(), runtime=Runtime(config))
    yield loop
    loop.runtime.close()


def test_a_source_that_has_ended_is_not_recorded_and_it_is_said_what_to_do(short):
    run(short, 2.5)
    assert short.state_dict()["reason"] == "source_ended"
    assert "choose it again, or the synthetic person" in ask(short, c.StartTake()).why
    assert ask(short, plan(PlanItem(task="tilt", takes=1, seconds=3.0), preview=False)).ok
    assert ask(short, c.SetMode(mode="collect")).ok
    assert "choose it again" in ask(short, c.CollectAction(action="go")).why
    assert SessionLibrary(short.config.sessions).list() == []


def test_a_take_whose_person_ends_on_the_way_is_thrown_away_with_words(short):
    items = PlanItem(task="tilt", takes=1, seconds=3.0)
    assert ask(short, plan(items, preview=False, hands_free=True)).ok
    assert ask(short, c.SetMode(mode="collect")).ok
    run(short, 8.0)
    state = short.state_dict()
    assert phase(short) == "ready"
    assert state["recording"] is None
    assert "the source has ended" in state["collect"]["why"]
    assert ask(short, c.Transport(action="again")).ok
    run(short, 0.5)
    assert short.state_dict()["collect"]["why"] == ""  # somebody acts again


def test_another_source_while_collecting_is_refused_and_collecting_goes_on(loop):
    assert ask(loop, c.SetMode(mode="collect")).ok
    refused = ask(loop, c.SetSource(source="operator:quiet"))
    assert not refused.ok
    assert "choose mode live first" in refused.why
    assert refused.state["mode"] == "collect"
    assert ask(loop, c.SetMode(mode="live")).ok
    assert ask(loop, c.SetSource(source="operator:quiet")).ok


def test_the_clock_of_a_collected_take_starts_anew(loop):
    ask(loop, c.StartTake())
    run(loop, 3.0)
    assert ask(loop, c.StopTake()).ok
    ask(loop, plan(PlanItem(task="tilt", takes=1, seconds=3.0), preview=False))
    ask(loop, c.SetMode(mode="collect"))
    ask(loop, c.CollectAction(action="go"))
    until(loop, "record")
    assert loop.state_dict()["recording"]["ticks"] <= 2


@pytest.mark.parametrize(
    ("source", "said"),
    [
        (OperatorSource(), "operator tour"),
        (OperatorSource("sit_tilt"), "operator sit tilt"),
        (InteractiveOperator(), "keyboard"),
        (Impaired(InteractiveOperator(), IMPAIRMENTS["kinect"]), "keyboard"),
        (ClipSource(STILL, "bvh:/tmp/x/brisk_walk.bvh"), "bvh brisk walk"),
        (ClipSource(STILL, "frames:kinect.jsonl"), "frames kinect"),
        (StreamSource("webcam"), "webcam"),
    ],
)
def test_a_take_without_a_label_is_called_as_its_source_and_motion(source, said):
    assert source.label == said


def test_a_live_take_says_what_it_is_of(loop):
    assert ask(loop, c.StartTake()).data["name"].endswith("-operator-tour")
