"""The synthetic person: repeatable, physically plausible, and fluent in the whole vocabulary."""

import threading
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from studio.errors import StudioError
from studio.geometry.time_scaling import smoothstep
from studio.human.skeleton import BONE_CHILD, BONE_PARENT, INDEX
from studio.mocap.source import Source
from studio.reference.intent import Intent, IntentTrack
from studio.synthetic import FAMILIES, exercise, squats
from studio.synthetic import signals as sig
from studio.synthetic.exercises import windmill_arms
from studio.synthetic.operator import (
    InteractiveOperator,
    OperatorSource,
    Performer,
    Person,
    perform,
    play,
)
from studio.synthetic.tour import TOUR, tour_signal
from studio.synthetic.wide import DRILL, SQUAT_HOLD_S
from studio.training.selector_data import SIT, STAND, UNLABELLED, WALK, labels

DT = sig.DT
PEOPLE = [(seed, family) for seed in range(4) for family in FAMILIES]


def person_of(seed: int, family: str = "default", **kwargs) -> Person:
    return Person.sample(np.random.default_rng(seed), family, sensor="mocap", **kwargs).still()


def signal_of(seconds: float, **fields: Any) -> np.ndarray:
    """Rest for one second, ease into `fields` within one, and hold them."""
    steps = round(seconds / DT)
    goal = sig.of_intents([Intent(**fields)])[0]
    ease = smoothstep(np.linspace(-1.0, seconds - 1.0 - DT, steps))[:, None]
    signal = ease * goal
    signal[:, [sig.WALK, sig.SIT]] = goal[[sig.WALK, sig.SIT]]
    signal[:, sig.PHASE] = np.cumsum(signal[:, sig.CADENCE]) * DT
    return signal


def show(person: Person, seconds: float = 5.0, **fields: Any) -> np.ndarray:
    """True joints (T, 19, 3) of `signal_of`."""
    return play(signal_of(seconds, **fields), person, 0, "test").true_pos_w


def joint(pos: np.ndarray, name: str) -> np.ndarray:
    return pos[..., INDEX[name], :]


def knee_angle(pos: np.ndarray, side: str) -> np.ndarray:
    """Flexion of a knee (T,), degrees."""
    hip, knee, ankle = (joint(pos, f"{side}_{name}") for name in ("hip", "knee", "ankle"))
    a, b = knee - hip, ankle - knee
    cos = np.sum(a * b, -1) / np.linalg.norm(a, axis=-1) / np.linalg.norm(b, axis=-1)
    return np.degrees(np.arccos(np.clip(cos, -1.0, 1.0)))


def trunk_tilt(pos: np.ndarray) -> np.ndarray:
    """(T, 3) degrees: lean right, lean forward, twist left of the shoulders."""
    up = joint(pos, "chest") - joint(pos, "pelvis")
    left = joint(pos, "l_shoulder") - joint(pos, "r_shoulder")
    roll, pitch = np.arctan2(-up[:, 1], up[:, 2]), np.arctan2(up[:, 0], up[:, 2])
    return np.degrees(np.stack([roll, pitch, np.arctan2(-left[:, 0], left[:, 1])], -1))


def test_the_same_seed_gives_the_same_person_and_motion():
    signal, _ = tour_signal()
    for sensor in ("mocap", "kinect", "webcam"):
        a, b, c = (
            play(signal[:300], Person.sample(np.random.default_rng(s), sensor=sensor), s, "x").clip
            for s in (3, 3, 4)
        )
        assert np.array_equal(a.joint_pos_w, b.joint_pos_w)
        assert np.array_equal(a.confidence, b.confidence)
        assert not np.allclose(a.joint_pos_w, c.joint_pos_w)


