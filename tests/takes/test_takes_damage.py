"""A damaged take is read as far as it goes, listed with its reason, and hurts nobody else."""

import os
import shutil
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import zstandard
from make_ticks import make_ticks

from studio.errors import StudioError
from studio.live.mappers import list_mappers, open_mapper
from studio.mocap.take_source import TakeSource
from studio.takes import commands
from studio.takes.as_json import tick_json
from studio.takes.columns import columns
from studio.takes.dataset import datasets
from studio.takes.dataset.datamap import DataMap
from studio.takes.edit import edited, edits, review
from studio.takes.export import archive
from studio.takes.export.formats import FORMATS
from studio.takes.record import tape
from studio.takes.record.codec import SCHEMAS
from studio.takes.record.recorder import Recorder
from studio.takes.record.tape import Message, TapeScan, TapeWriter, scan
from studio.takes.session_library import SessionLibrary
from studio.takes.take import read_take, survey_take

DEEP = b"[" * 100_000 + b"]" * 100_000


@pytest.fixture
def sessions(tmp_path: Path) -> Path:
    """Two takes of 40 ticks: what is done to "bad" must not reach "good"."""
    recorder = Recorder(tmp_path)
    for name in ("bad", "good"):
        recorder.start(name, name=name, about={"source": "operator"})
        for tick in make_ticks(40):
            recorder.append(tick)
        recorder.stop()
    recorder.close()
    return tmp_path


def rewritten(folder: Path, change: Callable[[Message], bytes]) -> None:
    """The take's tape with other data in its messages."""
    path = folder / "tape.mcap"
    messages = list(scan(path, TapeScan()))
    with path.open("wb") as file:
        writer = TapeWriter(file, SCHEMAS, chunked=True)
        for message in messages:
            data = change(message)
            writer.write(Message(topic=message.topic, sequence=message.sequence, time=0, data=data))
        writer.finish()


def with_value(topic: str, key: str, raw: bytes) -> Callable[[Message], bytes]:
    """From tick 25 on, a field of a stream holds the JSON `raw`."""

    def change(message: Message) -> bytes:
        if message.topic != topic or message.sequence < 25:
            return message.data
        row = msgspec.json.decode(message.data, type=dict[str, Any])
        return msgspec.json.encode(row | {key: msgspec.Raw(raw)})

    return change


def good_lives(sessions: Path) -> None:
    infos = {info.name: info for info in SessionLibrary(sessions).list()}
    assert set(infos) == {"bad", "good"}
    assert (infos["good"].ticks, infos["good"].damaged) == (40, "")
    assert len(read_take(sessions / "good")) == 40
    DataMap(sessions).as_dict()
    assert len(commands.list_takes(sessions)["takes"]) == 2


@pytest.mark.parametrize(
    ("topic", "key", "raw"),
    [
        ("tick", "state", b"[1,2]"),
        ("tick", "expert", b'{"a":1}'),
        ("tick", "t", b'"noon"'),
        ("tick", "t", b"1e300"),
        ("tick", "index", b"-3"),
        ("tick", "index", b"1" + b"0" * 400),
        ("tick", "votes", b'{"walk":"yes"}'),
        ("tick", "counters", b"[]"),
        ("tick", "timings_ms", b'{"physics":{}}'),
        ("tick", "human_fresh", b"2"),
        ("tick", "state", b'"' + b"x" * 10_000 + b'"'),
        ("tick", "target", b"[1,2,3]"),
        ("robot", "base_quat", b"[0,0,0,0]"),
        ("robot", "joint_pos", b"[" + b"1e200," * 11 + b"0]"),
        ("reference", "base_pos", b"[true,0,0]"),
        ("human", "positions", b"[[0,0,0]]"),
        ("human", "t", b"null"),
        ("human", "t", DEEP),
    ],
)
def test_what_no_tick_could_hold_ends_the_take_there_with_its_reason(
    sessions: Path, topic: str, key: str, raw: bytes
):
    rewritten(sessions / "bad", with_value(topic, key, raw))
    take = read_take(sessions / "bad")
    assert len(take) == 25
    assert take.recovered
    assert any("tick 25 is damaged" in problem for problem in take.problems)
    for tick in take.ticks:
        tick_json(tick)  # the live feed sends what a replay shows
    good_lives(sessions)


