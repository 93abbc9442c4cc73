"""The sessions folder: listed fast, edited without touching tapes, never left."""

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from make_ticks import make_ticks

from studio.errors import StudioError
from studio.takes import commands
from studio.takes.edit.edits import EDITS, edit, read_edits, redo, undo
from studio.takes.record.recorder import Recorder
from studio.takes.session_library import SessionLibrary

WRITER = Path(__file__).with_name("write_until_killed.py")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("recorded")
    recorder = Recorder(root)
    recorder.start("wave", name="take", about={"source": "operator:tilt"})
    for tick in make_ticks(90, human_every=2):
        recorder.append(tick)
    recorder.close()
    return root


@pytest.fixture
def sessions(recorded: Path, tmp_path: Path) -> Path:
    shutil.copytree(recorded / "take", tmp_path / "take")
    return tmp_path


def test_a_take_is_listed_with_what_the_contract_names(sessions: Path):
    (info,) = commands.list_takes(sessions)["takes"]
    expected = {"name": "take", "label": "wave", "seconds": 3.0, "ticks": 90, "score": None}
    expected |= {"kept": None, "complete": True, "recovered": False, "source": "operator:tilt"}
    assert expected.items() <= info.items()
    assert commands.verify_takes(sessions)["takes"] == [
        {"name": "take", "ticks": 90, "seconds": 3.0, "complete": True, "recovered": False,
         "readable": True, "problems": []}
    ]  # fmt: skip
    assert commands.show_take(sessions, "take")["human_frames"] == 45


def test_an_empty_or_missing_folder_lists_nothing(tmp_path: Path):
    assert SessionLibrary(tmp_path).list() == []
    assert SessionLibrary(tmp_path / "none").list() == []


def test_a_killed_take_is_listed_as_recovered_and_a_running_one_as_running(tmp_path: Path):
    library = SessionLibrary(tmp_path)
    command = [sys.executable, str(WRITER), str(tmp_path), "killed"]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        for _ in range(20):
            process.stdout.readline()
        (running,) = library.list()
        assert (running.recording, running.complete) == (True, False)
        with pytest.raises(StudioError, match="being recorded"):
            library.delete("killed")
        process.kill()
        process.stdout.read()
    (info,) = library.list()
    assert (info.recording, info.complete, info.recovered) == (False, False, True)
    assert info.ticks >= 18
    assert info.problems
    (checked,) = library.verify()
    assert checked["readable"]
    assert checked["ticks"] == info.ticks


def test_an_unreadable_take_is_listed_with_its_problem(sessions: Path):
    (sessions / "take" / "tape.mcap").write_bytes(b"garbage")
    (checked,) = SessionLibrary(sessions).verify()
    assert not checked["readable"]
    assert "no tape" in checked["problems"][0]
    shutil.rmtree(sessions / "take")
    (sessions / "take").mkdir()
    (sessions / "take" / "meta.json").write_text("{")
    (info,) = SessionLibrary(sessions).list()
    assert info.problems


def test_edits_undo_and_redo_without_limit_and_leave_the_tape_alone(sessions: Path):
    tape = (sessions / "take" / "tape.mcap").read_bytes()
    library = SessionLibrary(sessions)
    library.edit("take", label="a")
    library.edit("take", trim=(0.5, 2.0), keep=True)
    library.edit("take", label="b", lag=-0.1, score=0.7)
    info = library.list()[0]
    assert (info.label, info.trim, info.kept, info.lag, info.score) == (
        "b", (0.5, 2.0), True, -0.1, 0.7,
    )  # fmt: skip
    assert library.undo("take").label == "a"
    assert library.undo("take").trim is None
    assert library.undo("take").label == "wave"
    with pytest.raises(StudioError, match="nothing to undo"):
        library.undo("take")
    for _ in range(3):
        last = library.redo("take")
    assert last == library.info("take")
    assert (last.label, last.trim) == ("b", (0.5, 2.0))
    with pytest.raises(StudioError, match="nothing to redo"):
        library.redo("take")
    library.undo("take")
    library.edit("take", note="a new branch")
    with pytest.raises(StudioError, match="nothing to redo"):
        redo(sessions / "take")
    assert (sessions / "take" / "tape.mcap").read_bytes() == tape


@pytest.mark.parametrize(
    "changes",
    [
        {}, {"colour": "red"}, {"trim": [2.0, 1.0]}, {"trim": [-1.0, 1.0]}, {"trim": [0.0, 99.0]},
        {"trim": "all"}, {"trim": [0.0]}, {"trim": [0.0, float("nan")]}, {"lag": "late"},
        {"lag": 1e9}, {"keep": 1}, {"score": 2.0}, {"score": True}, {"label": 5},
        {"label": "x" * 20000},
    ],
)  # fmt: skip
def test_edits_that_make_no_sense_are_refused(sessions: Path, changes: dict):
    with pytest.raises(StudioError):
        SessionLibrary(sessions).edit("take", **changes)
    assert read_edits(sessions / "take").undoable == 0


