"""Reviewing a take: what is found, what is accepted becomes an edit, what is undone is gone."""

import resource
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from acted_takes import acted_take, record
from make_ticks import make_ticks

from studio.errors import StudioError
from studio.takes import commands
from studio.takes.align import synchrony
from studio.takes.columns import ROW, VERSION, Columns, columns
from studio.takes.dataset import cleaning
from studio.takes.edit import edited, review, windows
from studio.takes.edit.edits import Edits, edit, read_edits
from studio.takes.record.recorder import Recorder
from studio.takes.session_library import SessionLibrary
from studio.takes.take import read_take

DT = 1.0 / 30.0


@pytest.fixture(scope="module")
def acted():
    return acted_take(
        "manipulate_left", np.random.default_rng(4), lag=0.5, idle_gestures=False, sensor="mocap"
    )


@pytest.fixture
def library(tmp_path: Path, acted) -> SessionLibrary:
    record(acted, tmp_path, "one")
    return SessionLibrary(tmp_path)


def test_the_table_holds_what_the_tape_holds(library: SessionLibrary):
    take, table = read_take(library.folder("one")), columns(library.folder("one"))
    assert len(table) == len(take)
    arrays = take.arrays
    for key in ("base_pos", "base_quat", "joint_pos", "foot_contact"):
        np.testing.assert_allclose(table.rows[f"reference_{key}"], arrays.reference[key], atol=1e-6)
        np.testing.assert_allclose(table.rows[f"robot_{key}"], arrays.robot[key], atol=1e-6)
    assert take.human is not None
    np.testing.assert_allclose(table.rows["human"], take.human.joint_pos_w, atol=1e-6)
    assert [table.names[i] for i in table.rows["state"]] == arrays.state


def test_the_table_is_built_once_and_again_when_the_tape_changes(tmp_path: Path):
    recorder = Recorder(tmp_path)
    recorder.start(name="t")
    ticks = list(make_ticks(60))
    for tick in ticks[:30]:
        recorder.append(tick)
    assert len(columns(tmp_path / "t")) == 30
    for tick in ticks[30:]:
        recorder.append(tick)
    recorder.close()
    table = columns(tmp_path / "t")
    assert len(table) == 60
    assert isinstance(table.rows, np.memmap)
    before = (tmp_path / ".cache" / "t.rows").stat().st_mtime_ns
    columns(tmp_path / "t")
    assert (tmp_path / ".cache" / "t.rows").stat().st_mtime_ns == before


def test_a_folder_that_cannot_be_written_is_reviewed_all_the_same(
    library: SessionLibrary, monkeypatch: pytest.MonkeyPatch
):
    def refuse(*_: object, **__: object) -> None:
        raise OSError(30, "read-only file system")

    monkeypatch.setattr(Path, "mkdir", refuse)
    assert len(columns(library.folder("one"))) > 200


def test_a_late_person_is_found_accepted_and_undone(library: SessionLibrary, acted):
    before = commands.align_take(library.root, "one", show=True)
    assert before["lag"] is None
    assert before["after"]["lag"] == pytest.approx(acted.lag, abs=DT)
    done = commands.align_take(library.root, "one")
    assert done["lag"] == pytest.approx(acted.lag, abs=DT)
    assert done["after"]["correlation"] > done["before"]["correlation"] + 0.1
    assert library.undo("one").lag is None
    assert library.redo("one").lag == done["lag"]
    commands.align_take(library.root, "one", refuse=True)
    assert library.info("one").lag == 0.0


def test_an_aligned_window_shows_the_person_who_acted_at_t_plus_lag(library: SessionLibrary):
    edit(library.folder("one"), lag=0.5)
    table, edits = edited.open_table(library.root, "one")
    raw = windows.window(table, edits, 0.0, 99.0, aligned=False)
    aligned = windows.window(table, edits, 0.0, 99.0)
    np.testing.assert_allclose(aligned["human"][:-15], raw["human"][15:], atol=1e-6)
    np.testing.assert_array_equal(aligned["reference_joint_pos"], raw["reference_joint_pos"])
    half = windows.window(table, edits, 1.0, 2.0)
    np.testing.assert_allclose(half["human"], aligned["human"][30:60], atol=1e-6)
    thin = windows.window(table, edits, 0.0, 99.0, most=50)
    assert len(thin["t"]) <= 50
    assert thin["t"][-1] > table.seconds - 0.5