def test_a_damaged_tape_is_listed_with_its_reason_once_it_was_looked_into(sessions: Path):
    library = SessionLibrary(sessions)
    assert [info.damaged for info in library.list()] == ["", ""]
    rewritten(sessions / "bad", with_value("robot", "base_pos", b"{}"))
    table = columns(sessions / "bad")
    assert len(table) == 25
    bad, good = library.list()
    assert "tick 25 is damaged" in bad.damaged
    assert (bad.complete, good.damaged, good.complete) == (False, "", True)
    good_lives(sessions)


@pytest.mark.parametrize(
    "log", [b'{"set": ' + DEEP + b"}", DEEP, b'{"found": {"score": 1' + b"0" * 400 + b"}}"]
)
def test_a_deep_line_of_edits_is_left_out_and_named(sessions: Path, log: bytes):
    (sessions / "bad" / edits.EDITS).write_bytes(b'{"set": {"label": "kept"}}\n' + log + b"\n")
    known = edits.read_edits(sessions / "bad")
    assert known.edits.label == "kept"
    assert "line 2" in known.problems[0]
    good_lives(sessions)


def test_a_huge_log_of_edits_is_left_out_and_nothing_is_added_to_it(sessions: Path):
    with (sessions / "bad" / edits.EDITS).open("wb") as file:
        file.truncate(200 << 20)
    os.utime(sessions / "bad")
    bad, _ = SessionLibrary(sessions).list()
    assert "at most" in bad.damaged
    with pytest.raises(StudioError, match="move it away"):
        edits.edit(sessions / "bad", label="x")
    good_lives(sessions)