def test_frame_by_frame_and_whole_tracks_are_the_same_motion():
    steps = 150
    track = IntentTrack(
        state="walk", task="walk", dt=DT, tilt=np.zeros((steps, 3)), crouch=np.zeros(steps),
        reach=np.zeros((steps, 2)), reach_side=np.zeros((steps, 2)), speed=np.zeros(steps),
        turn=np.full(steps, 0.1), phase=0.8 * np.linspace(0.0, 5.0 - DT, steps),
        cadence=np.full(steps, 0.8), lift=np.full(steps, 0.5),
        side=np.zeros(steps),
    )  # fmt: skip
    person = Person.sample(np.random.default_rng(11), sensor="webcam")
    clip = perform(track, person, 5)
    performer = Performer(person, 5)
    for i in range(steps):
        pose = performer.step(track[i], i * DT)
        assert np.allclose(pose.joint_pos_w, clip.joint_pos_w[i], atol=1e-9)
        assert np.array_equal(pose.confidence, clip.confidence[i])


def test_a_webcam_loses_limbs_and_keeps_their_last_place():
    person = Person.sample(np.random.default_rng(3), sensor="webcam")
    clip = play(np.zeros((9000, sig.NUM)), person, 1, "quiet").clip
    lost = clip.confidence == 0.0
    assert 0.0005 < lost.mean() < 0.2
    assert np.isfinite(clip.joint_pos_w).all()
    again = lost[1:]
    assert np.array_equal(clip.joint_pos_w[1:][again], clip.joint_pos_w[:-1][again])


@pytest.mark.parametrize(("seed", "family"), PEOPLE)
def test_a_body_keeps_its_bones_its_knees_forward_and_its_feet_above_the_floor(seed, family):
    signal, _ = tour_signal()
    person = Person.sample(np.random.default_rng(seed), family, sensor="mocap")
    pos = play(signal, person, seed, "tour").true_pos_w
    length = np.linalg.norm(pos[:, BONE_CHILD] - pos[:, BONE_PARENT], axis=-1)
    assert np.ptp(length, axis=0).max() < 1e-6
    assert pos[..., 2].min() > 0.0
    for side in "lr":
        hip, knee, ankle = (joint(pos, f"{side}_{name}") for name in ("hip", "knee", "ankle"))
        ahead = knee - 0.5 * (hip + ankle)
        # Forward in the leg's own plane: a knee that flips points backwards or under its shin.
        toe = joint(pos, f"{side}_toe") - ankle
        assert np.sum(ahead[:, :2] * toe[:, :2], axis=-1).min() > -0.012
        assert knee_angle(pos, side).min() > 0.5
    # Nothing jumps: a hand thrown up reaches some 10 m/s.
    velocity = np.diff(pos, axis=0) / DT
    assert np.linalg.norm(velocity, axis=-1).max() < 12.0


@pytest.mark.parametrize(("seed", "family"), PEOPLE)
def test_feet_stay_where_they_are_but_for_marching(seed, family):
    person = person_of(seed, family)
    feet = [INDEX[name] for name in ("l_ankle", "l_toe", "r_ankle", "r_toe")]
    toes = [INDEX[name] for name in ("l_toe", "r_toe")]
    poses: tuple[dict[str, Any], ...] = (
        {},
        {"tilt": np.radians([30.0, 30.0, 35.0])},
        {"tilt": np.radians([0.0, 40.0, 0.0])},
        {"tilt": np.radians([-10.0, -20.0, -40.0])},
        {"crouch": 1.0, "reach": np.array([0.7, 0.0])},
    )
    for fields in poses:
        pos = show(person, **fields)
        assert np.ptp(pos[:, feet], axis=0).max() < 1e-3, fields
    pos = show(person, state="sit", tilt=np.radians([8.0, 12.0, 5.0]))
    assert np.ptp(pos[:, toes], axis=0).max() < 1e-3


@pytest.mark.parametrize(("seed", "family"), PEOPLE)
def test_the_trunk_tilts_the_way_the_robot_is_meant_to(seed, family):
    person = person_of(seed, family)
    rest = trunk_tilt(show(person))[-30:].mean(axis=0)
    for axis in range(3):
        for sign in (1.0, -1.0):
            tilt = np.zeros(3)
            tilt[axis] = sign * np.radians(25.0)
            change = trunk_tilt(show(person, tilt=tilt))[-30:].mean(axis=0) - rest
            assert sign * change[axis] > 9.0
    forward = trunk_tilt(show(person, tilt=np.radians([0.0, 40.0, 0.0])))[-30:, 1].mean()
    assert 45.0 < forward < 105.0
    sitting = [
        trunk_tilt(show(person, state="sit", tilt=np.radians([0.0, p, 0.0])))[-1, 1]
        for p in (-15.0, 15.0)
    ]
    assert sitting[1] - sitting[0] > 30.0


