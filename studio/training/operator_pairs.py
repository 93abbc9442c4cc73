"""Pairs of a synthetic person's triplets and the robot's: what a mapper learns from.

An intent track is acted out by a random person and realised on the robot; the two are aligned by
the person's known delay, and the person is seen through the same causal features as live.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.geometry.time_scaling import smoothstep
from studio.human.calibration import Calibration, calibrate
from studio.human.features import clip_features, mirror_features
from studio.human.pose import HumanClip
from studio.reference.intent import IntentTrack, StateName
from studio.reference.labels import label_motion, mirror_labels
from studio.reference.library import TASKS, task_names
from studio.reference.motion import ReferenceMotion
from studio.reference.realize import realize
from studio.retarget.mapper import RATES
from studio.synthetic import Habits, Person, exercise, play
from studio.synthetic import signals as sig
from studio.synthetic.exercises import USUAL, windmill_arms
from studio.synthetic.idle import AT_REST
from studio.synthetic.person import family_of
from studio.synthetic.wide import DRILL
from studio.timing import CONTROL_HZ

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

POSE = ("joint_pos", "base_quat", "base_pos", "contact")
"""The labels that are no rates, fields of a PairSet."""
KNOWN_AFTER = 15
"""Control periods of a performance that are no pairs."""
EXERCISE_SHARE = 0.4
"""Share of standing performances at people's own brisk pace: library tasks are the robot's."""
WIDE_EXERCISE_SHARE = 0.7
ELBOW_SHARE, REST_SHARE, BOTH_SHARE = 0.7, 0.35, 0.5
"""Of standing people: who raise a hand elbow first, whose idle hands wander (`idle.AT_REST`), and
who raise both hands where one paw is meant."""


@dataclass(frozen=True, kw_only=True)
class PairSet:
    """N frames of one state: inputs and labels, all in the state's frame (see `retarget.mapper`).

    triplet (N, 3F), joint_pos (N, 12), base_quat (N, 4), rates (N, 36), contact (N, 4);
    clip (N,): which performance a frame came from; base_pos (N, 3), world.
    """

    triplet: Array32
    joint_pos: Array32
    base_quat: Array32
    rates: Array32
    contact: Array32
    base_pos: Array32
    clip: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.triplet)

    def take(self, rows: NDArray) -> "PairSet":
        """Some rows, by index or mask."""
        return PairSet(**{name: getattr(self, name)[rows] for name in self.__dataclass_fields__})

    @classmethod
    def of(cls, triplet: NDArray, labels: Mapping[str, NDArray], clip: NDArray) -> "PairSet":
        """Of triplets (N, 3F) and what `label_motion` says of the same frames."""
        rates = np.concatenate([labels[name] for name in RATES], axis=1)
        pose = {name: labels[name].astype(np.float32) for name in POSE}
        return cls(
            triplet=triplet.astype(np.float32), rates=rates.astype(np.float32),
            clip=clip.astype(np.int64), **pose,
        )  # fmt: skip

    @staticmethod
    def join(parts: "list[PairSet]") -> "PairSet":
        """One set of many, clips renumbered."""
        fields: dict[str, NDArray] = {
            name: np.concatenate([getattr(p, name) for p in parts])
            for name in PairSet.__dataclass_fields__
        }
        fields["clip"] = np.concatenate([np.full(len(p), i) for i, p in enumerate(parts)])
        return PairSet(**fields)


def performances(
    state: StateName,
    rng: np.random.Generator,
    seconds: float,
    *,
    family: str = "default",
    style: str = "march",
    clip_seconds: float = 6.0,
) -> Iterator[PairSet]:
    """Performances of a state's tasks by ever new people, until there are `seconds` of them.

    Every second one is also given mirrored. Short ones, so that there are many people: with a
    quarter as many, an expert erred twice as much on new people as on those it knew.
    family: see `Person.sample`, or `MIXED`.
    """
    done = 0.0
    for track, robot, person in acts(state, rng, family, style, clip_seconds):
        if done >= seconds:
            return
        both = track is not robot  # and the right one is meant
        if track.task == "exercise" and not both:
            track = windmill_arms(track, twists=person.family == "wide" and rng.random() < 0.5)
        pairs = pair_up(track, realize(robot), person, rng)
        done += len(pairs) / CONTROL_HZ
        yield pairs
        if not both and rng.random() < 0.5:
            yield mirrored(pairs)
            done += len(pairs) / CONTROL_HZ


def acts(
    state: StateName, rng: np.random.Generator, family: str, style: str, clip_seconds: float
) -> Iterator[tuple[IntentTrack, IntentTrack, Person]]:
    """Without end: what a person means in acting out a task of a state, what the robot is to make
    of it (the same, but where both arms rise), and who it is."""
    tasks = task_names(state)
    while True:
        one = family_of(family, rng)
        share, drill = (WIDE_EXERCISE_SHARE, DRILL) if one == "wide" else (EXERCISE_SHARE, USUAL)
        name = str(rng.choice(tasks, p=np.full(len(tasks), 1.0 / len(tasks))))
        if state == "stand" and rng.random() < share:
            track = exercise(rng, clip_seconds, drill)
        else:
            track = TASKS[name].sample(rng, clip_seconds, float(rng.uniform(0.3, 1.0)))
        person = Person.sample(rng, one, style=style).still()
        if state == "stand":
            person = replace(person, habits=own_way(person.habits, rng))
        robot = track
        if state == "stand" and np.any(track.reach > 0.3) and rng.random() < BOTH_SHARE:
            track, robot = both_arms(track, rng)
        yield track, robot, person


def own_way(habits: Habits, rng: np.random.Generator) -> Habits:
    """Habits of standing arms: most people raise a hand elbow first, and hands that rest do
    so anywhere below the shoulders."""
    return replace(
        habits,
        raise_elbow=rng.uniform(0.3, 1.0) if rng.random() < ELBOW_SHARE else 0.0,
        idle_gestures=AT_REST,
        idle_gesture_gap_s=rng.uniform(1.0, 3.0) if rng.random() < REST_SHARE else float("inf"),
    )


def both_arms(track: IntentTrack, rng: np.random.Generator) -> tuple[IntentTrack, IntentTrack]:
    """A standing track in which both arms rise, for the person, and what the robot makes of it.

    A stand can raise one paw only: that of the higher arm, and of the right one among equals.
    People raise both arms all the time; without such frames a mapper would raise both, or none.
    """
    up = track.reach.max(axis=1)
    side = track.reach_side[np.arange(len(track)), track.reach.argmax(axis=1)]
    shares = np.clip(1.0 - np.abs(rng.normal(0.0, 0.12, 2)), 0.6, 1.0)
    reach = up[:, None] * shares
    # Arms go out to both sides alike, or forward.
    out = np.abs(side)[:, None] * np.array([-1.0, 1.0])
    human = replace(track, reach=reach, reach_side=out)
    lead = reach[:, 0] - reach[:, 1] + 0.15
    share = smoothstep((lead / 0.2 + 1.0) / 2.0)
    robot = replace(
        human, reach=np.stack([reach[:, 0] * (share > 0.5), reach[:, 1] * (share <= 0.5)], -1)
    )
    return human, robot


def pair_up(
    track: IntentTrack, motion: ReferenceMotion, person: Person, rng: np.random.Generator
) -> PairSet:
    """One performance's pairs: acted, warped in time, seen, aligned."""
    triplet, pose = aligned(track, motion, person, rng)
    labels = label_motion(track.state, *pose, motion.dt)
    # A person who was not scanned takes a second to be known; the filter half of one to settle.
    keep = slice(KNOWN_AFTER, None)
    labels = {name: x[keep] for name, x in labels.items()}
    return PairSet.of(triplet[keep], labels, np.zeros(len(triplet[keep]), dtype=np.int64))


