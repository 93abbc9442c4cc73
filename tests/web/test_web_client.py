"""studio.client against the real gateway and the real loop; the programs of its page run."""

import asyncio
import inspect
import json
import re
import socket
import subprocess
import sys
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from studio.client import AsyncStudio, ClientError, Studio, messages
from studio.human.sensor_skeletons import SKELETONS
from studio.live import tick_message
from studio.live.commands import MODES
from studio.synthetic.operator import OperatorSource
from studio.takes.export.formats import FORMATS
from studio.takes.listing import TakeInfo
from studio.web import answers, answers_takes

TOKEN = "test-token-0123456789"
PAGE = Path(__file__).parents[2] / "docs" / "client.md"
PROGRAMS = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)


@pytest.fixture
def studio(studio_live):
    return Studio(f"{studio_live.base}/?token={TOKEN}")


@pytest.fixture
def aio(studio_live):
    return AsyncStudio(studio_live.base, TOKEN)


@pytest.fixture(scope="module")
def people():
    """A second of a quiet person."""
    source = OperatorSource("quiet", seed=3)
    return [source.read(k / 30.0) for k in range(30)]


def test_it_loads_the_standard_library_websockets_and_an_exception():
    """Other programs import it: nothing of the studio's weight comes along."""
    program = (
        "import sys, json, websockets.asyncio.client\n"
        "before = set(sys.modules)\n"
        "import studio.client\n"
        "print(json.dumps(sorted(set(sys.modules) - before)))"
    )
    out = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True).stdout
    ours = {"studio", "studio.errors"}
    for name in json.loads(out):
        top = name.partition(".")[0]
        known = top in sys.stdlib_module_names or top == "websockets" or name in ours
        assert known or name.startswith("studio.client"), name


def test_what_it_promises_is_what_is_sent():
    sent = {
        messages.Frame: tick_message.Human,
        messages.Pose: tick_message.Pose,
        messages.SimulatedPose: tick_message.SimulatedPose,
        messages.Tick: tick_message.TickMessage,
        messages.State: answers.State,
        messages.Take: TakeInfo,
        messages.StoppedTake: answers_takes.Stopped,
    }
    for promised, given in sent.items():
        assert promised.__annotations__.keys() <= inspect.get_annotations(given).keys()
    contract = Path(__file__).parents[2] / "docs" / "contract.md"
    (row,) = re.findall(r"^\| `GET /api/state` \| (.*) \|$", contract.read_text(), re.MULTILINE)
    assert set(re.findall(r"`(\w+)`", row)) == messages.State.__annotations__.keys()
    assert get_args(messages.Mode) == MODES
    assert set(get_args(messages.Format)) == FORMATS.keys()
    assert set(get_args(messages.Skeleton)) == SKELETONS.keys()


def test_both_clients_have_the_same_calls():
    def calls(kind):
        return {name for name in vars(kind) if not name.startswith("_")}

    assert calls(Studio) == calls(AsyncStudio)


def test_frames_go_in_and_ticks_come_out(studio, people):
    studio.set_source("stream")
    before = studio.arm()["counters"]["frames"]
    with studio.ticks() as ticks, studio.frames() as frames:
        for k, pose in enumerate(people):
            assert frames.send(k / 30.0, "studio", pose.joint_pos_w, pose.confidence) == []
            ticks.next(timeout=10.0)
        assert frames.errors(timeout=0.2) == []
        seen = next(tick["human"] for tick in ticks if tick["human"] is not None)
    state = studio.state()
    assert (state["mode"], state["armed"]) == ("live", True)
    assert state["counters"]["frames"] > before
    assert seen["skeleton"] == "studio"
    near = [np.abs(seen["positions"] - pose.joint_pos_w).max() for pose in people]
    assert min(near) < 1e-3  # ticks are rounded to 0.1 mm
    echo = {**seen}["echo"]
    assert echo["sent"] in [k / 30.0 for k in range(len(people))]  # to the last bit
    assert echo["waited_ms"] >= 0.0


def test_a_frame_that_does_not_fit_is_told_and_counted(studio, people):
    studio.set_source("stream")
    before = studio.state()["counters"]["rejected"]
    with studio.frames() as frames:
        frames.send(0.0, "studio", people[0].joint_pos_w[:4])
        (error,) = frames.errors(timeout=10.0)
        assert "19 joints" in error
        frames.send(0.0, "studio", [None] * 19)
        assert "no joint has a place" in frames.errors(timeout=10.0)[0]
        assert frames.refused == 2
        some = [None, *people[0].joint_pos_w[1:]]
        assert frames.send(0.0, "studio", some) == []
        assert frames.errors(timeout=0.2) == []
    assert studio.state()["counters"]["rejected"] == before + 2


def test_frames_for_another_source_are_told_which_to_set(studio, people):
    with studio.frames() as frames:
        frames.send(0.0, "studio", people[0].joint_pos_w)
        assert "set the source to stream" in frames.errors(timeout=10.0)[0]


