"""Takes to a mapper of one's own: split, warm start, scores, the folder that is written."""

import json
import threading

import numpy as np
import pytest
from fake_clock import FakeClock

from studio.errors import StudioError
from studio.live import collect_stages
from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.runtime import Runtime, RuntimeConfig
from studio.live.shown_motion import PlanItem
from studio.reference.intent import STATES
from studio.retarget.mapper import Mapper
from studio.retarget.store import load_experts, read_experts
from studio.training.collected import TakesTraining, run_train_takes
from studio.training.enough import learnt, left_out
from studio.training.mapper_net import MapperNet
from studio.training.take_pairs import read_pairs, split_pairs

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def collected(tmp_path_factory):
    """Two takes of a tilt by the synthetic operator, collected on a fake clock."""
    with pytest.MonkeyPatch.context() as patch:
        for pause in ("COUNTDOWN_S", "HANDS_FREE_REVIEW_S", "HANDS_FREE_READY_S"):
            patch.setattr(collect_stages, pause, 0.5)  # nobody has to get ready
        return collect_tilts(tmp_path_factory.mktemp("sessions"))


def collect_tilts(root):
    loop = LiveLoop(clock=FakeClock(), runtime=Runtime(RuntimeConfig(sessions=root)))

    def ask(command):
        asker = threading.Thread(target=lambda: loop.submit(command, timeout=20.0))
        asker.start()
        while True:
            asker.join(0.01)  # motions are drawn on its thread meanwhile: leave it the machine
            if not asker.is_alive():
                break
            loop.tick()
            loop.wait()

    items = (PlanItem(task="tilt", takes=2, seconds=5.0),)
    ask(c.SetPlan(items=items, preview=False, hands_free=True, seed=3))
    ask(c.SetMode(mode="collect"))
    while loop.runtime.collector.machine.phase != "done":
        loop.tick()
        loop.wait()
    for _ in range(5):
        loop.tick()
    names = tuple(loop.runtime.collector.kept)
    loop.runtime.close()
    assert len(names) == 2
    return root, names


def test_pairs_of_takes_are_a_data_set_version(collected):
    root, names = collected
    pairs = read_pairs(root, names)
    assert set(pairs.by_take("stand")) == set(names)
    assert pairs.count("stand") > 300
    assert pairs.count("walk") == 0
    again = read_pairs(root, (), dataset=pairs.version)
    assert again.count("stand") == pairs.count("stand")


def test_the_shipped_expert_is_right_about_collected_takes(collected):
    """Frames, conventions and lag of the pairs agree with what the shipped expert was taught."""
    root, names = collected
    found = read_pairs(root, names).by_take("stand")
    mapper = load_experts("march").mappers["stand"]
    for pairs in found.values():
        error = mapper(pairs.triplet).joint_pos - pairs.joint_pos
        assert np.degrees(np.sqrt(np.mean(error**2))) < 5.0


@pytest.mark.slow
def test_training_on_takes_writes_a_mapper_better_than_the_nearest_pair(collected, tmp_path):
    root, names = collected
    progress = tmp_path / "progress.jsonl"
    config = TakesTraining(
        takes=names, sessions=root, name="ada", states=("stand",), steps=300, progress=progress
    )
    about = run_train_takes(config)
    scores = about["experts"]["stand"]["scores"]
    ours, shipped = (scores[k]["joint_rmse_deg"] for k in ("yours", "shipped"))
    assert ours < 1.1 * shipped
    assert ours < scores["nearest_pair"]["joint_rmse_deg"]
    folder = root / "mappers" / "ada"
    sidecar = json.loads((folder / "mapper.json").read_text())
    assert sidecar["dataset"] == read_pairs(root, names, walk=False).version
    assert sidecar["takes"] == sorted(names)
    experts = read_experts(folder, "march")
    original = load_experts("march")
    x = np.zeros(len(original.mappers["walk"].mean), np.float32)
    # What was not trained is the shipped one; what was is not.
    same = experts.mappers["walk"](x).joint_pos - original.mappers["walk"](x).joint_pos
    other = experts.mappers["stand"](x).joint_pos - original.mappers["stand"](x).joint_pos
    assert np.abs(same).max() == 0.0
    assert np.abs(other).max() > 0.0
    events = [json.loads(line)["event"] for line in progress.read_text().splitlines()]
    assert events[:2] == ["reading", "pairs"]
    assert events.count("loss") == 15
    assert events[-1] == "done"
    with pytest.raises(StudioError, match="exists"):
        run_train_takes(config)


def test_too_little_to_learn_from_is_said(collected):
    root, names = collected
    with pytest.raises(StudioError, match="too few pairs"):
        run_train_takes(TakesTraining(takes=names, sessions=root, states=("walk",)))
    with pytest.raises(StudioError, match="unknown take"):
        run_train_takes(TakesTraining(takes=("nobody",), sessions=root))


def test_which_states_are_not_trained_is_said_before_and_by_the_training(collected, tmp_path):
    root, names = collected
    found = read_pairs(root, names)
    without = left_out(found.counts, STATES, "march")
    assert without == {"walk": "no take shows it", "sit": "no take shows it"}
    assert left_out(found.counts, ("walk",), "semantic") == {
        "walk": "read by rule in style semantic"
    }
    progress = tmp_path / "progress.jsonl"
    config = TakesTraining(takes=names, sessions=root, name="told", steps=20, progress=progress)
    assert run_train_takes(config)["left_out"] == without
    pairs = json.loads(progress.read_text().splitlines()[1])
    assert pairs["counts"] == {"stand": found.count("stand"), "walk": 0, "sit": 0}
    assert pairs["left_out"] == without


@pytest.mark.parametrize("takes", [1, 4, 5, 10])
def test_how_much_is_learnt_from_is_known_before_it_is_split(collected, takes: int):
    root, names = collected
    one = next(iter(read_pairs(root, names).by_take("stand").values()))
    cut = {f"{i:02}": one.take(np.arange(len(one) - i)) for i in range(takes)}
    known = len(split_pairs(cut).known)
    assert learnt({name: len(pairs) for name, pairs in cut.items()}) == known
    few = {"stand": {"a": 74}}
    assert left_out(few, ("stand",), "march") == {"stand": "59 pairs to learn from, 60 are needed"}
    assert left_out({"stand": {"a": 75}}, ("stand",), "march") == {}


def test_whole_takes_are_held_out_where_there_are_five(collected):
    root, names = collected
    one = next(iter(read_pairs(root, names).by_take("stand").values()))
    few = split_pairs({"a": one, "b": one})
    assert few.how == "the last fifth of each take"
    assert len(few.held) == pytest.approx(0.2 * 2 * len(one), abs=2)
    many = split_pairs({str(i): one for i in range(10)})
    assert many.how == "2 whole takes of 10"
    assert len(many.known) == 8 * len(one)


def test_a_network_read_back_says_the_same(collected):
    tensors = MapperNet.from_tensors(
        dict(_tensors("stand")),
    ).export()
    x = np.random.default_rng(0).normal(size=(5, len(tensors["mean"]))).astype(np.float32)
    again = Mapper.from_tensors(tensors)(x)
    once = load_experts("march").mappers["stand"](x)
    assert np.abs(again.joint_pos - once.joint_pos).max() < 1e-6
    assert np.abs(again.contact_prob - once.contact_prob).max() < 1e-6


def _tensors(part):
    from safetensors.numpy import load_file

    from studio.retarget.store import style_dir

    return load_file(style_dir("march") / f"{part}.safetensors")