@pytest.mark.parametrize(("seed", "family"), PEOPLE)
def test_crouching_stays_under_70_degrees_and_sitting_goes_past_90(seed, family):
    person = person_of(seed, family)
    stand, crouch = show(person), show(person, crouch=1.0)
    sit = show(person, state="sit")
    for side in "lr":
        assert knee_angle(stand, side)[-30:].max() < 30.0
        assert 40.0 < knee_angle(crouch, side)[-1] < 72.0
        assert knee_angle(sit, side)[-30:].min() > 90.0
    height = [joint(p, "pelvis")[-1, 2] for p in (stand, crouch, sit)]
    assert height[0] - 0.04 > height[1] > height[2] + 0.08


@pytest.mark.parametrize(("seed", "family"), PEOPLE)
@pytest.mark.parametrize("state", ["stand", "sit"])
def test_arms_hang_at_reach_0_point_ahead_at_a_half_and_rise_overhead_at_1(seed, family, state):
    person = person_of(seed, family)
    for arm, side in enumerate("rl"):
        height = []
        for reach in (0.0, 0.5, 1.0):
            both = np.zeros(2)
            both[arm] = reach
            pos = show(person, state=state, reach=both)[-1]
            height.append(joint(pos, f"{side}_wrist")[2] - joint(pos, "head")[2])
            if reach == 0.5:
                ahead = joint(pos, f"{side}_wrist") - joint(pos, f"{side}_shoulder")
                assert ahead[0] > 0.15
                assert abs(ahead[2]) < 0.35
            other = joint(pos, f"{'lr'[arm]}_wrist")[2] - joint(pos, "chest")[2]
            assert other < 0.0
        assert height[0] < -0.3
        assert height[2] > 0.02
        assert height[0] < height[1] < height[2]


def test_an_arm_goes_out_to_its_own_side():
    for seed in range(4):
        person = person_of(seed)
        for arm, side, sign in ((0, "r", -1.0), (1, "l", 1.0)):
            reach, out = np.zeros(2), np.zeros(2)
            reach[arm], out[arm] = 0.5, sign
            pos = show(person, reach=reach, reach_side=out)[-1]
            spread = joint(pos, f"{side}_wrist") - joint(pos, f"{side}_shoulder")
            assert sign * spread[1] > 0.2


@pytest.mark.parametrize("cadence", [0.3, 0.5, 0.8, 1.2, 1.5])
@pytest.mark.parametrize("family", FAMILIES)
def test_marching_lifts_each_foot_once_a_stride(cadence, family):
    for seed in range(3):
        person = person_of(seed, family)
        pos = show(person, 31.0, state="walk", cadence=cadence, lift=0.5, speed=0.3)
        phase = signal_of(31.0, state="walk", cadence=cadence)[:, sig.PHASE]
        asked = phase[-1] - phase[30]
        for side in "lr":
            ankle = joint(pos, f"{side}_ankle")
            up = ankle[:, 2] > ankle[0, 2] + 0.05
            lifts = np.count_nonzero(up[1:] & ~up[:-1])
            assert abs(lifts - asked) <= 1.0 + 0.02 * asked
            knee = joint(pos, f"{side}_knee") - joint(pos, f"{side}_hip")
            thigh = np.degrees(np.arctan2(knee[:, 0], -knee[:, 2]))
            assert 30.0 < thigh.max() < 110.0
        # One foot always carries, and a foot that carries does not slide.
        ankles = np.stack([joint(pos, "l_ankle"), joint(pos, "r_ankle")], axis=1)
        high = ankles[..., 2] - ankles[0, :, 2]
        assert high.min(axis=1).max() < (0.03 if cadence < 1.0 else 0.15)  # a jog flies
        speed = np.linalg.norm(np.diff(ankles[..., :2], axis=0), axis=-1) / DT
        carried = np.maximum(high[1:], high[:-1]) < 0.002
        assert np.percentile(speed[carried], 99) < 0.15