def aligned(
    track: IntentTrack, motion: ReferenceMotion, person: Person, rng: np.random.Generator
) -> tuple[Array, tuple[Array, Array, Array]]:
    """Triplets (T, 3F) of a person who acts, and the robot's motion of the same periods: base
    (T, 3) and (T, 4) in the world, joints (T, 12)."""
    performance = play(sig.of_track(track), person, rng, track.task)
    shift = performance.delay_frames
    clip, n = performance.clip, len(track) - shift
    if n < 30:
        raise ValueError(f"track of {len(track)} frames is shorter than its performer's delay")
    at = _time_warp(n, rng)
    seen = HumanClip(
        name=clip.name,
        t=np.arange(len(at)) / CONTROL_HZ,
        joint_pos_w=_sample(clip.joint_pos_w[shift:], at),
        confidence=np.minimum(
            clip.confidence[shift:][np.floor(at).astype(int)],
            clip.confidence[shift:][np.ceil(at).astype(int)],
        ),
    )
    # A file is scanned ahead, a live person is not: learn from both.
    known = calibrate([seen[i] for i in range(0, len(seen), 15)])
    triplet = np.concatenate(
        clip_features(seen, known if rng.random() < 0.7 else Calibration()), axis=-1
    )
    return triplet, (
        _sample(motion.base_pos[:n], at),
        geometry.normalize(_sample(motion.base_quat[:n], at)),
        _sample(motion.joint_pos[:n], at),
    )


def mirrored(pairs: PairSet) -> PairSet:
    """Both mirrored in their x-z planes: left arm and left paw become right."""
    labels: dict[str, NDArray] = {name: getattr(pairs, name) for name in POSE}
    labels |= {name: pairs.rates[:, part] for name, part in RATES.items()}
    return PairSet.of(mirror_features(pairs.triplet), mirror_labels(labels), pairs.clip)


def _time_warp(n: int, rng: np.random.Generator, most: float = 0.15) -> Array:
    """(M,) positions in [0, n - 1] at which to sample n frames: speeds within 1 ± most."""
    period = rng.uniform(2.0, 5.0) * CONTROL_HZ
    steps = 1.0 + rng.uniform(0.0, most) * np.sin(
        2.0 * np.pi * (np.arange(2 * n) / period + rng.random())
    )
    steps *= 1.0 + rng.uniform(-0.5, 0.5) * most
    at = np.cumsum(steps) - steps[0]
    return at[at <= n - 1]


def _sample(x: Array, at: Array) -> Array:
    low = np.floor(at).astype(int)
    high = np.minimum(low + 1, len(x) - 1)
    w = (at - low).reshape(-1, *([1] * (x.ndim - 1)))
    return (1.0 - w) * x[low] + w * x[high]
