"""People who change their minds: sequences over all states, labelled frame by frame by geometry.

The selector must tell stand, walk and sit apart within half a second, whatever the arms do. So
its frames come from long sequences in which people stand about, tilt, reach, crouch, march, squat
quickly or sit for a while; and the label of a frame is what the body does, not what was meant.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.human.calibration import Calibration, calibrate
from studio.human.features import clip_features
from studio.human.skeleton import INDEX
from studio.reference.library import TASKS, task_names
from studio.retarget.selector import NAMES, SELECTOR_CUTOFF_HZ, TripletFilter
from studio.synthetic import Performance, Person, exercise, play, squats
from studio.synthetic import signals as sig
from studio.synthetic.exercises import windmill_arms
from studio.synthetic.person import family_of
from studio.synthetic.wide import DRILL, SQUAT_HOLD_S
from studio.timing import CONTROL_DT, CONTROL_HZ

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

STAND, WALK, SIT = range(len(NAMES))
UNLABELLED = -1
SIT_KNEE, STAND_KNEE = np.radians(85.0), np.radians(72.0)
"""Both knees flexed beyond the first: sitting; neither beyond the second: standing."""
APART = 0.05
"""m: an ankle this much higher above where it stands than the other is lifted."""
STEP_GAP = 0.55
"""s: a march goes on between lifts no longer apart than twice this; then it is a stand."""
CIRCLES, RESTS = 0.7, 0.05
"""Share of the full pace of circling from which hands go round, and up to which they rest."""
BUSY = 0.1
"""Share of an idle gesture from which somebody does it."""
MARCHERS = 6
"""One in so many people marches where walking is circling the hands."""
LENGTH: dict[str, tuple[float, float]] = {
    "stand": (2.0, 7.0),
    "walk": (3.0, 8.0),
    "sit": (0.7, 5.0),
    "exercise": (3.0, 8.0),
    "squats": (3.0, 8.0),
}
"""s that each kind of stretch in a sequence lasts: a state's tasks, or people's own ways."""


@dataclass(frozen=True, kw_only=True)
class Frames:
    """N labelled frames: triplet (N, 3F) filtered as the selector's, label (N,), person (N,)."""

    triplet: Array32
    label: NDArray[np.int64]
    person: NDArray[np.int64]

    def take(self, rows: NDArray) -> "Frames":
        """Some rows, by index or mask."""
        return Frames(triplet=self.triplet[rows], label=self.label[rows], person=self.person[rows])


def sequences(
    rng: np.random.Generator,
    seconds: float,
    *,
    family: str = "default",
    style: str = "march",
    each: float = 30.0,
) -> Iterator[Frames]:
    """One person after another, `each` seconds long, until there are `seconds` of them."""
    for person_id in range(max(1, round(seconds / each))):
        one = family_of(family, rng)
        person = Person.sample(rng, one, style=style)
        # Where walking is circling the hands, whoever marches means nothing by it.
        if style == "circles" and person_id % MARCHERS == 3:
            person = replace(person, style="march")
        habits = person.habits
        # Some people exaggerate: a twist of 100 degrees is still a twist, not a walk.
        more = rng.uniform(1.0, 1.3 if one == "wide" else 1.8)
        person = replace(person, habits=replace(habits, gain=habits.gain * more))
        performance = play(sequence(rng, each, one), person, rng, "sequence")
        clip = performance.clip
        scanned = rng.random() < 0.7
        known = calibrate([clip[i] for i in range(0, len(clip), 15)]) if scanned else Calibration()
        triplet = np.concatenate(clip_features(clip, known), axis=-1)
        low_pass = TripletFilter(SELECTOR_CUTOFF_HZ, CONTROL_DT)
        filtered = np.stack([low_pass.step(row) for row in triplet])
        label = labels(performance.true_pos_w)
        if style == "circles":
            label = circle_labels(label, performance, person.style == style)
        label[: 30 if not scanned else 10] = UNLABELLED
        keep = label != UNLABELLED
        yield Frames(
            triplet=filtered[keep], label=label[keep], person=np.full(keep.sum(), person_id)
        )


def sequence(rng: np.random.Generator, seconds: float, family: str = "default") -> Array:
    """A signal (T, NUM) of `seconds`: tasks of random states, one after another."""
    parts: list[Array] = []
    frames, last = 0, ""
    while frames < 30 * seconds:
        kind = str(rng.choice([k for k in LENGTH if k != last]))
        span = float(rng.uniform(*LENGTH[kind]))
        part = _part(kind, max(span, 4.0), rng, family)[: round(30 * span)]
        if kind in ("stand", "exercise") and rng.random() < 0.3:
            _both_arms(part, rng)
        parts.append(part)
        frames, last = frames + len(part), kind
    return np.concatenate(parts)