def test_thighs_rise_from_30_to_105_degrees_with_the_lift():
    top = []
    for lift in (0.12, 1.0):
        peaks = []
        for seed in range(20):
            pos = show(person_of(seed), 8.0, state="walk", cadence=0.5, lift=lift)
            knee = joint(pos, "l_knee") - joint(pos, "l_hip")
            peaks.append(np.degrees(np.arctan2(knee[:, 0], -knee[:, 2])).max())
        top.append(peaks)
    assert 25.0 < np.median(top[0]) < 60.0
    assert np.median(top[1]) > 80.0
    assert np.max(top[1]) > 100.0


def test_the_left_foot_is_up_in_the_first_half_of_a_stride():
    pos = show(person_of(2), 20.0, state="walk", cadence=0.5, lift=0.5)
    phase = signal_of(20.0, state="walk", cadence=0.5)[:, sig.PHASE]
    late = round(person_of(2).delay_s / DT)
    first = (phase[: len(phase) - late] % 1.0) < 0.5
    left = joint(pos, "l_ankle")[late:, 2] - joint(pos, "r_ankle")[late:, 2]
    assert left[first].max() > 0.05
    assert left[~first].max() < 0.05


def test_turning_shows_in_the_trunk():
    for seed in range(6):
        person = person_of(seed)
        left, right = (
            trunk_tilt(show(person, state="walk", cadence=0.8, lift=0.4, turn=turn))[-60:]
            for turn in (0.26, -0.26)
        )
        assert (left - right)[:, 2].mean() > 30.0


def test_circling_hands_walk_in_the_style_of_circles():
    person = person_of(1, style="circles")
    pos = show(person, 9.0, state="walk", cadence=1.0, lift=0.5)[120:]
    assert np.ptp(joint(pos, "l_ankle"), axis=0).max() < 1e-6
    for side in "lr":
        hand = joint(pos, f"{side}_wrist") - joint(pos, f"{side}_shoulder")
        hand = hand - hand.mean(axis=0)
        turned = np.unwrap(np.arctan2(hand[:, 2], hand[:, 0]))
        assert np.ptp(hand, axis=0)[[0, 2]].min() > 0.08
        # 150 frames at one stride a second: five rounds
        assert abs(turned[-1] - turned[0]) / (2 * np.pi) == pytest.approx(5.0, abs=0.15)


def test_the_motion_trails_the_intent_by_the_known_delay():
    steps = np.arange(900)
    signal = np.zeros((900, sig.NUM))
    signal[:, sig.CROUCH] = 0.5 - 0.5 * np.cos(2 * np.pi * 0.4 * steps * DT)
    for seed in range(5):
        for family in FAMILIES:
            performance = play(signal, person_of(seed, family), 0, "crouch")
            height = -joint(performance.true_pos_w, "pelvis")[:, 2]
            wanted = signal[:, sig.CROUCH]
            scores = [np.corrcoef(wanted[: 900 - k], height[k:])[0, 1] for k in range(20)]
            assert abs(int(np.argmax(scores)) - performance.delay_s / DT) <= 1.0


def test_sitting_down_takes_about_a_second():
    signal = np.zeros((150, sig.NUM))
    signal[30:, sig.SIT] = 1.0
    for seed in range(6):
        person = person_of(seed)
        height = joint(play(signal, person, 0, "x").true_pos_w, "pelvis")[:, 2]
        share = (height[0] - height) / (height[0] - height[-1])
        seconds = (np.argmax(share > 0.9) - np.argmax(share > 0.1)) * DT
        assert 0.3 < seconds < 1.6


