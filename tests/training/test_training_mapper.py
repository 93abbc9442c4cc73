"""Training experts: pairs are aligned and mirror exactly, learning beats its start and ridge."""

import json
from dataclasses import replace

import numpy as np
import pytest
from canonical_people import MIRROR_JOINTS

from studio import geometry
from studio.human.features import FEATURE_DIM, FEATURE_NAMES, clip_features, mirror_features
from studio.human.pose import HumanClip
from studio.reference.library import TASKS
from studio.reference.realize import realize
from studio.reference.stances import tilt_of
from studio.retarget.baselines.frames import Targets
from studio.retarget.baselines.simple import Ridge
from studio.retarget.experts import EXPERTS
from studio.retarget.mapper import RATES, Mapped, Mapper
from studio.retarget.retargeter import Retargeter
from studio.retarget.store import load_experts
from studio.synthetic import Person, perform, play
from studio.synthetic import signals as sig
from studio.synthetic.person import MIXED
from studio.training import checkpoint
from studio.training.mapper_fit import MapperTraining, fit_expert, new_net, score
from studio.training.operator_pairs import (
    acts,
    mirrored,
    pair_up,
)
from studio.training.selector_data import SIT, STAND, UNLABELLED, WALK, labels, sequences
from studio.training.synthetic_pairs import make_pairs
from studio.training.train_mapper import run_train_mapper

SMALL = MapperTraining(steps=400, hidden=64, batch=128, seconds=120.0, seed=5)


def person(seed: int = 0, **changes: object) -> Person:
    someone = Person.sample(np.random.default_rng(seed), sensor="mocap").still()
    return replace(someone, **changes)  # type: ignore[arg-type]


def test_pairs_line_up_with_what_is_meant_whoever_is_slow():
    # Lean and tilt of the trunk must go together whatever the reaction delay is.
    for delay in (0.0, 0.25):
        rng = np.random.default_rng(1)
        track = TASKS["tilt"].sample(rng, 10.0, 1.0)
        pairs = pair_up(track, realize(track), person(reaction_delay=delay), rng)
        joints = pairs.triplet[:, :FEATURE_DIM]
        chest_x = joints[:, 3]  # bones are spine, chest …: x of the chest before the pelvis
        pitch = tilt_of("stand", geometry.normalize(pairs.base_quat))[:, 1]
        lags = range(-8, 9)
        fit = [np.corrcoef(np.roll(chest_x, -lag)[10:-10], pitch[10:-10])[0, 1] for lag in lags]
        # The causal filter's own lag, two to four frames, is left for the mapper to learn.
        assert -1 <= list(lags)[int(np.argmax(fit))] <= 4


def test_mirroring_a_triplet_is_seeing_the_mirrored_person():
    rng = np.random.default_rng(2)
    clip = perform(TASKS["tilt_manipulate"].sample(rng, 3.0), person(), rng)
    other = HumanClip(
        name="mirror",
        t=clip.t,
        joint_pos_w=clip.joint_pos_w[:, MIRROR_JOINTS] * [1.0, -1.0, 1.0],
        confidence=clip.confidence[:, MIRROR_JOINTS],
    )
    ours = mirror_features(np.concatenate(clip_features(clip), axis=-1).astype(np.float32))
    theirs = np.concatenate(clip_features(other), axis=-1)
    np.testing.assert_allclose(ours, theirs, atol=1e-3, rtol=1e-3)


def test_mirroring_pairs_twice_gives_them_back():
    rng = np.random.default_rng(3)
    track = TASKS["turn"].sample(rng, 4.0)
    pairs = pair_up(track, realize(track), person(), rng)
    again = mirrored(mirrored(pairs))
    for name in pairs.__dataclass_fields__:
        np.testing.assert_allclose(getattr(again, name), getattr(pairs, name), atol=1e-6)
    turning = RATES["base_ang_vel"].stop - 1
    np.testing.assert_allclose(mirrored(pairs).rates[:, turning], -pairs.rates[:, turning])


def test_a_mapper_is_scored_by_the_studios_own_figures():
    pairs = make_pairs("sit", 6.0, 3)
    right = Mapped(
        joint_pos=np.asarray(pairs.joint_pos, dtype=np.float64),
        base_quat=np.asarray(pairs.base_quat, dtype=np.float64),
        rates=np.asarray(pairs.rates, dtype=np.float64),
        contact_prob=np.asarray(pairs.contact, dtype=np.float64),
    )
    turned = geometry.quat_mul(geometry.quat_from_rpy([0.0, 0.0, 0.3]), pairs.base_quat)
    none = replace(pairs, contact=np.zeros_like(pairs.contact))
    said = replace(right, base_quat=turned, contact_prob=none.contact)
    figures = score(lambda _: said, none)  # type: ignore[arg-type]
    assert figures["joint_rmse_deg"] == 0.0
    assert figures["orientation_error_deg"] == pytest.approx(0.0, abs=1e-4)  # heading is no tilt
    assert figures["contact_f1"] == 1.0  # nothing was in contact, nothing was said to be