def test_a_damaged_edit_log_keeps_its_good_lines_and_names_the_bad(sessions: Path):
    folder = sessions / "take"
    edit(folder, label="good")
    with (folder / EDITS).open("ab") as file:
        file.write(b'{"set": {"trim": [5, 1]}}\n[]\n{"undo": tr')  # the last: torn by a crash
    log = edit(folder, keep=True)
    assert (log.edits.label, log.edits.keep) == ("good", True)
    assert len(log.problems) == 3
    assert "line 2" in log.problems[0]
    rng = np.random.default_rng(0)
    whole = (folder / EDITS).read_bytes()
    for _ in range(200):
        data = bytearray(whole)
        for at in rng.integers(0, len(data), 4):
            data[at] = rng.integers(0, 256)
        (folder / EDITS).write_bytes(data)
        read_edits(folder)  # never raises
    undo(folder) if read_edits(folder).undoable else None


@pytest.mark.parametrize("name", ["../take", "/etc", "a/../take", "..", ".", "", "take\0", "tåke"])
def test_names_never_lead_out_of_the_folder(sessions: Path, name: str):
    library = SessionLibrary(sessions / "inner")
    (sessions / "inner").mkdir()
    calls = [library.info, library.read, library.delete, library.undo, library.verify]
    for call in calls:
        with pytest.raises(StudioError):
            call(name)
    with pytest.raises(StudioError):
        library.edit(name, label="x")
    assert (sessions / "take" / "tape.mcap").exists()


def test_a_link_out_of_the_folder_is_no_take(sessions: Path):
    inner = sessions / "inner"
    inner.mkdir()
    (inner / "linked").symlink_to(sessions / "take")
    library = SessionLibrary(inner)
    assert library.list() == []
    with pytest.raises(StudioError, match="link"):
        library.read("linked")


def test_unknown_takes_list_the_known_ones(sessions: Path):
    with pytest.raises(StudioError, match="known: take"):
        SessionLibrary(sessions).info("other")


def test_deleted_takes_go_to_the_bin(sessions: Path):
    library = SessionLibrary(sessions)
    moved = library.delete("take")
    assert library.list() == []
    assert (moved / "tape.mcap").exists()
    assert moved.parent == sessions / ".bin"


def test_exports_hold_what_the_trim_leaves(sessions: Path, tmp_path: Path):
    commands.trim_take(sessions, "take", 1.0, 2.0)
    files = {
        name: Path(commands.export_take(sessions, "take", name, tmp_path)["file"])
        for name in ("jsonl", "npz", "csv", "bvh")
    }
    assert len(files["jsonl"].read_text().splitlines()) == 15
    with np.load(files["npz"], allow_pickle=False) as data:
        assert data["robot_joint_pos"].shape == (30, 12)
        assert data["target"].shape == (30, 12)
    rows = files["csv"].read_text().splitlines()
    assert len(rows) == 31
    assert len(rows[0].split(",")) == len(rows[1].split(","))
    assert "Frames: 30" in files["bvh"].read_text()  # one a tick, so that pauses stay as long
    with pytest.raises(StudioError, match="known: bvh"):
        commands.export_take(sessions, "take", "docx", tmp_path)


def test_imported_takes_are_the_same_takes(sessions: Path, tmp_path: Path):
    other = tmp_path / "other"
    assert commands.import_take(other, sessions / "take", "copy") == {"takes": ["copy"]}
    assert SessionLibrary(other).verify("copy")[0]["ticks"] == 90
    with pytest.raises(StudioError, match="exists"):
        commands.import_take(other, sessions / "take", "copy")
    with pytest.raises(StudioError):
        commands.import_take(other, tmp_path / "nothing")
    with pytest.raises(StudioError, match="letters"):
        commands.import_take(other, sessions / "take", "../out")


@pytest.mark.slow
def test_of_ten_thousand_takes_an_edited_one_is_listed_anew(sessions: Path):
    folder = sessions / "take"
    (folder / "tape.mcap").unlink()
    meta = (folder / "meta.json").read_bytes()
    for i in range(10_000):
        (sessions / f"t{i:05d}").mkdir()
        (sessions / f"t{i:05d}" / "meta.json").write_bytes(meta)
    library = SessionLibrary(sessions)
    assert len(library.list()) == 10_001  # the first time reads each once
    assert len(library.list()) == 10_001
    edit(sessions / "t00005", label="fresh")
    assert next(t for t in library.list() if t.name == "t00005").label == "fresh"


def test_a_take_is_trimmed_before_it_says_how_long_it_is(tmp_path: Path):
    """As right after a stop, while it is being indexed."""
    recorder = Recorder(tmp_path)
    recorder.start(name="new")
    for tick in make_ticks(30):
        recorder.append(tick)
    library = SessionLibrary(tmp_path)
    assert library.edit("new", trim=(0.1, 0.4)).trim == (0.1, 0.4)
    with pytest.raises(StudioError, match=r"within the take's 1\.000 s"):
        library.edit("new", trim=(0.1, 1.4))
    recorder.close()


def test_whoever_counts_in_milliseconds_may_keep_a_take_to_its_end(tmp_path: Path):
    """50 ticks last 1.66667 s; the page's handles say 1.667."""
    recorder = Recorder(tmp_path)
    recorder.start("", name="thirds")
    for tick in make_ticks(50):
        recorder.append(tick)
    recorder.close()
    library = SessionLibrary(tmp_path)
    trimmed = library.edit("thirds", trim=[0.5, 1.667])
    assert trimmed.trim == (0.5, trimmed.seconds)
    with pytest.raises(StudioError, match="must end within"):
        library.edit("thirds", trim=[0.5, 1.668])
