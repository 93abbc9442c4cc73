"""Takes: what goes in comes out, whatever happens to the process, the disk or the file."""

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from make_ticks import make_ticks
from mcap.exceptions import EndOfFile
from mcap.reader import make_reader
from mcap.records import Message as McapMessage
from mcap.stream_reader import StreamReader

from studio.errors import StudioError
from studio.takes.record import recorder as recorder_module
from studio.takes.record.codec import SCHEMAS
from studio.takes.record.recorder import Recorder
from studio.takes.session_library import SessionLibrary
from studio.takes.take import iter_ticks, read_take

WRITER = Path(__file__).with_name("write_until_killed.py")


def record(root: Path, count: int = 60, label: str = "test", **kwargs: int) -> Path:
    recorder = Recorder(root)
    name = recorder.start(label)
    for tick in make_ticks(count, **kwargs):
        recorder.append(tick)
    recorder.close()
    return root / name


def assert_same_tick(a, b) -> None:
    for key in ("index", "expert", "state", "transition_to", "mode", "controller", "clipped"):
        assert getattr(a, key) == getattr(b, key)
    assert a.t == b.t
    assert a.votes == b.votes
    assert a.counters == b.counters
    compared = {
        "reference": ("base_pos", "base_quat", "joint_pos", "joint_vel", "foot_contact"),
        "robot": ("joint_pos", "foot_pos_w", "torque", "base_lin_vel_w"),
    }
    for part, keys in compared.items():
        for key in keys:
            ours, theirs = getattr(getattr(a, part), key), getattr(getattr(b, part), key)
            np.testing.assert_allclose(ours, theirs, atol=6e-7)
    np.testing.assert_allclose(a.target, b.target, atol=6e-7)
    np.testing.assert_allclose(a.human.joint_pos_w, b.human.joint_pos_w, atol=6e-7)
    np.testing.assert_allclose(a.human.confidence, b.human.confidence, atol=6e-7)


def test_a_take_comes_back_as_it_went_in(tmp_path: Path):
    ticks = list(make_ticks(60, human_every=2))
    take = read_take(record(tmp_path, human_every=2))
    assert len(take) == 60
    assert (take.complete, take.recovered, take.problems) == (True, False, ())
    for ours, theirs in zip(take.ticks, ticks):
        assert_same_tick(ours, theirs)
    assert take.human is not None
    assert len(take.human) == 30  # the human's own rate: every second tick
    np.testing.assert_array_equal(take.human_tick, np.arange(0, 60, 2))
    np.testing.assert_allclose(take.human.t, np.arange(30) * 2 / 30, atol=1e-6)
    assert take.seconds == pytest.approx(2.0)
    assert take.meta["label"] == "test"
    arrays = take.arrays
    assert arrays.robot["foot_pos_w"].shape == (60, 4, 3)
    np.testing.assert_array_equal(arrays.human_index, np.arange(60) // 2)


def test_ticks_can_be_read_one_at_a_time(tmp_path: Path):
    folder = record(tmp_path, 20)
    assert [tick.index for tick in iter_ticks(folder)] == list(range(20))


def test_other_programs_read_the_tape_running_and_stopped(tmp_path: Path):
    recorder = Recorder(tmp_path)
    tape = tmp_path / recorder.start("live") / "tape.mcap"
    for tick in make_ticks(10):
        recorder.append(tick)
    with tape.open("rb") as file:  # unfinished: as far as it goes
        read = StreamReader(file).records
        rows = [type(next(read)) for _ in range(1 + 2 * len(SCHEMAS) + 40)]
        with pytest.raises(EndOfFile):
            next(read)
    assert rows.count(McapMessage) == 40
    recorder.close()
    with tape.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert {c.topic for c in summary.channels.values()} == {f"/{name}" for name in SCHEMAS}
        assert summary.statistics.message_count == 40
        assert len(summary.chunk_indexes) >= 1
        human = [m for _, c, m in reader.iter_messages(topics=["/human"])]
    assert human[1].publish_time - human[0].publish_time == pytest.approx(1e9 / 30, abs=2)
    # One clock for all streams: a viewer lays them on one timeline.
    assert all(m.publish_time == m.log_time for m in human)


def test_names_are_unique_and_carry_the_label(tmp_path: Path):
    recorder = Recorder(tmp_path)
    names = []
    for _ in range(3):
        names.append(recorder.start("tilt & walk / ../x"))
        recorder.stop()
    recorder.close()
    assert len(set(names)) == 3
    assert all(name.isascii() and "/" not in name and "tilt" in name for name in names)


def test_a_chosen_name_that_is_taken_or_unfit_is_refused(tmp_path: Path):
    recorder = Recorder(tmp_path)
    recorder.start(name="mine")
    recorder.close()
    with pytest.raises(StudioError, match="exists"):
        recorder.start(name="mine")
    for name in ("../up", "a/b", "", ".", "x" * 200, "nul\0", "ü", "a\n"):
        with pytest.raises(StudioError, match="letters"):
            recorder.start(name=name)
    recorder.close()
    assert sorted(p.name for p in tmp_path.iterdir() if not p.name.startswith(".")) == ["mine"]


def test_start_stop_and_append_out_of_turn_say_so(tmp_path: Path):
    recorder = Recorder(tmp_path)
    with pytest.raises(StudioError, match="start one"):
        recorder.append(next(make_ticks(1)))
    with pytest.raises(StudioError, match="start one"):
        recorder.stop()
    recorder.start("one")
    with pytest.raises(StudioError, match="stop it first"):
        recorder.start("two")
    recorder.close()
    recorder.close()


def test_two_studios_do_not_record_into_one_folder(tmp_path: Path):
    first, second = Recorder(tmp_path), Recorder(tmp_path)
    first.start("a")
    with pytest.raises(StudioError, match="another studio"):
        second.start("b")
    first.append(next(make_ticks(1)))
    first.close()
    assert second.start("b")
    second.close()


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path):
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    with pytest.raises(StudioError, match="--sessions"):
        Recorder(blocked / "inside").start("x")
    if os.geteuid() != 0:  # root writes anywhere
        locked = tmp_path / "locked"
        locked.mkdir(mode=0o500)
        with pytest.raises(StudioError, match="--sessions"):
            Recorder(locked).start("x")


