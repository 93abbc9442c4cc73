"""Exports come back as what the take holds; imports become takes again."""

import json
import zipfile
from collections import Counter
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest
from acted_takes import acted_take, record
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from make_ticks import make_ticks
from mcap.reader import make_reader

from studio.errors import StudioError
from studio.robot import a1
from studio.takes import commands
from studio.takes.dataset import pairs_file
from studio.takes.dataset.pairs import take_pairs
from studio.takes.edit import edited
from studio.takes.edit.edits import edit
from studio.takes.export import formats as exports
from studio.takes.export.episodes import episodes
from studio.takes.record.recorder import Recorder
from studio.takes.session_library import SessionLibrary
from studio.takes.take import read_take

LAG_FRAMES = 12


@pytest.fixture(scope="module")
def sessions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("takes")
    rng = np.random.default_rng(5)
    for task in ("manipulate_left", "walk"):
        acted = acted_take(task, rng, seconds=3.0, lag=0.4, idle_gestures=False, sensor="mocap")
        record(acted, root, task, keep=True)
    library = SessionLibrary(root)
    library.edit("manipulate_left", lag=LAG_FRAMES / 30.0, trim=(1.0, 5.0), cuts=[[2.0, 3.0]])
    return root


def lasting(sessions: Path):
    """The ticks that the trim and the cut leave, and the take."""
    take = read_take(sessions / "manipulate_left")
    return np.flatnonzero(edited.kept(len(take), take.edits)), take


def test_pairs_export_holds_the_pairs(sessions: Path, tmp_path: Path):
    file = Path(commands.export_take(sessions, "manipulate_left", "pairs", tmp_path)["file"])
    found, arrays = take_pairs(SessionLibrary(sessions), "manipulate_left"), None
    arrays = pairs_file.read_table(file)
    for key, value in found.values.items():
        np.testing.assert_array_equal(arrays[key], value)
    np.testing.assert_array_equal(arrays["tick"], found.tick)
    about = json.loads(pq.read_schema(file).metadata[b"a1_studio"])
    assert about["lag"] == pytest.approx(0.4)
    assert len(about["features"]) == arrays["q"].shape[1]