def test_idle_arms_are_marked_and_still_people_have_none():
    person = Person.sample(np.random.default_rng(0), sensor="mocap")
    quiet = np.zeros((3600, sig.NUM))
    busy, still = play(quiet, person, 0, "x"), play(quiet, person.still(), 0, "x")
    assert busy.idle.max() > 0.99
    assert 0.1 < (busy.idle > 0.5).any(axis=1).mean() < 0.9
    assert still.idle.max() == 0.0
    wrist = joint(still.true_pos_w, "r_wrist")
    assert np.ptp(wrist[:, 2]) < 0.4 < np.ptp(joint(busy.true_pos_w, "r_wrist")[:, 2])


def test_squats_and_marches_are_labelled_by_what_the_body_does():
    rng = np.random.default_rng(2)
    shares = []
    for seed in range(4):
        signal, person = squats(rng, 20.0), person_of(seed)
        pos = play(signal, person, seed, "squats").true_pos_w
        state = labels(pos)
        assert set(state) == {STAND, SIT, UNLABELLED}
        knees = np.stack([knee_angle(pos, side) for side in "lr"])
        assert knees[:, state == SIT].min() > 80.0  # deep, or on their way there
        assert knees[:, state == STAND].max() < 72.0
        shares.append((state == UNLABELLED).mean())
    assert np.mean(shares) < 0.4
    marching = signal_of(4.0, state="walk", cadence=0.8, lift=0.5)
    marched = labels(play(marching, person_of(0), 0, "x").true_pos_w)
    assert SIT not in marched
    assert set(marched[45:75]) <= {WALK, UNLABELLED}  # under way, in the middle
    assert (marched[45:75] == WALK).mean() > 0.5


def test_wide_people_exercise_on_the_spot_and_squat():
    for seed in range(4):
        rng, person = np.random.default_rng(seed), person_of(seed, "wide")
        track = windmill_arms(exercise(rng, 20.0, DRILL), twists=True)
        pos = play(sig.of_track(track), person, seed, "drill").true_pos_w
        assert set(labels(pos)) <= {STAND, UNLABELLED}
        assert (labels(pos) == STAND).mean() > 0.7
        pos = play(squats(rng, 20.0, SQUAT_HOLD_S), person, seed, "squats").true_pos_w
        assert set(labels(pos)) == {STAND, SIT, UNLABELLED}


def test_exercises_move_faster_than_the_library_and_only_stand():
    speed = {}
    for name in ("exercise", "slow"):
        rng, moves = np.random.default_rng(0), []
        for seed in range(4):
            track = exercise(rng, 20.0)
            if name == "slow":
                track = replace(track, **{k: 0.3 * getattr(track, k) for k in ("tilt", "reach")})
            assert track.state == "stand"
            assert np.count_nonzero(track.reach.max(axis=0)) <= 2
            assert not (track.reach > 0).all(axis=1).any()
            pos = play(sig.of_track(track), person_of(seed), seed, name).true_pos_w
            moves.append(np.abs(np.diff(trunk_tilt(pos), axis=0)).mean() / DT)
        speed[name] = np.mean(moves)
    assert speed["exercise"] > 2.0 * speed["slow"]
    assert speed["exercise"] > 12.0  # degrees a second, on the mean over axes and rests


def test_the_families_move_differently():
    wave = {}
    for family in FAMILIES:
        curves = []
        for seed in range(12):
            person = person_of(seed, family)
            pos = show(person, 20.0, state="walk", cadence=0.5, lift=0.5)[300:540]
            lift = joint(pos, "l_ankle")[:, 2]
            lift = (lift - lift.min()) / np.ptp(lift)
            curves.append([np.mean(lift > level) for level in (0.1, 0.5, 0.9)])
        wave[family] = np.array(curves)
    # How long a foot stays above a tenth, a half and nine tenths of its height.
    spread = np.linalg.norm(wave["default"].std(axis=0))
    apart = [np.linalg.norm(wave["default"] - c, axis=1).min() for c in wave["held_out"]]
    assert np.median(apart) > 0.15 * spread
    assert {person_of(s, "held_out").habits.profile for s in range(12)} == {"trapezoid", "hasty"}
    with pytest.raises(StudioError, match="held_out"):
        Person.sample(np.random.default_rng(0), "third")