def test_a_full_disk_ends_the_take_and_keeps_what_was_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    recorder = Recorder(tmp_path)
    name = recorder.start("full")
    for tick in make_ticks(10):
        recorder.append(tick)
    real = os.write
    room = [2500]  # bytes left: the disk fills up within a message

    def full(handle: int, data: bytes) -> int:
        if room[0] <= 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written = real(handle, bytes(data)[: room[0]])
        room[0] -= written
        return written

    monkeypatch.setattr(recorder_module.os, "write", full)

    def go_on() -> None:
        for tick in make_ticks(10):
            recorder.append(tick)

    with pytest.raises(StudioError, match=r"No space left.*keeps its first"):
        go_on()
    monkeypatch.undo()
    assert recorder.recording is None
    take = read_take(tmp_path / name)
    assert len(take) >= 10
    assert take.recovered
    recorder.start("again")  # the studio goes on
    recorder.close()


def test_real_disk_limits_are_survived_in_a_process_of_its_own(tmp_path: Path):
    """A file size limit set by the kernel stands for a full disk: EFBIG in the middle of a row."""
    code = (
        "import resource, signal, sys\n"
        f"sys.path.insert(0, {str(WRITER.parent)!r})\n"
        "from pathlib import Path\n"
        "from make_ticks import make_ticks\n"
        "from studio.errors import StudioError\n"
        "from studio.takes.record.recorder import Recorder\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (60000, 60000))\n"
        f"r = Recorder(Path({str(tmp_path)!r})); r.start(name='limited')\n"
        "try:\n"
        "    for tick in make_ticks(1000): r.append(tick)\n"
        "except StudioError as e: print(e)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "too large" in done.stdout
    kept = int(done.stdout.split("first ")[1].split()[0])
    take = read_take(tmp_path / "limited")
    assert len(take) == kept > 5


@pytest.mark.parametrize("kills", [3, pytest.param(50, marks=[pytest.mark.slow, pytest.mark.long])])
def test_a_sigkill_at_any_instant_loses_no_flushed_row(tmp_path: Path, kills: int):
    rng = np.random.default_rng(kills)
    for i in range(kills):
        command = [sys.executable, str(WRITER), str(tmp_path), f"take-{i}"]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
            assert process.stdout is not None
            process.stdout.readline()  # it is recording
            time.sleep(rng.uniform(0.0, 0.15))
            process.send_signal(signal.SIGKILL)
            flushed = process.stdout.read().split(b"\n")
        acknowledged = [int(line) for line in flushed[:-1] if line]
        take = read_take(tmp_path / f"take-{i}")
        # Every row whose append returned (and was printed) is there; at most one more.
        least = acknowledged[-1] + 1 if acknowledged else 0
        assert least <= len(take)
        for ours, theirs in zip(take.ticks, make_ticks(len(take))):
            assert_same_tick(ours, theirs)


@pytest.mark.parametrize("stopped", [True, False])
def test_a_tape_cut_anywhere_gives_its_whole_ticks_or_a_clear_error(tmp_path: Path, stopped: bool):
    recorder = Recorder(tmp_path)
    folder = tmp_path / recorder.start("cut")
    for tick in make_ticks(8):
        recorder.append(tick)
    if stopped:
        recorder.close()
    whole = (folder / "tape.mcap").read_bytes()
    recorder.close()
    copy = tmp_path / "copy"
    copy.mkdir()
    (copy / "meta.json").write_bytes((folder / "meta.json").read_bytes())
    last = 0
    for size in np.unique(np.linspace(0, len(whole) - 1, 120).astype(int)):
        (copy / "tape.mcap").write_bytes(whole[:size])
        take = read_take(copy)
        assert len(take) >= last  # more bytes, never fewer ticks
        last = len(take)
        assert take.problems or take.complete
    assert last >= 7
    (copy / "tape.mcap").write_bytes(whole)
    assert len(read_take(copy)) == 8


@pytest.mark.parametrize("stopped", [True, False])
def test_damaged_tapes_give_clear_errors_and_never_nonsense(tmp_path: Path, stopped: bool):
    recorder = Recorder(tmp_path)
    folder = tmp_path / recorder.start("fuzz")
    for tick in make_ticks(8):
        recorder.append(tick)
    tape = folder / "tape.mcap"
    if stopped:
        recorder.close()
    whole = tape.read_bytes()
    recorder.close()
    rng = np.random.default_rng(0)
    for _ in range(150):
        data = bytearray(whole)
        for at in rng.integers(0, len(data), rng.integers(1, 8)):
            data[at] = rng.integers(0, 256)
        tape.write_bytes(data)
        try:
            take = read_take(folder)
        except StudioError:
            continue
        assert len(take) <= 8
        for tick in take.ticks:
            assert np.isfinite(tick.robot.joint_pos).all()
            assert tick.target.shape == (12,)


def test_what_is_no_take_is_refused(tmp_path: Path):
    with pytest.raises(StudioError, match="no take"):
        read_take(tmp_path / "nothing")
    folder = record(tmp_path, 3)
    (folder / "tape.mcap").write_bytes(b"RIFF something else")
    with pytest.raises(StudioError, match="no tape"):
        read_take(folder)
    (folder / "tape.mcap").unlink()
    with pytest.raises(StudioError, match="cannot read"):
        read_take(folder)


def test_a_take_of_another_major_version_says_what_to_do(tmp_path: Path):
    folder = record(tmp_path, 3)
    meta = (folder / "meta.json").read_text()
    (folder / "meta.json").write_text(meta.replace('"format_version": 1', '"format_version": 2'))
    with pytest.raises(StudioError, match=r"format 2.*recorded with"):
        read_take(folder)


def test_a_damaged_meta_json_costs_only_itself(tmp_path: Path):
    folder = record(tmp_path, 3)
    (folder / "meta.json").write_text("{")
    take = read_take(folder)
    assert len(take) == 3
    assert take.problems == ("meta.json is damaged",)
    row = SessionLibrary(tmp_path).verify(folder.name)[0]
    assert row["readable"]
    assert row["complete"]


def test_a_finished_tape_cut_in_two_gives_most_of_its_first_half_back(tmp_path: Path):
    folder = record(tmp_path, 180)
    tape = folder / "tape.mcap"
    tape.write_bytes(tape.read_bytes()[: tape.stat().st_size // 2])
    take = read_take(folder)
    assert take.recovered
    assert len(take) > 45  # a chunk holds about a second; one of 1 MiB held all six