def test_lerobot_export_has_the_layout_and_the_numbers(sessions: Path, tmp_path: Path):
    answer = commands.export_take(sessions, "manipulate_left", "lerobot", tmp_path, more=("walk",))
    root = Path(answer["file"])
    info = json.loads((root / "meta/info.json").read_text())
    assert info["codebase_version"] == "v3.0"
    assert (info["fps"], info["total_episodes"], info["total_tasks"]) == (30, 3, 2)
    data = pq.read_table(root / info["data_path"].format(chunk_index=0, file_index=0))
    assert data.num_rows == info["total_frames"]
    assert set(data.column_names) == set(info["features"])
    for key, feature in info["features"].items():
        kind = data.schema.field(key).type
        if feature["shape"] != [1]:
            assert kind.list_size == feature["shape"][0] == len(feature["names"])
            kind = kind.value_type
        assert str(kind).replace("float", "float32") == feature["dtype"] or str(kind) == "int64"
    ticks, take = lasting(sessions)
    n = len(ticks)

    def column(key: str) -> Any:
        return np.array(data[key].to_pylist()[:n])

    np.testing.assert_allclose(column("action"), take.arrays.target[ticks], atol=1e-6)
    assert take.human is not None
    human = column("observation.human").reshape(n, 19, 3)
    np.testing.assert_allclose(human, take.human.joint_pos_w[ticks + LAG_FRAMES], atol=1e-6)
    # The observation comes first: the robot of the tick before.
    state, robot = column("observation.state"), take.arrays.robot
    np.testing.assert_allclose(state[:, 7:19], robot["joint_pos"][ticks - 1], atol=1e-6)
    np.testing.assert_allclose(state[:, 19:31], robot["joint_vel"][ticks - 1], atol=1e-5)
    np.testing.assert_allclose(state[:, 34:37], robot["base_ang_vel_b"][ticks - 1], atol=1e-6)
    person = column("observation.environment_state")
    np.testing.assert_allclose(person[:, 0], human[:, 0, 2], atol=1e-6)
    np.testing.assert_allclose(
        person[:, 1:55].reshape(n, 18, 3), human[:, 1:] - human[:, :1], atol=1e-5
    )
    episodes = pq.read_table(root / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert [e["episode_index"] for e in episodes] == [0, 1, 2]  # the cut parts the first take
    bounds = [(e["dataset_from_index"], e["dataset_to_index"]) for e in episodes]
    assert [b - a for a, b in bounds] == [e["length"] for e in episodes]
    assert (bounds[0][0], bounds[1][1], bounds[2][1]) == (0, n, data.num_rows)
    assert data["index"].to_pylist() == list(range(data.num_rows))
    assert data["frame_index"].to_pylist()[n] == 0
    assert data["timestamp"].to_pylist()[1] == pytest.approx(1 / 30)
    tasks = pq.read_table(root / "meta/tasks.parquet")
    assert tasks["task"].to_pylist() == ["manipulate left", "walk"]
    assert json.loads(tasks.schema.metadata[b"pandas"])["index_columns"] == ["task"]
    stats = json.loads((root / "meta/stats.json").read_text())
    whole = np.array(data["observation.state"].to_pylist())
    np.testing.assert_allclose(stats["observation.state"]["mean"], whole.mean(0), atol=1e-5)
    assert stats["observation.state"]["count"] == [data.num_rows]
    with pytest.raises(StudioError, match="new folder"):
        exports.export(take, "lerobot", root)


def test_hdf5_export_is_what_robomimic_asks_for(sessions: Path, tmp_path: Path):
    """As robomimic's get_dataset_info and SequenceDataset read it."""
    answer = commands.export_take(sessions, "manipulate_left", "hdf5", tmp_path, more=("walk",))
    ticks, take = lasting(sessions)
    with h5py.File(answer["file"]) as file:
        data: Any = file["data"]
        assert json.loads(data.attrs["env_args"])["type"] in (1, 2, 3)
        demos = sorted(data, key=lambda name: int(name[5:]))
        assert demos == ["demo_0", "demo_1", "demo_2"]  # the cut parts the first take
        actions = np.concatenate([data[d]["actions_rad"] for d in demos[:2]])
        np.testing.assert_allclose(actions, take.arrays.target[ticks], atol=1e-6)
        mask: Any = file["mask"]
        assert [name.decode() for name in mask["train"]] == demos[:2]
        assert [name.decode() for name in mask["valid"]] == demos[2:]  # of another take
        stats: Any = file["action_stats"]
        for name in demos:
            scaled = data[name]["actions"][()]
            assert np.abs(scaled).max() <= 1.0
            span = stats["upper"][()] - stats["lower"][()]
            back = stats["lower"][()] + 0.5 * (scaled + 1.0) * span
            np.testing.assert_allclose(back, data[name]["actions_rad"][()], atol=1e-5)
        every = np.concatenate([data[d]["actions_rad"] for d in demos])
        np.testing.assert_allclose(stats["mean"], every.mean(0), atol=1e-5)
        np.testing.assert_allclose(stats["max"], every.max(0), atol=1e-6)
        demo = data["demo_0"]
        length = demo.attrs["num_samples"]
        first = ticks[:length]
        assert demo["dones"][()].tolist() == [0] * (length - 1) + [1]
        robot = take.arrays.robot
        for key, at in (("obs", first - 1), ("next_obs", first)):
            joints = demo[f"{key}/robot_joint_pos"][()]
            np.testing.assert_allclose(joints, robot["joint_pos"][at], atol=1e-6)
        velocities = np.concatenate(
            [robot[k] for k in ("base_lin_vel_w", "base_ang_vel_b", "joint_vel")], axis=1
        )
        np.testing.assert_allclose(demo["states"][:, 19:], velocities[first - 1], atol=1e-5)
        assert data.attrs["total"] == sum(len(data[d]["actions"]) for d in data)


def test_of_one_demo_the_end_is_held_out(sessions: Path, tmp_path: Path):
    path = commands.export_take(sessions, "walk", "hdf5", tmp_path)["file"]
    with h5py.File(path) as file:
        data: Any = file["data"]
        mask: Any = file["mask"]
        assert [list(mask[key]) for key in ("train", "valid")] == [[b"demo_0"], [b"demo_1"]]
        lengths = [len(data[f"demo_{i}"]["actions"]) for i in (0, 1)]
        assert lengths[1] == pytest.approx(0.1 * sum(lengths), abs=1)
        assert sum(lengths) == len(read_take(sessions / "walk")) - 1


def test_html_export_is_one_file_that_asks_for_nothing(sessions: Path, tmp_path: Path):
    SessionLibrary(sessions).edit("walk", label="</script><script>alert(1)</script>")
    text = Path(commands.export_take(sessions, "walk", "html", tmp_path)["file"]).read_text()
    SessionLibrary(sessions).undo("walk")
    assert "http://" not in text
    assert "https://" not in text
    assert "src=" not in text.replace("default-src", "").replace("script-src", "")
    assert "alert(1)</script>" not in text
    start = text.index('type="application/json">') + len('type="application/json">')
    data = json.loads(text[start : text.index("</script>", start)])
    titles = ["Recorded person", "What it should do", "What physics lets it do"]
    assert [f["title"] for f in (data["person"], *data["robots"])] == titles
    assert len(data["states"]) == len(read_take(sessions / "walk"))


@pytest.mark.parametrize("name", sorted(exports.FORMATS))
def test_every_format_is_written_and_downloads_as_one_file(
    name: str, sessions: Path, tmp_path: Path
):
    path = exports.export_file(read_take(sessions / "walk"), name, tmp_path)
    assert path.is_file()
    assert path.stat().st_size > 500
    if path.suffix == ".zip":
        inside = {"lerobot": "meta/info.json", "takes": "walk/tape.mcap"}[name]
        assert any(n.endswith(inside) for n in zipfile.ZipFile(path).namelist())


@pytest.mark.parametrize("name", sorted(exports.FORMATS))
def test_every_format_refuses_what_it_cannot_hold_with_reasons(name: str, tmp_path: Path):
    recorder = Recorder(tmp_path)
    recorder.start(name="empty")
    for tick in make_ticks(1):
        recorder.append(tick)
    recorder.close()
    take = read_take(tmp_path / "empty")
    if not exports.FORMATS[name].several:
        with pytest.raises(StudioError, match="holds one take"):
            exports.export([take, take], name, tmp_path)
    (tmp_path / "in_the_way").write_text("a file, not a folder")
    if not exports.FORMATS[name].folder:
        with pytest.raises(StudioError, match="in_the_way"):
            exports.export(take, name, tmp_path / "in_the_way" / "file")


def test_a_person_from_a_file_becomes_a_take(sessions: Path, tmp_path: Path):
    """Out as frames and as BVH, in again as the human side of a take, and onto a robot's take."""
    from studio.mocap.imports import import_human

    original = read_take(sessions / "walk")
    assert original.human is not None
    frames = commands.export_take(sessions, "walk", "jsonl", tmp_path)["file"]
    other = tmp_path / "other"
    answer = import_human(other, Path(frames))
    take = read_take(other / answer["takes"][0])
    assert take.human is not None
    assert len(take) == len(original)
    # A person begins at the origin, wherever the file has them.
    start = np.append(original.human.joint_pos_w[0, 0, :2], 0.0)
    np.testing.assert_allclose(
        take.human.joint_pos_w, original.human.joint_pos_w - start, atol=3e-6
    )
    # The robot stands by, in neutral.
    assert np.ptp(take.arrays.reference["joint_pos"], axis=0).max() == 0.0

    bvh = commands.export_take(sessions, "walk", "bvh", tmp_path)["file"]
    answer = import_human(sessions, Path(bvh), name="acted-again", robot="walk")
    take = read_take(sessions / answer["takes"][0])
    np.testing.assert_allclose(
        take.arrays.reference["joint_pos"], original.arrays.reference["joint_pos"], atol=2e-6
    )
    assert take.human is not None
    n = min(len(take.human), len(original.human))
    gap = np.linalg.norm(
        (take.human.joint_pos_w - take.human.joint_pos_w[:, :1])[:n]
        - (original.human.joint_pos_w - original.human.joint_pos_w[:, :1])[:n],
        axis=-1,
    )
    assert np.median(gap) < 0.03
    SessionLibrary(sessions).delete("acted-again")
    with pytest.raises(StudioError, match="bvh"):
        import_human(other, tmp_path / "motion.fbx")
    assert a1.NUM_JOINTS == 12


def test_mcap_export_shows_three_figures_on_one_clock(sessions: Path, tmp_path: Path):
    """Read by mcap's own reader; protobuf decoded with nothing but the schemas in the file."""
    path = commands.export_take(sessions, "manipulate_left", "mcap", tmp_path)["file"]
    take = read_take(sessions / "manipulate_left")
    start, end = exports.tick_range(take)
    counts: Counter[str] = Counter()
    first: dict[str, Any] = {}
    with Path(path).open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        for schema, channel, message in reader.iter_messages():
            assert schema is not None
            assert message.log_time == message.publish_time
            counts[channel.topic] += 1
            if channel.message_encoding == "protobuf" and channel.topic not in first:
                pool = DescriptorPool()
                for each in FileDescriptorSet.FromString(schema.data).file:
                    pool.Add(each)
                kind = GetMessageClass(pool.FindMessageTypeByName(schema.name))
                first[channel.topic] = kind.FromString(message.data)
    assert counts["/tick"] == counts["/tf"] == counts["/scene"] == end - start
    assert counts["/human"] > 0.9 * (end - start)
    scene, cloud, frames = (first[topic] for topic in ("/scene", "/points/person", "/tf"))
    assert [entity.frame_id for entity in scene.entities] == ["person", "reference", "robot"]
    assert take.human is not None
    points = [[p.x, p.y, p.z] for p in scene.entities[0].lines[0].points]
    np.testing.assert_allclose(points, take.human.joint_pos_w[start], atol=1e-6)
    assert len(scene.entities[2].lines[0].indices) % 2 == 0
    assert len(cloud.data) % cloud.point_stride == 0
    names = {t.child_frame_id: t for t in frames.transforms}
    assert {"person", "reference", "robot", "robot/FR_calf", "reference/trunk"} <= set(names)
    trunk, base = names["robot/trunk"].translation, take.arrays.robot["base_pos"][start]
    np.testing.assert_allclose([trunk.x, trunk.y, trunk.z], base, atol=1e-9)


@pytest.mark.parametrize("ticks", [2, 3, 4, 5, 6, 12])
def test_hdf5_of_a_few_ticks_holds_a_step_out_and_its_words_end_nowhere(tmp_path, ticks):
    recorder = Recorder(tmp_path)
    recorder.start(name="short")
    for tick in make_ticks(ticks):
        recorder.append(tick)
    recorder.close()
    edit(tmp_path / "short", label="wave\0hello")
    take = read_take(tmp_path / "short")
    steps = sum(len(part) for part in episodes(take))
    if steps < 2:
        with pytest.raises(StudioError, match="one step"):
            exports.export(take, "hdf5", tmp_path)
        return
    with h5py.File(exports.export(take, "hdf5", tmp_path)) as file:
        lengths = [len(file[f"data/demo_{k}/actions"]) for k in range(2)]  # type: ignore[arg-type]
        assert sum(lengths) == steps
        assert min(lengths) >= 1
        assert file["data/demo_0"].attrs["label"] == "wavehello"