def test_a_warp_is_kept_and_read_back(library: SessionLibrary):
    done = commands.align_take(library.root, "one", warp=True)
    log = read_edits(library.folder("one"))
    assert log.problems == ()
    assert log.edits.warp is not None
    assert done["warp"] == len(log.edits.warp)
    table, edits = edited.open_table(library.root, "one")
    rows = edited.human_rows(np.arange(len(table)), edits)
    assert np.all(np.diff(rows) >= -1e-6)


def test_a_warp_that_would_agree_no_better_is_left_out(
    library: SessionLibrary, monkeypatch: pytest.MonkeyPatch
):
    def rough(*_: object) -> tuple[tuple[float, float], ...]:
        return tuple((0.5 * i, 0.2 * (i % 2)) for i in range(12))

    monkeypatch.setattr(synchrony, "propose_warp", rough)
    done = commands.align_take(library.root, "one", warp=True)
    assert done["warp"] is None
    assert done["lag"] is not None
    assert not library.info("one").warped
    assert agreement(library) == pytest.approx(done["after"]["correlation"], abs=0.02)
    library.edit("one", warp=rough())
    assert library.info("one").warped
    assert agreement(library) < done["after"]["correlation"] - 0.01
    library.undo("one")
    assert not library.info("one").warped


@pytest.fixture
def wandering(tmp_path: Path, acted) -> tuple[SessionLibrary, np.ndarray]:
    """A take of a person who hurries and dawdles by 0.3 s, and what each tick's row really is."""
    rows = np.arange(len(acted.human_pos))
    played = rows + 9.0 * np.sin(2.0 * np.pi * rows / 90.0)
    at = np.clip(np.rint(played).astype(int), 0, rows[-1])
    record(replace(acted, human_pos=acted.human_pos[at]), tmp_path, "one")
    return SessionLibrary(tmp_path), np.interp(rows + acted.lag / DT, played, rows)


def agreement(library: SessionLibrary) -> float:
    before = review.review(library, "one").before
    assert before is not None
    return before.correlation


def test_a_warp_that_is_accepted_raises_agreement_where_tempo_wanders(wandering):
    library, _ = wandering
    commands.align_take(library.root, "one")
    lagged = agreement(library)
    done = commands.align_take(library.root, "one", warp=True)
    assert agreement(library) > lagged + 0.03
    assert done["after"]["correlation"] == pytest.approx(agreement(library))
    library.undo("one")
    assert agreement(library) == pytest.approx(lagged)


def test_the_right_warp_agrees_as_well_as_a_person_who_keeps_time(
    wandering, tmp_path_factory, acted
):
    library, rows = wandering
    steady = SessionLibrary(tmp_path_factory.mktemp("steady"))
    record(acted, steady.root, "one")
    for each in (library, steady):
        each.edit("one", lag=acted.lag)
    shift = (rows - np.arange(len(rows))) * DT - acted.lag
    library.edit("one", warp=[[i * DT, float(shift[i])] for i in range(0, len(rows) - 30, 5)])
    assert agreement(library) == pytest.approx(agreement(steady), abs=0.02)
    before = review.review(library, "one").before
    assert before is not None
    assert before.lag == acted.lag


def test_the_score_is_listed_and_is_no_step_to_undo(library: SessionLibrary):
    found = review.review(library, "one")
    assert library.list()[0].score == pytest.approx(found.score)
    assert library.info("one").undoable == 0
    assert 0.0 < found.score <= 1.0
    assert found.score == pytest.approx(found.quality.score / 100.0, abs=1e-4)
    assert sum(r.points for r in found.quality.reasons) == pytest.approx(
        100.0 - found.quality.score, abs=1e-6
    )


def test_aligning_a_late_take_raises_its_score(library: SessionLibrary):
    late = review.review(library, "one")
    assert "lag" in {r.name for r in late.quality.reasons}
    synchrony.accept_alignment(library, "one")
    assert review.review(library, "one").score > late.score


