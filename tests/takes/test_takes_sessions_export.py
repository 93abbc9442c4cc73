"""Whole sessions in one data set, and back from it."""

import shutil
from datetime import date
from pathlib import Path

import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest
from acted_takes import acted_take, record
from make_ticks import make_ticks

from studio.errors import StudioError
from studio.mocap.imports import import_take
from studio.takes import commands
from studio.takes.edit.edits import edit
from studio.takes.export.episodes import episodes
from studio.takes.export.formats import export_file
from studio.takes.export.lerobot import features
from studio.takes.record.recorder import Recorder
from studio.takes.session_library import SessionLibrary
from studio.takes.sessions import SessionBook, session_name
from studio.takes.take import read_take


@pytest.fixture
def sessions(tmp_path: Path) -> Path:
    """Ann's session of three takes (one rejected, one empty) and somebody else's take."""
    root = tmp_path / "sessions"
    recorder = Recorder(root)
    for i, (name, ticks) in enumerate((("one", 50), ("two", 40), ("bad", 30), ("none", 0))):
        about = {"collect": {"task": "walk", "state": "walk"}, "source": "bvh:/home/me"}
        recorder.start("wave hello", name=name, about=about)
        for tick in make_ticks(ticks, seed=i):
            recorder.append(tick)
        recorder.stop()
        SessionBook(root).add("Ann", name)
    recorder.start(name="other")
    for tick in make_ticks(35, seed=9):
        recorder.append(tick)
    recorder.close()
    edit(root / "bad", keep=False)
    return root


def test_a_session_is_one_data_set_without_what_was_rejected(sessions: Path, tmp_path: Path):
    ann = session_name("Ann", date.today())
    answer = commands.export_take(sessions, session=ann, format="hdf5", out=tmp_path)
    assert set(answer["left_out"]) == {"bad", "none"}
    assert answer["file"] == str(tmp_path / f"{ann}.hdf5")
    with h5py.File(answer["file"]) as file:
        demos = [file[f"data/demo_{i}"].attrs["take"] for i in range(len(file["data"]))]  # type: ignore[arg-type]
    assert demos == ["one", "two"]
    answer = commands.export_take(sessions, all=True, format="lerobot", out=tmp_path / "x.lerobot")
    assert set(answer["left_out"]) == {"bad", "none"}
    with pytest.raises(StudioError, match="several fit into"):
        commands.export_take(sessions, session=ann, format="bvh", out=tmp_path)
    with pytest.raises(StudioError, match="say what to export"):
        commands.export_take(sessions, "one", session=ann, format="hdf5")
    with pytest.raises(StudioError, match="unknown session"):
        commands.export_take(sessions, session="nobody", format="hdf5")


@pytest.mark.parametrize("format", ["lerobot", "hdf5"])
def test_where_nothing_is_left_nothing_is_written(sessions: Path, tmp_path: Path, format: str):
    for name in ("one", "two", "other"):
        edit(sessions / name, keep=False)
    out = tmp_path / "out"
    out.mkdir()
    with pytest.raises(StudioError, match="nothing to export"):
        commands.export_take(sessions, all=True, format=format, out=out)
    assert list(out.iterdir()) == []


def test_an_exported_data_set_comes_back_and_goes_out_again_the_same(
    sessions: Path, tmp_path: Path
):
    edit(sessions / "one", cuts=[[0.5, 0.6]])
    commands.export_take(sessions, "one", "lerobot", tmp_path / "a.lerobot", more=("two",))
    other = tmp_path / "other"
    answer = commands.import_take(other, tmp_path / "a.lerobot")
    assert answer == {"takes": ["one", "one-2", "two"], "refused": {}}
    sent = [e for name in ("one", "two") for e in episodes(read_take(sessions / name))]
    for name, was in zip(answer["takes"], sent, strict=True):
        take = read_take(other / name)
        assert take.label == "wave hello"
        assert take.edits.lag == 0.0  # in step already
        assert take.meta["about"]["collect"]["state"] == "walk"
        (now,) = episodes(take)
        assert len(now) == len(was)
        before, after = features(was), features(now)
        for key, x in before.items():
            np.testing.assert_allclose(after[key], x, atol=5e-6, err_msg=key)
        original = read_take(sessions / name.partition("-")[0])
        assert [take.ticks[n].state for n in now.tick] == [
            original.ticks[n].state for n in was.tick
        ]
    assert all(info.complete and not info.damaged for info in SessionLibrary(other).list())
    text = (tmp_path / "a.lerobot/meta/a1_studio.json").read_text()
    assert "/home/me" not in text  # where it was made is nobody's business


