"""A killed or damaged take becomes one that strict readers open; what it was lies in the bin."""

import subprocess
import sys
from pathlib import Path

import pytest
from make_ticks import make_ticks
from mcap.exceptions import McapError
from mcap.reader import make_reader

from studio.errors import StudioError
from studio.takes import commands
from studio.takes.record.codec import SCHEMAS
from studio.takes.record.recorder import Recorder
from studio.takes.session_library import SessionLibrary
from studio.takes.take import read_take

WRITER = Path(__file__).with_name("write_until_killed.py")


def strictly(tape: Path) -> dict[str, int]:
    """Messages per topic by mcap's own reader, which wants the footer; its chunks' sums checked."""
    with tape.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.chunk_indexes
        counts: dict[str, int] = dict.fromkeys((f"/{name}" for name in SCHEMAS), 0)
        for _, channel, message in reader.iter_messages():
            counts[channel.topic] += 1
            assert message.log_time == message.publish_time
    return counts


def test_a_killed_take_is_made_whole(tmp_path: Path):
    command = [sys.executable, str(WRITER), str(tmp_path), "killed"]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        for _ in range(20):
            process.stdout.readline()
        with pytest.raises(StudioError, match="being recorded"):
            commands.repair_take(tmp_path, "killed")
        process.kill()
        process.stdout.read()
    tape = tmp_path / "killed" / "tape.mcap"
    with tape.open("ab") as file:
        file.write(b"\x05\xff")  # torn in the middle of a record
    with pytest.raises(McapError):
        strictly(tape)
    before = read_take(tmp_path / "killed")
    answer = commands.repair_take(tmp_path, "killed")
    assert answer["repaired"]
    assert answer["ticks"] == len(before)
    counts = strictly(tape)
    assert counts["/tick"] == counts["/robot"] == counts["/reference"] == len(before)
    after = read_take(tmp_path / "killed")
    assert (after.complete, after.problems) == (True, ())
    (info,) = SessionLibrary(tmp_path).list()
    assert (info.complete, info.recovered, info.damaged) == (True, False, "")
    assert commands.repair_take(tmp_path, "killed")["repaired"] is False
    assert SessionLibrary(tmp_path).deleted() == ["killed"]
    assert len(read_take(Path(answer["bin"]))) == len(before)


def test_a_take_without_meta_json_or_with_a_hole_is_saved_up_to_it(tmp_path: Path):
    recorder = Recorder(tmp_path)
    for name in ("lost", "hole"):
        recorder.start("waving", name=name)
        for tick in make_ticks(200):
            recorder.append(tick)
        recorder.stop()
    recorder.close()
    (tmp_path / "lost" / "meta.json").unlink()
    assert commands.repair_take(tmp_path, "lost")["ticks"] == 200
    assert read_take(tmp_path / "lost").problems == ()
    tape = tmp_path / "hole" / "tape.mcap"
    data = bytearray(tape.read_bytes())
    data[len(data) // 2] ^= 0xFF
    tape.write_bytes(data)
    answer = commands.repair_take(tmp_path, "hole")
    assert 0 < answer["ticks"] < 200
    assert answer["lost"]
    assert strictly(tape)["/tick"] == answer["ticks"]
    assert read_take(tmp_path / "hole").label == "waving"


def test_what_cannot_be_saved_says_so_and_stays(tmp_path: Path):
    (tmp_path / "none").mkdir()
    (tmp_path / "none" / "tape.mcap").write_bytes(b"\x89MCAP0\r\n")
    with pytest.raises(StudioError, match="no whole tick"):
        commands.repair_take(tmp_path, "none")
    assert (tmp_path / "none" / "tape.mcap").read_bytes() == b"\x89MCAP0\r\n"
