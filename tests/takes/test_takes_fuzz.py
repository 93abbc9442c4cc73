"""Whatever lies in a take's folder, it is read or refused with a reason, never with a crash."""

import contextlib
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from make_ticks import make_ticks

from studio.errors import StudioError
from studio.takes.columns import columns
from studio.takes.dataset.pairs import take_pairs
from studio.takes.edit import review
from studio.takes.edit.edits import EDITS, FIELDS, Edits, read_edits
from studio.takes.record.recorder import Recorder
from studio.takes.session_library import SessionLibrary
from studio.takes.take import read_take

fuzzed = settings(
    max_examples=40,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


@pytest.fixture
def library(tmp_path: Path) -> SessionLibrary:
    recorder = Recorder(tmp_path)
    recorder.start(name="take")
    for tick in make_ticks(40):
        recorder.append(tick)
    recorder.close()
    return SessionLibrary(tmp_path)


def everything(library: SessionLibrary) -> None:
    """All that a page may ask of a take; a StudioError is a fine answer."""
    library.list()
    for ask in (read_take, columns):
        with contextlib.suppress(StudioError):
            ask(library.root / "take")
    for ask in (review.review, take_pairs):
        with contextlib.suppress(StudioError):
            ask(library, "take")


@pytest.mark.slow
@fuzzed
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 40))
def test_flipped_bytes_of_a_tape_are_survived(library: SessionLibrary, seed: int, count: int):
    path = library.root / "take" / "tape.mcap"
    original = path.read_bytes()
    rng = np.random.default_rng(seed)
    data = bytearray(original)
    for i in rng.integers(0, len(data), count):
        data[i] = rng.integers(256)
    path.write_bytes(bytes(data))
    try:
        everything(library)
    finally:
        path.write_bytes(original)


@pytest.mark.slow
@fuzzed
@given(data=st.binary(max_size=400))
def test_random_tapes_are_refused_with_a_reason(library: SessionLibrary, data: bytes):
    path = library.root / "take" / "tape.mcap"
    original = path.read_bytes()
    for content in (data, b"\x89MCAP0\r\n" + data, original[:200] + data):
        path.write_bytes(content)
        everything(library)
    path.write_bytes(original)


@pytest.mark.slow
@fuzzed
@given(lines=st.lists(st.binary(max_size=80), max_size=8))
def test_random_edit_logs_are_read_past(library: SessionLibrary, lines: list[bytes]):
    (library.root / "take" / EDITS).write_bytes(b"\n".join(lines))
    log = read_edits(library.root / "take")
    assert isinstance(log.edits, Edits)
    everything(library)


values = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4),
    max_leaves=8,
)
rows = st.one_of(
    st.fixed_dictionaries({"set": st.dictionaries(st.sampled_from(FIELDS), values, max_size=3)}),
    st.fixed_dictionaries({"found": st.dictionaries(st.sampled_from(FIELDS), values, max_size=2)}),
    st.just({"undo": True}),
    st.just({"redo": True}),
    st.fixed_dictionaries({"set": values}),
    values,
)


@pytest.mark.slow
@fuzzed
@given(log=st.lists(rows, max_size=10))
def test_well_formed_nonsense_in_an_edit_log_is_left_out_and_named(
    library: SessionLibrary, log: list
):
    lines = []
    for row in log:
        try:
            lines.append(msgspec.json.encode(row))
        except (msgspec.MsgspecError, OverflowError, UnicodeEncodeError):
            continue
    (library.root / "take" / EDITS).write_bytes(b"\n".join(lines))
    found = read_edits(library.root / "take")
    assert found.undoable >= 0
    everything(library)


@settings(fuzzed, max_examples=15)
@given(steps=st.lists(st.integers(0, 5), max_size=30), seed=st.integers(0, 99))
def test_undo_and_redo_walk_back_and_forth_through_every_edit(
    library: SessionLibrary, steps: list[int], seed: int
):
    """Against a model: a list of values and a cursor."""
    rng = np.random.default_rng(seed)
    folder = library.root / "take"
    (folder / EDITS).unlink(missing_ok=True)
    history: list[Edits] = [Edits()]
    cursor = 0
    for step in steps:
        if step == 0 and cursor > 0:
            library.undo("take")
            cursor -= 1
        elif step == 1 and cursor < len(history) - 1:
            library.redo("take")
            cursor += 1
        elif step > 1:
            change = (
                {"label": f"l{rng.integers(9)}"},
                {"lag": round(float(rng.uniform(0, 0.8)), 3)},
                {"trim": (0.1, round(float(rng.uniform(0.5, 1.3)), 3))},
                {"keep": bool(rng.integers(2)), "cuts": [[0.2, 0.4]]},
            )[step - 2]
            library.edit("take", **change)
            now = read_edits(folder).edits
            del history[cursor + 1 :]
            history.append(now)
            cursor += 1
        assert read_edits(folder).edits == history[cursor]
    info = library.info("take")
    assert (info.undoable, info.redoable) == (cursor, len(history) - 1 - cursor)