def _part(kind: str, seconds: float, rng: np.random.Generator, family: str) -> Array:
    if kind == "squats":
        return squats(rng, seconds, *([SQUAT_HOLD_S] if family == "wide" else []))
    if kind == "exercise" and family == "wide":
        track = exercise(rng, seconds, DRILL)
        return sig.of_track(windmill_arms(track, twists=rng.random() < 0.5))
    if kind == "exercise":
        return sig.of_track(exercise(rng, seconds))
    task = TASKS[str(rng.choice(task_names(kind)))]
    track = task.sample(rng, seconds, float(rng.uniform(0.3, 1.0)))
    return sig.of_track(track)


def _both_arms(part: Array, rng: np.random.Generator) -> None:
    """Whatever else is done, the arms go up, out or round together or in turn, as in gymnastics."""
    t = np.arange(len(part)) / CONTROL_HZ
    rate, lag = rng.uniform(0.1, 0.7), rng.choice([0.0, 0.5])
    low, high = np.sort(rng.uniform(0.1, 0.9, 2))
    for arm, sign in enumerate((-1.0, 1.0)):
        wave = 0.5 - 0.5 * np.cos(2.0 * np.pi * (rate * t + lag * arm))
        part[:, sig.REACH.start + arm] = low + (high - low) * wave
        part[:, sig.SIDE.start + arm] = sign * rng.uniform(0.0, 1.0)


def knee_flexion(joint_pos: Array) -> Array:
    """(T, 2) rad flexion of the left and right knee of joints (T, 19, 3)."""
    out = []
    for side in "lr":
        hip, knee, ankle = (joint_pos[:, INDEX[f"{side}_{j}"]] for j in ("hip", "knee", "ankle"))
        thigh, shin = knee - hip, ankle - knee
        lengths = np.linalg.norm(thigh, axis=-1) * np.linalg.norm(shin, axis=-1)
        out.append(np.arccos(np.clip(np.sum(thigh * shin, axis=-1) / lengths, -1.0, 1.0)))
    return np.stack(out, axis=-1)


def labels(true_pos_w: Array) -> NDArray[np.int64]:
    """(T,) index into NAMES or UNLABELLED, of true joints (T, 19, 3) m on a floor at z = 0.

    Sit: both knees deep (or on their way there). Walk: a foot is up, or was and will be. Stand:
    both feet down for a while, knees not deep. What lies between carries no label.
    """
    knees = knee_flexion(true_pos_w)
    ankles = true_pos_w[:, [INDEX["l_ankle"], INDEX["r_ankle"]], 2]
    high = ankles - np.percentile(ankles, 5, axis=0)
    # Both heels up is a squat on tiptoe; one foot up is a step.
    up = np.abs(high[:, 0] - high[:, 1]) > APART
    before, after = _since(up), _since(up[::-1])[::-1]
    stepping = (before < STEP_GAP) & (after < STEP_GAP)
    quiet = (before > STEP_GAP) & (after > STEP_GAP)
    deep, bent = knees.min(axis=1), knees.max(axis=1)
    down = np.gradient(deep) > 0.0
    label = np.full(len(knees), UNLABELLED)
    label[quiet & (bent < STAND_KNEE)] = STAND
    label[stepping & (deep < SIT_KNEE)] = WALK
    label[quiet & ((deep > SIT_KNEE) | (down & (deep > STAND_KNEE + 0.14)))] = SIT
    return label


def circle_labels(
    label: NDArray[np.int64], performance: Performance, circles: bool
) -> NDArray[np.int64]:
    """(T,) labels under the style in which circling hands walk, from those of the legs.

    Walk: the hands go round, and neither does anything else. What begins or ends has no label.
    Somebody who does not circle but marches stands, as far as the robot goes.
    """
    if not circles:
        return np.where(label == WALK, STAND, label)
    circling = performance.pace > CIRCLES
    busy = performance.idle.max(axis=1) > BUSY
    walk = circling & ~busy & (label == STAND)
    between = (performance.pace > RESTS) & ~walk & (label == STAND)
    return np.where(walk, WALK, np.where(between, UNLABELLED, label))


def _since(flag: NDArray[np.bool_]) -> Array:
    """(T,) s since the flag was last up; infinite before."""
    last = np.maximum.accumulate(np.where(flag, np.arange(len(flag)), -(10**9)))
    return (np.arange(len(flag)) - last) / CONTROL_HZ
