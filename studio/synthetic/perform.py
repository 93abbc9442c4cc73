"""Performer: intents in, human poses out, causal and online; `perform` runs a track at once."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.geometry import scalars
from studio.human.pose import HumanClip, HumanPose
from studio.reference.intent import Intent, IntentTrack
from studio.synthetic import signals as sig
from studio.synthetic.acting import act, marching
from studio.synthetic.filters import Fir, MeanCadence, movement_kernel
from studio.synthetic.forward_kinematics import joints
from studio.synthetic.idle import IdleGestures, Sway
from studio.synthetic.person import Person
from studio.synthetic.sensor import SensorState
from studio.synthetic.signals import DT

Array = NDArray[np.float64]
_SETTLE_S = 0.27  # s in which a foot in the air is put down when a march stops
_POSTURE_S = 0.7  # s in which the arms and the trunk take up a marcher's posture


@dataclass(frozen=True, kw_only=True)
class Performance:
    """A track as performed.

    clip: what the sensor saw, frame i at i / 30 s. true_pos_w: (T, 19, 3) m, before the sensor.
    idle: (T, 2) in [0, 1], how much the (right, left) arm does something nobody asked for.
    pace: (T,) in [0, 1], how far arms and trunk have taken up walking, in the person's style.
    delay_s: frame i shows the intent of time t[i] - delay_s.
    """

    clip: HumanClip
    true_pos_w: Array
    idle: Array
    pace: Array
    delay_s: float

    @property
    def delay_frames(self) -> int:
        """`delay_s` in whole frames: clip[i] pairs with track[i - delay_frames]."""
        return round(self.delay_s / DT)


class Performer:
    """One person acting. Steps of 1/30 s; one thread. The same person and rng, the same motion."""

    def __init__(self, person: Person, rng: np.random.Generator | int = 0) -> None:
        self.person = person
        self._rng = np.random.default_rng(rng)
        self.reset()

    def reset(self) -> None:
        """Start over in whatever the next intent asks for, with other chance movements."""
        person, h = self.person, self.person.habits
        sway, gestures, sensor = self._rng.spawn(3)
        self._sway, self._gestures = Sway(person, sway), IdleGestures(person, gestures)
        self._sensor = SensorState(person.sensor, sensor)
        wait = np.zeros(round(person.reaction_delay / DT))
        self._follow = Fir(person.follow_kernel())
        self._change = Fir(np.concatenate([wait, movement_kernel(h.change_s, DT, h.profile)]))
        self._tempo = MeanCadence()
        self._settle = Fir(movement_kernel(_SETTLE_S, DT, h.profile))
        self._posture = Fir(movement_kernel(_POSTURE_S, DT, h.profile))
        self._circles = Fir(movement_kernel(_POSTURE_S, DT, h.profile))
        self._last_phase: float | None = None
        self._strides = 0.0
        self.pace = np.zeros(0)  # of the frames last performed, see Performance

    def set_style(self, style: str) -> None:
        """Mean walking by another motion from the next frame on; arms and legs ease into it."""
        self.person = replace(self.person, style=style)

    def advance(self, signal: Array) -> tuple[Array, Array, Array, Array]:
        """The next T frames of a signal (T, NUM).

        Returns seen joints (T, 19, 3) m, confidence (T, 19), true joints and idleness (T, 2).
        """
        steps = len(signal)
        s = signal.copy()
        s[:, sig.PHASE] = self._unwrap(signal[:, sig.PHASE], signal[:, sig.WALK])
        states = self._change(s[:, [sig.WALK, sig.SIT]])
        s = self._follow(s)
        s[:, [sig.WALK, sig.SIT]] = states
        tempo = self._tempo(s[:, sig.CADENCE])
        legs, pace = self._settle(marching(s)), self._posture(marching(s))
        self.pace = pace
        circles = self._circles(np.full(steps, float(self.person.style == "circles")))
        posture, idle = act(
            self.person, s, tempo, legs, pace, circles, *self._sway(steps), *self._gestures(steps)
        )
        true = joints(self.person.body, posture)
        true = geometry.quat_rotate(scalars.yaw(self.person.habits.facing), true)
        seen, confidence = self._sensor.see(true)
        return seen, confidence, true, idle

    def step(self, intent: Intent, t: float) -> HumanPose:
        """The pose at time t (s), one control period after the last, of somebody who means this."""
        seen, confidence, _, _ = self.advance(sig.of_intents([intent]))
        return HumanPose(t=t, joint_pos_w=seen[0], confidence=confidence[0])

    def _unwrap(self, phase: Array, walk: Array) -> Array:
        """Strides without jumps: a track that starts its phase anew is met at the same fraction.

        Whatever the phase says while nobody walks, the feet make nothing of it.
        """
        if self._last_phase is None:
            self._strides = self._last_phase = float(phase[0])
        walked = np.maximum.accumulate(np.where(walk > 0.5, np.arange(len(phase)), -1))
        held = np.where(walked >= 0, phase[walked], self._last_phase)
        steps = np.diff(held, prepend=self._last_phase)
        strides: Array = self._strides + np.cumsum(steps - np.round(steps), dtype=np.float64)
        self._last_phase, self._strides = float(held[-1]), float(strides[-1])
        return strides


def play(signal: Array, person: Person, rng: np.random.Generator | int, name: str) -> Performance:
    """A whole signal (T, NUM) at 30 Hz, performed."""
    performer = Performer(person, rng)
    seen, confidence, true, idle = performer.advance(signal)
    clip = HumanClip(
        name=name,
        t=np.arange(len(signal), dtype=np.float64) * DT,
        joint_pos_w=seen,
        confidence=confidence,
    )
    return Performance(
        clip=clip, true_pos_w=true, idle=idle, pace=performer.pace, delay_s=person.delay_s
    )


def perform(track: IntentTrack, person: Person, rng: np.random.Generator | int = 0) -> HumanClip:
    """What a sensor saw of a person acting out a track; `play` returns more than the clip.

    The clip starts settled in the track's first intent and trails it by `person.delay_s`.
    """
    return play(sig.of_track(track), person, rng, track.task).clip