def test_the_tour_visits_every_state_within_40_seconds():
    signal, tasks = tour_signal()
    assert len(signal) == len(tasks)
    assert len(signal) * DT <= 40.0
    assert {beat.state for beat in TOUR} == {"stand", "walk", "sit"}
    tilt = np.degrees(signal[:, sig.TILT])
    assert (tilt.max(axis=0) > 15).all()
    assert (tilt.min(axis=0) < -15).all()
    stand = (signal[:, sig.WALK] == 0) & (signal[:, sig.SIT] == 0)
    assert signal[stand][:, sig.REACH].max(axis=0).min() > 0.8
    assert signal[signal[:, sig.SIT] == 1][:, sig.REACH].min(axis=1).max() > 0.7
    turn = signal[:, sig.TURN]
    assert turn.max() > 0.18
    assert turn.min() < -0.18
    assert signal[:, sig.CROUCH].max() == pytest.approx(1.0)
    assert signal[0, [sig.WALK, sig.SIT]].max() == signal[-1, [sig.WALK, sig.SIT]].max() == 0


def test_the_tour_shows_every_task_of_the_library():
    library = pytest.importorskip("studio.reference.library")
    assert set(tour_signal()[1]) == set(library.TASKS)


def test_a_task_can_be_repeated_and_an_unknown_one_names_the_known():
    library = pytest.importorskip("studio.reference.library")
    for name, task in library.TASKS.items():
        source = OperatorSource(name, seed=2)
        assert source.name == f"operator:{name}"
        poses = [source.read(i * DT) for i in range(0, 330, 3)]
        knees = knee_angle(np.stack([p.joint_pos_w for p in poses if p]), "l")
        assert (knees.min() > 80.0) == (task.state == "sit")
    with pytest.raises(StudioError, match="tilt"):
        OperatorSource("juggle")


def test_the_operator_is_an_endless_source_that_gives_each_frame_once():
    source = OperatorSource(seed=4)
    assert isinstance(source, Source)
    assert source.starts_live
    assert source.duration is None
    first = source.read(0.0)
    assert first is not None
    assert first.t == 0.0
    assert source.read(0.01) is None
    second, much_later = source.read(DT - 1e-4), source.read(97.0)
    assert second is not None
    assert second.t == pytest.approx(DT)
    assert much_later is not None
    assert much_later.t == pytest.approx(97.0)
    again = OperatorSource(seed=4)
    skipped = again.read(97.0)
    assert skipped is not None
    assert np.array_equal(skipped.joint_pos_w, much_later.joint_pos_w)
    assert len(source.calibration_poses()) >= 10
    source.close()


def test_the_interactive_operator_does_what_was_asked_for_last():
    source = InteractiveOperator(seed=3)
    assert isinstance(source, Source)

    def asks(*intents: Intent) -> None:
        thread = threading.Thread(target=lambda: [source.set_intent(i) for i in intents])
        thread.start()
        thread.join()

    def after(seconds: float) -> np.ndarray:
        nonlocal now
        poses = [source.read((now + i) * DT) for i in range(round(seconds / DT))]
        now += len(poses)
        return np.stack([p.joint_pos_w for p in poses if p is not None])

    now = 0
    rest = after(1.0)
    asks(Intent(crouch=1.0), Intent(reach=np.array([1.0, 0.0])))
    reached = after(2.0)
    assert joint(rest, "r_wrist")[-1, 2] < joint(rest, "chest")[-1, 2]
    assert joint(reached, "r_wrist")[-1, 2] > joint(reached, "head")[-1, 2]
    assert np.linalg.norm(np.diff(reached, axis=0), axis=-1).max() / DT < 8.0
    asks(Intent(state="walk", cadence=1.0, lift=0.5))
    walked = after(6.0)
    up = joint(walked, "l_ankle")[:, 2] > joint(rest, "l_ankle")[0, 2] + 0.05
    assert np.count_nonzero(up[1:] & ~up[:-1]) in (5, 6)