def test_a_decided_score_stands_over_a_measured_one(library: SessionLibrary):
    library.edit("one", score=0.2)
    review.review(library, "one")
    assert library.info("one").score == 0.2


def spoiled(rows: np.ndarray) -> np.ndarray:
    """Three faults: a frozen second, a limb swap and a dropped half second."""
    rows = rows.copy()
    rows["human"][60:90] = rows["human"][60]
    left, right = [6, 7], [9, 10]
    rows["human"][150:170][:, left + right] = rows["human"][150:170][:, right + left]
    rows["human_t"][200:] += 0.5
    return rows


def test_faults_are_suggested_where_they_are(library: SessionLibrary):
    table = columns(library.folder("one"))
    found = cleaning.take_suggestions(Columns(rows=spoiled(table.rows), names=table.names))
    by_kind = {s.kind: s for s in found}
    assert by_kind["frozen"].start == pytest.approx(2.0, abs=DT)
    assert by_kind["frozen"].end == pytest.approx(89 * DT, abs=DT)
    assert by_kind["dropped"].start == pytest.approx(199 * DT, abs=DT)
    # Where a block ends no fault is found twice or missed.
    for seconds in (2.1, 3.0, 5.5):
        size, cleaning.BLOCK_S = cleaning.BLOCK_S, seconds
        try:
            again = cleaning.take_suggestions(Columns(rows=spoiled(table.rows), names=table.names))
        finally:
            cleaning.BLOCK_S = size
        assert [s.kind for s in again].count("dropped") == 1
        assert [s.kind for s in again].count("frozen") >= 1


@pytest.fixture
def flawed(tmp_path: Path, acted) -> SessionLibrary:
    """A take with two frozen stretches, a second each."""
    pos = acted.human_pos.copy()
    pos[60:90], pos[150:180] = pos[60], pos[150]
    record(replace(acted, human_pos=pos), tmp_path, "one")
    return SessionLibrary(tmp_path)


def frozen(library: SessionLibrary):
    return [s for s in review.review(library, "one").suggestions if s.kind == "frozen"]


def test_one_suggestion_that_is_accepted_is_cut_out_and_undone(flawed: SessionLibrary):
    found = review.review(flawed, "one")
    which = next(i for i, s in enumerate(found.suggestions) if s.kind == "frozen")
    edits = review.accept_suggestions(flawed, "one", [which])
    assert edits.cuts == (pytest.approx((2.0, 89 * DT), abs=1e-6),)
    assert flawed.info("one").undoable == 1
    left = review.review(flawed, "one")
    assert left.kept_seconds == pytest.approx(found.kept_seconds - 1.0, abs=1.5 * DT)
    assert len(left.suggestions) == len(found.suggestions) - 1
    assert [s.start for s in frozen(flawed)] == [pytest.approx(5.0, abs=DT)]
    flawed.undo("one")
    assert read_edits(flawed.folder("one")).edits.cuts is None
    assert review.review(flawed, "one").suggestions == found.suggestions


def test_all_suggestions_are_accepted_on_top_of_what_was_cut(flawed: SessionLibrary):
    flawed.edit("one", cuts=[[0.5, 1.0]])
    edits = review.accept_suggestions(flawed, "one")
    assert edits.cuts is not None
    assert edits.cuts[0] == (0.5, 1.0)
    assert review.review(flawed, "one").suggestions == ()
    with pytest.raises(StudioError, match="nothing to cut"):
        review.accept_suggestions(flawed, "one")


def test_cleaning_by_command_cuts_the_same(flawed: SessionLibrary):
    told = commands.clean_take(flawed.root, "one")
    cuts = read_edits(flawed.folder("one")).edits.cuts
    assert cuts
    assert told["cuts"] == cuts
    assert frozen(flawed) == []


def test_a_suggestion_that_is_not_there_is_refused_and_nothing_is_cut(flawed: SessionLibrary):
    for which in ([99], [0, -1]):
        with pytest.raises(StudioError, match="there is no suggestion"):
            review.accept_suggestions(flawed, "one", which)
    with pytest.raises(StudioError, match="nothing to cut"):
        review.accept_suggestions(flawed, "one", [])
    assert flawed.info("one").undoable == 0