def test_a_stop_latches_until_reset_and_armed(studio):
    assert studio.stop()["stopped"]
    with pytest.raises(ClientError, match="reset") as refused:
        studio.arm()
    assert refused.value.status == 409
    assert studio.reset()["stopped"]
    assert not studio.arm()["stopped"]


def test_modes_and_locks_answer_with_the_state(studio):
    assert studio.set_mode("idle")["mode"] == "idle"
    assert studio.set_mode("live")["mode"] == "live"
    assert studio.lock_state("sit")["state_lock"] == "sit"
    assert studio.lock_state("auto")["state_lock"] == "auto"
    assert studio.set_scene("empty")["scene"] == "empty"


def test_a_take_is_recorded_edited_exported_and_deleted(studio, tmp_path):
    name = studio.start_take("by a program")
    with studio.ticks() as ticks:
        for _ in range(20):
            ticks.next(timeout=10.0)
    stopped = studio.stop_take()
    assert stopped["name"] == name
    assert stopped["ticks"] > 10
    assert name in [take["name"] for take in studio.takes()]
    edited = studio.edit_take(name, label="kept", keep=True, trim=(0.1, 0.4))
    assert (edited["label"], edited["kept"], edited["trim"]) == ("kept", True, [0.1, 0.4])
    assert studio.undo_take(name)["trim"] is None
    with np.load(studio.export_take(name, "npz", tmp_path / "take.npz")) as arrays:
        assert len(arrays["t"]) > 10
    with pytest.raises(ClientError, match="npz"):
        studio.export_take(name, "gif", tmp_path / "take.gif")  # type: ignore[arg-type]
    assert [path.name for path in tmp_path.iterdir()] == ["take.npz"]
    studio.delete_take(name)
    with pytest.raises(ClientError, match=name) as gone:
        studio.take(name)
    assert gone.value.status == 404


def test_the_same_on_asyncio(aio, people):
    async def drive():
        await aio.set_source("stream")
        await aio.arm()
        async with aio.frames() as frames, aio.ticks() as ticks:
            for k, pose in enumerate(people):
                assert await frames.send(k / 30.0, "studio", pose.joint_pos_w) == []
                await ticks.next(timeout=10.0)
            await frames.send(9.0, "shadow", pose.joint_pos_w)
            (error,) = await frames.errors(timeout=10.0)
            async for tick in ticks:
                if tick["human"] is not None:
                    break
        name = await aio.start_take()
        await asyncio.sleep(0.1)
        assert (await aio.stop_take())["name"] == name
        await aio.stop()
        with pytest.raises(ClientError, match="reset"):
            await aio.arm()
        return error, await aio.state()

    error, state = asyncio.run(drive())
    assert "known: k4abt" in error
    assert state["stopped"]


@pytest.mark.parametrize("url", ["", "127.0.0.1:8080", "ftp://h/?token=x", "http://h:99999999/"])
def test_a_url_that_is_none_is_told_what_one_is(url):
    with pytest.raises(ClientError, match="which serve prints"):
        Studio(url)


def test_the_wrong_token_is_refused_everywhere(studio_at):
    stranger = Studio(studio_at.base, "wrong")
    for knock in (stranger.state, stranger.ticks, stranger.frames):
        with pytest.raises(ClientError, match="token") as refused:
            knock()
        assert refused.value.status == 401

    async def knock_too():
        async with AsyncStudio(studio_at.base, "wrong").ticks():
            pass

    with pytest.raises(ClientError, match="token"):
        asyncio.run(knock_too())


def test_where_nobody_serves_it_says_what_to_start():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        nobody = Studio(f"http://127.0.0.1:{free.getsockname()[1]}/?token=x")
        for knock in (nobody.state, nobody.ticks):
            with pytest.raises(ClientError, match="a1-studio serve") as alone:
                knock()
            assert alone.value.status == 0


@pytest.mark.parametrize(
    ("program", "said"),
    list(zip(PROGRAMS, ["'frames'", "unknown state 'fly'", "32 joints"], strict=True)),
)
def test_every_program_of_the_page_runs(studio_live, program, said):
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program, f"{studio_live.base}/?token={TOKEN}"],
        capture_output=True,
        text=True,
        timeout=120.0,
    )
    assert done.returncode == 0, done.stderr
    assert said in done.stdout


def test_the_plain_program_raises_the_paw_and_is_about_30_lines(studio, tmp_path):
    program = PROGRAMS[0]
    assert len([line for line in program.splitlines() if line.strip()]) <= 32
    url = f"http://{studio.address.host}:{studio.address.port}/?token={TOKEN}"
    running = subprocess.Popen([sys.executable, "-c", program, url], stdout=subprocess.DEVNULL)
    with studio.ticks() as ticks:
        paws = []
        for tick in ticks:
            paws.append([foot[2] for foot in tick["robot"]["foot_pos_w"]])
            if running.poll() is not None:
                break
    assert running.returncode == 0
    right, left = np.max(paws, axis=0)[:2]
    assert right > 0.12 > left  # m; the aim for full arm raises of real people
