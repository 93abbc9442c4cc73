"""The whole retargeting of the shipped experts, on synthetic people."""

import numpy as np
import pytest

from studio.errors import StudioError
from studio.human.calibration import calibrate
from studio.human.pose import HumanClip, HumanPose
from studio.reference.library import TASKS
from studio.reference.stances import NEUTRAL
from studio.retarget.experts import EXPERTS
from studio.retarget.retargeter import Retargeted, Retargeter
from studio.retarget.store import load_experts, read_sidecar, style_dir
from studio.robot import a1, kinematics
from studio.synthetic import Person, perform


def acted(task: str, seconds: float = 6.0, seed: int = 3, difficulty: float = 0.8) -> HumanClip:
    """A synthetic person of the held-out family at a task, seen by motion capture."""
    rng = np.random.default_rng(seed)
    track = TASKS[task].sample(rng, seconds, difficulty)
    person = Person.sample(rng, "held_out", sensor="mocap").still()
    return perform(track, person, rng)


def follow(retargeter: Retargeter, clip: HumanClip) -> list[Retargeted]:
    return [retargeter.step(clip[i]) for i in range(len(clip))]


def fresh(clip: HumanClip | None = None) -> Retargeter:
    known = calibrate([clip[i] for i in range(0, len(clip), 10)]) if clip is not None else None
    return Retargeter.load("march", known)


@pytest.mark.parametrize("task", sorted(TASKS))
def test_a_stranger_at_each_task_is_followed_in_its_state(task: str):
    clip = acted(task)
    out = follow(fresh(clip), clip)
    chosen = [o.expert for o in out[15:]]
    if task == "march":  # somebody who pauses while marching stands
        assert chosen.count("walk") > 0.4 * len(chosen)
    else:
        # This stranger walks at 0.47 strides a second: between steps both feet stand for a second.
        share = 0.6 if task == "walk" else 0.75
        assert chosen.count(TASKS[task].state) > share * len(chosen)
    joints = np.array([o.reference.joint_pos for o in out])
    speed = np.abs(np.diff(joints, axis=0)).max(axis=1) / a1.CONTROL_DT
    limits = np.array([EXPERTS[o.active].speed_limit for o in out[1:]])  # type: ignore[index]
    assert np.all(speed <= limits + 1e-6)
    assert np.all((joints >= a1.JOINT_LOWER - 1e-6) & (joints <= a1.JOINT_UPPER + 1e-6))


def test_standing_feet_do_not_skate():
    clip = acted("tilt")
    out = follow(fresh(clip), clip)[15:]
    feet = np.array(
        [
            kinematics.foot_pos_w(r.base_pos, r.base_quat, r.joint_pos)
            for r in (o.reference for o in out)
        ]
    )
    assert np.linalg.norm(np.diff(feet[..., :2], axis=0), axis=-1).mean() / a1.CONTROL_DT < 0.03


def test_a_march_walks_forwards():
    clip = acted("walk", seconds=8.0, difficulty=0.5)
    out = follow(fresh(clip), clip)
    assert out[-1].reference.base_pos[0] > 0.2


def test_nothing_seen_yet_stands_and_says_unknown():
    out = fresh().step(None)
    assert out.expert == "unknown"
    np.testing.assert_allclose(out.reference.joint_pos, NEUTRAL["stand"].joint_pos)


def test_a_person_who_vanishes_is_held_and_then_eased_to_neutral():
    clip = acted("tilt", difficulty=1.0)
    retargeter = fresh(clip)
    out = follow(retargeter, clip)
    leaned = max(range(30, len(out)), key=lambda i: abs(out[i].reference.base_quat[1:]).max())
    retargeter = fresh(clip)
    last = [retargeter.step(clip[i]) for i in range(leaned + 1)][-1]
    held = [retargeter.step(None) for _ in range(3)][-1]
    assert held.expert == last.expert
    for _ in range(60):
        gone = retargeter.step(None)
    np.testing.assert_allclose(gone.reference.base_quat, NEUTRAL["stand"].base_quat, atol=0.02)


def test_a_contortion_is_unknown_and_keeps_the_expert():
    clip = acted("quiet")
    retargeter = fresh(clip)
    follow(retargeter, clip)
    for i in range(40):
        # Upside down, arms and legs crossed over: no state of the vocabulary.
        joints = clip[i].joint_pos_w * [1.0, -1.0, -1.0] + [0.0, 0.0, 2.0]
        out = retargeter.step(
            HumanPose(t=6.0 + i / 30.0, joint_pos_w=joints, confidence=np.ones(19))
        )
    assert out.expert == "unknown"
    assert out.active == "stand"


def test_a_lock_holds_the_state_and_an_unknown_one_lists_them():
    clip = acted("quiet", seconds=4.0)
    retargeter = fresh(clip)
    retargeter.set_expert("sit")
    followed = follow(retargeter, clip)
    assert {o.active for o in followed} == {"sit"}
    assert {o.expert for o in followed} == {"stand"}
    with pytest.raises(StudioError, match="sit, stand, walk"):
        retargeter.set_expert("swim")


def test_reset_makes_the_same_motion_again():
    clip = acted("turn", seconds=4.0)
    retargeter = fresh(clip)
    first = follow(retargeter, clip)[-1].reference
    retargeter.reset()
    again = follow(retargeter, clip)[-1].reference
    np.testing.assert_array_equal(first.base_pos, again.base_pos)
    np.testing.assert_array_equal(first.joint_pos, again.joint_pos)


def test_shipped_experts_say_what_they_were_made_from():
    for name in (*EXPERTS, "selector"):
        sidecar = read_sidecar(style_dir("march") / name)
        assert {"data", "seed", "commit", "scores", "config"} <= set(sidecar)
    assert len(load_experts("march").prototypes.points) <= 2000


def test_a_style_that_is_not_trained_says_how_to_train_it(tmp_path):
    with pytest.raises(StudioError, match="train mapper --style circles"):
        load_experts("circles", tmp_path)
    with pytest.raises(StudioError, match="march"):
        Retargeter.load("dance")