@pytest.mark.slow
@pytest.mark.parametrize("state", ["walk", "stand"])
def test_a_small_training_beats_its_start_and_ridge_on_strangers(state: str):
    # People stand in more ways than they walk: it takes longer to beat a straight line there.
    config = replace(SMALL, steps=3 * SMALL.steps if state == "stand" else SMALL.steps)
    pairs = make_pairs(state, SMALL.seconds, 5)  # type: ignore[arg-type]
    held = make_pairs(state, 60.0, 6, family="held_out")  # type: ignore[arg-type]
    start = score(Mapper.from_tensors(new_net(state, pairs, SMALL).export()), held)  # type: ignore[arg-type]
    trained = score(Mapper.from_tensors(fit_expert(state, pairs, config).export()), held)  # type: ignore[arg-type]
    linear = Ridge(
        pairs.triplet,
        Targets(**{f: getattr(pairs, f) for f in Targets.__dataclass_fields__}),
    )(held.triplet)
    ridge = np.degrees(np.sqrt(np.mean((linear.joint_pos - held.joint_pos) ** 2)))
    assert trained["joint_rmse_deg"] < 0.6 * start["joint_rmse_deg"]
    assert trained["joint_rmse_deg"] < ridge
    assert trained["contact_f1"] > 0.8


@pytest.mark.slow
def test_training_resumes_to_the_very_same_weights(tmp_path):
    pairs = make_pairs("sit", 30.0, 1)
    config = replace(SMALL, steps=80)
    whole = fit_expert("sit", pairs, config).export()

    class StopError(Exception):
        pass

    def stop(step: int) -> None:
        if step >= 60:
            raise StopError

    file = tmp_path / "sit.checkpoint"
    with pytest.raises(StopError):
        fit_expert("sit", pairs, config, file, stop, save_every=50)
    assert checkpoint.load(file)[1]["step"] == 50
    resumed = fit_expert("sit", pairs, config, file).export()
    for name, value in whole.items():
        np.testing.assert_allclose(resumed[name], value, atol=1e-6)
    assert not file.exists()


def test_a_checkpoint_of_another_configuration_is_not_resumed(tmp_path):
    pairs = make_pairs("sit", 30.0, 1)
    file = tmp_path / "sit.checkpoint"
    config = replace(SMALL, steps=30)
    checkpoint.save(file, {}, {"step": 29, "config": {"seed": 99}})
    fresh = fit_expert("sit", pairs, config).export()
    again = fit_expert("sit", pairs, config, file).export()
    np.testing.assert_array_equal(fresh["trunk.0.weight"], again["trunk.0.weight"])


def test_frame_labels_follow_the_body():
    rng = np.random.default_rng(4)
    someone = person()

    def labelled(task: str) -> np.ndarray:
        signal = sig.of_track(TASKS[task].sample(rng, 8.0, 0.7))
        return labels(play(signal, someone, rng, task).true_pos_w)[30:-30]

    assert set(labelled("quiet")) == {STAND}
    assert set(labelled("tilt")) <= {STAND, UNLABELLED}
    assert set(labelled("sit_tilt")) == {SIT}
    walking = labelled("walk")
    assert np.mean(walking == WALK) > 0.7
    assert not np.any(walking == SIT)


@pytest.mark.parametrize("family", ["default", "mixed"])
def test_sequences_hold_every_state_and_many_people(family):
    parts = list(sequences(np.random.default_rng(0), 150.0, family=family))
    together = np.concatenate([p.label for p in parts])
    assert len(parts) == 5
    assert set(together) == {STAND, WALK, SIT}


def test_mixed_people_are_of_both_families_and_bend_deeper_than_the_default():
    families = {
        someone.family
        for (_, _, someone), _ in zip(
            acts("stand", np.random.default_rng(0), MIXED, "march", 2.0), range(12)
        )
    }
    assert families == {"default", "wide"}
    chest_z = FEATURE_DIM + FEATURE_NAMES.index("chest.z")  # its speed
    speed = [
        np.abs(make_pairs("stand", 60.0, 2, family=f).triplet[:, chest_z]).mean()
        for f in ("default", MIXED)
    ]
    assert speed[1] > 1.3 * speed[0]


@pytest.mark.slow
def test_a_style_trained_from_scratch_drives_a_retargeter(tmp_path):
    config = replace(SMALL, steps=150, seconds=60.0, selector_seconds=150.0)
    summary = run_train_mapper(replace(config, out=tmp_path / "mapper" / "march"))
    assert [row["expert"] for row in summary["rows"]] == [*EXPERTS, "selector"]
    sidecar = json.loads((tmp_path / "mapper" / "march" / "walk.json").read_text())
    assert sidecar["scores"]["joint_rmse_deg"] > 0.0
    rng = np.random.default_rng(0)
    clip = perform(TASKS["sit_quiet"].sample(rng, 3.0), person(), rng)
    retargeter = Retargeter(load_experts("march", tmp_path))
    assert [retargeter.step(clip[i]) for i in range(len(clip))][-1].expert == "sit"