def test_a_log_that_no_edit_fits_into_says_so_and_keeps_what_it_has(sessions: Path):
    line = msgspec.json.encode({"set": {"note": "n" * 9000}}) + b"\n"
    (sessions / "bad" / edits.EDITS).write_bytes(line * (edits.MOST_EDITS // len(line)))
    with pytest.raises(StudioError, match="full"):
        edits.edit(sessions / "bad", note="n" * 9990)
    assert edits.read_edits(sessions / "bad").readable


def test_many_damaged_lines_are_told_of_in_a_few(sessions: Path):
    (sessions / "bad" / edits.EDITS).write_bytes(b"{}\n" * 100_000)
    assert len(edits.read_edits(sessions / "bad").problems) < 20


@pytest.mark.parametrize("name", ["edits.jsonl", "meta.json"])
def test_a_pipe_in_a_files_place_keeps_nobody_waiting(sessions: Path, name: str):
    (sessions / "bad" / name).unlink(missing_ok=True)
    os.mkfifo(sessions / "bad" / name)
    os.utime(sessions / "bad")
    good_lives(sessions)
    assert len(read_take(sessions / "bad")) == 40


@pytest.mark.parametrize("known", [True, False])
def test_a_pipe_in_a_tapes_place_keeps_nobody_waiting(sessions: Path, known: bool):
    (sessions / "bad" / "tape.mcap").unlink()
    os.mkfifo(sessions / "bad" / "tape.mcap")
    if not known:
        (sessions / "bad" / "meta.json").unlink()
        bad, _ = SessionLibrary(sessions).list()
        assert "no regular file" in bad.damaged
    good_lives(sessions)
    for read in (read_take, survey_take):
        with pytest.raises(StudioError, match=r"cannot read tape\.mcap: it is no regular file"):
            read(sessions / "bad")


@pytest.mark.parametrize(
    "meta",
    [
        DEEP,
        b'{"format_version": 1, "about": ' + DEEP + b"}",
        b'{"format_version": 1, "about": {"collect": [1]}}',
        b'{"format_version": 1, "about": {"style": {}}}',
        b'{"format_version": 1, "ticks": -5}',
        b'{"format_version": 1, "seconds": "three"}',
        b'{"format_version": 1, "label": ["a"]}',
        b"[]",
    ],
)
def test_a_damaged_meta_json_costs_what_it_says_and_no_tick(sessions: Path, meta: bytes):
    (sessions / "bad" / "meta.json").write_bytes(meta)
    os.utime(sessions / "bad")
    bad, _ = SessionLibrary(sessions).list()
    assert bad.ticks == 40
    assert any("meta.json" in problem for problem in bad.problems)
    review.review(SessionLibrary(sessions), "bad")
    good_lives(sessions)


def empty(root: Path, name: str) -> None:
    """A take that was stopped before its first tick."""
    recorder = Recorder(root)
    recorder.start(name=name)
    recorder.close()


@pytest.mark.parametrize("format", sorted(FORMATS))
def test_an_empty_take_is_refused_by_every_export_in_one_line(tmp_path: Path, format: str):
    empty(tmp_path, "empty")
    if format in ("npz", "csv"):
        return  # a table may have no row
    with pytest.raises(StudioError, match=r"no tick|no human motion"):
        commands.export_take(tmp_path, "empty", format, tmp_path / "out")
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())


def test_an_empty_take_hurts_neither_review_nor_map_nor_training(tmp_path: Path):
    empty(tmp_path, "empty")
    for ask in (
        lambda: edited.open_table(tmp_path, "empty"),
        lambda: review.review(SessionLibrary(tmp_path), "empty"),
        lambda: commands.align_take(tmp_path, "empty"),
        lambda: commands.clean_take(tmp_path, "empty"),
        lambda: commands.split_take(tmp_path, "empty", 1.0),
        lambda: commands.dataset_takes(tmp_path, ("empty",)),
        lambda: TakeSource("empty", tmp_path),
    ):
        with pytest.raises(StudioError):
            ask()
    DataMap(tmp_path).as_dict()
    assert commands.show_take(tmp_path, "empty")["ticks"] == 0


@pytest.mark.parametrize(
    ("seconds", "changes", "why"),
    [
        (0.9, {}, "no state was held for 30 ticks"),
        (4.0, {"keep": False}, "rejected"),
        (4.0, {"trim": (0.0, 0.3)}, "all is cut"),
    ],
)
def test_a_take_without_pairs_says_why(
    tmp_path: Path, seconds: float, changes: dict[str, Any], why: str
):
    recorder = Recorder(tmp_path)
    recorder.start(name="short", about={"collect": {"state": "walk"}})
    for tick in make_ticks(round(seconds * 30)):
        recorder.append(tick)
    recorder.close()
    if changes:
        edits.edit(tmp_path / "short", **changes)
    with pytest.raises(StudioError, match=why):
        commands.export_take(tmp_path, "short", "pairs", tmp_path)
    with pytest.raises(StudioError, match=why):
        commands.dataset_takes(tmp_path, ("short",))


def _record(opcode: int, data: bytes) -> bytes:
    return struct.pack("<BQ", opcode, len(data)) + data


def _chunk(plain: bytes, size: int | None = None) -> bytes:
    packed = zstandard.ZstdCompressor().compress(plain)
    size = len(plain) if size is None else size
    head = struct.pack("<QQQII", 0, 0, size, zlib.crc32(plain), 4) + b"zstd"
    return _record(6, head + struct.pack("<Q", len(packed)) + packed)


def test_a_small_tape_does_not_unpack_without_end(sessions: Path):
    """Chunks in chunks, chunks that hold more than they claim, and many that are nearly empty."""
    path = sessions / "bad" / "tape.mcap"
    nothing = _record(9, bytes(1 << 20)) * 60
    nested = nothing
    for _ in range(3):
        nested = _chunk(nested)
    for data, why in (
        (nested * 50, "chunk inside a chunk"),
        (_chunk(bytes(1 << 20), size=100), "more than it claims"),
        (_chunk(bytes(16), size=1 << 40), "more than it can hold"),
        (_chunk(nothing) * 2000, "tape of its size"),
    ):
        path.write_bytes(tape.MAGIC + data)
        found = TapeScan()
        assert list(scan(path, found)) == []
        assert why in found.problem
        with pytest.raises(StudioError, match="no tick"):
            review.review(SessionLibrary(sessions), "bad")
    os.utime(sessions / "bad")
    good_lives(sessions)


def test_a_zip_that_claims_more_than_the_disk_has_is_refused_before_it_is_unpacked(
    sessions: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    file = tmp_path / "large.zip"
    with zipfile.ZipFile(file, "w") as packed:
        packed.write(sessions / "good" / "tape.mcap", "good/tape.mcap")
        packed.filelist[0].file_size = 60 << 20
    about = shutil.disk_usage(tmp_path)._replace(free=archive.SPARE + (50 << 20))
    monkeypatch.setattr(archive.shutil, "disk_usage", lambda _: about)
    into = tmp_path / "into"
    into.mkdir()
    with pytest.raises(StudioError, match="GB are free"):
        archive.unpack_takes(file, into, most=1 << 40)
    with pytest.raises(StudioError, match="import fewer"):
        archive.unpack_takes(file, into, most=1 << 20)
    assert list(into.iterdir()) == []


@pytest.mark.parametrize("sidecar", [DEEP, b"[]", b'{"made": 5}', b'{"style": ["march"]}', b"\xff"])
def test_a_damaged_mapper_or_data_set_is_left_out_of_the_lists(sessions: Path, sidecar: bytes):
    for folder, file in (("mappers", "mapper.json"), ("datasets", "manifest.json")):
        (sessions / folder / "bad").mkdir(parents=True)
        (sessions / folder / "bad" / file).write_bytes(sidecar)
    assert list_mappers(sessions) == []
    assert datasets.versions(sessions) == []
    with pytest.raises(StudioError, match=r"mapper\.json"):
        open_mapper(sessions, "bad", "march")
    with pytest.raises(StudioError, match="cannot be read"):
        datasets.load(sessions, "bad")
    good_lives(sessions)


@pytest.mark.parametrize("name", ["datasets", "mappers", "-h", "--json"])
def test_a_name_that_would_vanish_or_be_an_option_is_refused(sessions: Path, name: str):
    recorder = Recorder(sessions)
    with pytest.raises(StudioError, match="is no name for a take"):
        recorder.start(name=name)
    recorder.close()
    library = SessionLibrary(sessions)
    with pytest.raises(StudioError, match="is no name for a take"):
        library.add(sessions / "good", name)
    good_lives(sessions)


@pytest.mark.parametrize("name", ["datasets", "my take (2)"])
def test_a_take_in_a_folder_that_cannot_be_one_is_listed_with_what_to_do(sessions: Path, name: str):
    (sessions / "good").rename(sessions / name)
    _, odd = sorted(SessionLibrary(sessions).list(), key=lambda info: info.name != "bad")
    assert odd.name == name
    assert "no name for a take" in odd.damaged


def test_a_clock_before_1970_loses_no_take(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("time.time_ns", lambda: -3_600_000_000_000)
    recorder = Recorder(tmp_path)
    recorder.start(name="early")
    for tick in make_ticks(30):
        recorder.append(tick)
    recorder.close()
    assert survey_take(tmp_path / "early").ticks == 30
    times = [m.time for m in scan(tmp_path / "early" / "tape.mcap", TapeScan())]
    assert times[0] == 0
    assert np.all(np.diff(times) >= 0)