def test_what_is_cut_or_trimmed_counts_no_more(library: SessionLibrary):
    edits = Edits(trim=(1.0, 5.0), cuts=((2.0, 3.0),))
    keep = edited.kept(240, edits)
    t = np.arange(240) / 30.0
    np.testing.assert_array_equal(keep, (t >= 1.0) & (t < 5.0) & ~((t >= 2.0) & (t <= 3.0)))
    library.edit("one", cuts=[[0.0, 1.0], [0.5, 2.0], [4.0, 5.0]])
    assert read_edits(library.folder("one")).edits.cuts == ((0.0, 2.0), (4.0, 5.0))
    assert review.review(library, "one").kept_seconds == pytest.approx(
        columns(library.folder("one")).seconds - 3.0, abs=0.1
    )


def test_a_split_makes_two_takes_and_undo_joins_them(library: SessionLibrary):
    seconds = library.info("one").seconds
    library.edit("one", lag=0.25)
    first, second = library.split("one", 4.0)
    assert (first.trim, second.trim) == ((0.0, 4.0), (4.0, seconds))
    assert second.lag == 0.25
    assert second.undoable == 0
    third = library.split("one", 2.0)[1]
    assert [t.name for t in library.list()] == ["one", second.name, third.name]
    assert library.undo("one").trim == (0.0, 4.0)
    assert [t.name for t in library.list()] == ["one", second.name]
    library.undo("one")
    assert [t.name for t in library.list()] == ["one"]
    library.redo("one")
    library.redo("one")
    assert [t.name for t in library.list()] == ["one", second.name, third.name]
    assert library.info(third.name).trim == (2.0, 4.0)
    with pytest.raises(StudioError, match="within the take"):
        library.split("one", 3.0)


def test_what_was_deleted_comes_back(library: SessionLibrary):
    library.edit("one", label="mine")
    library.delete("one")
    assert library.list() == []
    assert library.deleted() == ["one"]
    assert commands.restore_take(library.root, "one")["label"] == "mine"
    with pytest.raises(StudioError, match="in the bin"):
        library.restore("one")


def test_a_take_in_which_nothing_moves_says_that_it_cannot_be_aligned(tmp_path: Path):
    quiet = acted_take("quiet", np.random.default_rng(0), lag=0.0, seconds=3.0)
    motion = quiet.motion
    frozen = {
        key: np.repeat(getattr(motion, key)[:1], len(motion), axis=0)
        for key in ("base_pos", "base_quat", "joint_pos", "foot_contact")
    }
    record(replace(quiet, motion=replace(motion, **frozen)), tmp_path, "still")
    with pytest.raises(StudioError, match="nothing moves"):
        synchrony.accept_alignment(SessionLibrary(tmp_path), "still")
    assert review.review(SessionLibrary(tmp_path), "still").found is None


@pytest.mark.slow
def test_an_hour_is_reviewed_in_bounded_memory_and_scrubs_at_once(tmp_path: Path, acted):
    """108,000 ticks: a review stays under 250 MB, a window under 30 ms."""
    record(acted, tmp_path, "seed")
    short = columns(tmp_path / "seed").rows
    folder = tmp_path / "hour"
    folder.mkdir()
    (folder / "tape.mcap").write_bytes((tmp_path / "seed" / "tape.mcap").read_bytes())
    stat = (folder / "tape.mcap").stat()
    repeats = -(-108_000 // len(short))
    with (tmp_path / ".cache" / "hour.rows").open("wb") as file:
        for i in range(repeats):
            part = short.copy()
            part["human_t"] += i * len(short) * DT
            file.write(part.tobytes())
    import msgspec

    about = {
        "key": [VERSION, stat.st_size, stat.st_mtime_ns],
        "rows": repeats * len(short),
        "names": list(columns(tmp_path / "seed").names),
    }
    (tmp_path / ".cache" / "hour.json").write_bytes(msgspec.json.encode(about))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    table, edits = columns(folder), Edits(lag=0.4)
    assert len(table) >= 108_000
    found = review.review(SessionLibrary(tmp_path), "hour")
    assert found.found is not None
    windows.overview(table, edits)
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    assert grown < 250.0, f"{grown:.0f} MB"
    assert ROW.itemsize * 108_000 < 100e6  # mapped from disk, as all of the cache