def test_a_data_set_changed_since_comes_back_by_its_tasks(sessions: Path, tmp_path: Path):
    """LeRobot's own tools drop what they do not know."""
    folder = Path(commands.export_take(sessions, "two", "lerobot", tmp_path)["file"])
    (folder / "meta/a1_studio.json").unlink()
    other = tmp_path / "other"
    (name,) = commands.import_take(other, folder)["takes"]
    take = read_take(other / name)
    assert (name, take.label) == ("two-0", "wave hello")
    assert {tick.state for tick in take.ticks} == {"idle"}


def test_what_is_no_data_set_of_ours_is_refused_with_why(sessions: Path, tmp_path: Path):
    folder = Path(commands.export_take(sessions, "two", "lerobot", tmp_path)["file"])
    info = folder / "meta/info.json"
    good = info.read_text()
    for changed, why in (
        (good.replace('"v3.0"', '"v2.1"'), "v3.0 is read"),
        (good.replace('"fps": 30', '"fps": 50'), "50 frames a second"),
        (good.replace("observation.human", "observation.somebody"), "only what a1-studio"),
        ("{}", "no LeRobotDataset"),
        ("[" * 100_000, "no LeRobotDataset"),
    ):
        info.write_text(changed)
        with pytest.raises(StudioError, match=why):
            commands.import_take(tmp_path / "other", folder)
    info.write_text(good)
    data = folder / "data/chunk-000/file-000.parquet"
    data.write_bytes(data.read_bytes()[:-100])
    with pytest.raises(StudioError, match="cannot be read"):
        commands.import_take(tmp_path / "other", folder)
    assert not list((tmp_path / "other").glob("[!.]*"))


@pytest.mark.parametrize("format", ["lerobot", "mcap", "jsonl", "bvh"])
def test_what_is_downloaded_can_be_imported_as_it_is(sessions: Path, tmp_path: Path, format: str):
    """A page gets a data set as a zip; MCAP, frames and BVH are a file each."""
    out = tmp_path / "out"
    out.mkdir()
    if format in ("jsonl", "bvh"):  # a person who is believed
        record(acted_take("tilt", np.random.default_rng(1), seconds=3.0), sessions, "acted-one")
        was = read_take(sessions / "acted-one")
    else:
        was = read_take(sessions / "one")
    file = export_file(was, format, out)
    assert file.is_file()
    other = tmp_path / "other"
    answer = import_take(other, file)
    (name,) = answer["takes"]
    assert name.endswith("one")
    assert not answer.get("refused")
    now = read_take(other / name)
    assert abs(len(now) - len(was)) <= 1  # a pose that is new in the last tick lasts no longer
    if format in ("mcap", "lerobot"):
        tick = -3
        np.testing.assert_allclose(
            now.ticks[tick].robot.joint_pos, was.ticks[tick].robot.joint_pos, atol=5e-6
        )
    assert all(info.complete and not info.damaged for info in SessionLibrary(other).list())
    assert {path.name for path in other.iterdir()} - {".index.json", ".recording.lock"} == {name}


def test_a_table_that_unpacks_to_far_more_than_it_is_is_refused_at_once(
    sessions: Path, tmp_path: Path
):
    folder = Path(commands.export_take(sessions, "two", "lerobot", tmp_path)["file"])
    file = folder / "data/chunk-000/file-000.parquet"
    row = pq.read_table(file).slice(0, 1)
    pq.write_table(row.take([0] * 20_000), file, compression="zstd")
    assert file.stat().st_size < 100_000
    zipped = shutil.make_archive(str(folder), "zip", tmp_path, folder.name)
    with pytest.raises(StudioError, match="it is not as a1-studio exported it"):
        import_take(tmp_path / "other", Path(zipped))
    assert not [path for path in (tmp_path / "other").iterdir() if path.name[0] != "."]
