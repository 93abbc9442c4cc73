"""Kim, Xie, van de Panne 2020: phase, frequency and amplitude from a latent shared by two systems.

Source: N. H. Kim, Z. Xie, M. van de Panne, "Learning to Correspond Dynamical Systems", L4DC 2020:
trajectories of two systems, planar walkers among them, share a latent state and its dynamics (what
the paper says of its rival (A) fits this one; our copy has no bibliography).

Kept: the state of a cycle as what both share. It is found by PCA of how each moves in its sagittal
plane, the person's joints (x, z) and the robot's thighs and calves; the latent is the first
component and its velocity, a point on a circle: angle (phase), speed (frequency), radius
(amplitude). What corresponds is an angle between both circles. The latent's dynamics is the gait
generator. Not kept: their recurrent autoencoders.

Input: whole performances. Limits: one cycle, straight ahead, in the plane; who stands or sits has
no phase, and pairs without one are refused.
"""

import math
from collections import deque
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.errors import StudioError
from studio.human.features import FEATURE_DIM
from studio.reference import gait
from studio.reference.intent import StateName
from studio.reference.stepping import Stepper
from studio.retarget.baselines.frames import Pairs
from studio.retarget.mapper import RATES, FrameByFrame, Mapped
from studio.retarget.striding import Striding
from studio.robot.a1 import CONTROL_DT

Array = NDArray[np.float64]

WINDOW = 45
"""Control periods (1.5 s) over which frequency and amplitude are read."""
STILL = 0.03
"""m: a smaller amplitude of the latent is no march."""
CADENCES = (0.3, 2.3)
"""Strides a second that the generator is driven at."""
PULL = 0.15
"""Share of the phase's error that is made up for in a control period."""
GOING = 0.45
"""Least share of the time that both go round: walks have .65, stands up to .29, sits .08."""
AGREE = 0.3
"""Least agreement of both phases (1: always the same angle between them): walks have .44 to .75."""
_SAGITTAL = np.array([i for i in range(FEATURE_DIM - 1) if i % 3 != 1])  # x and z of q
_SWING_JOINTS = np.array([j for j in range(12) if j % 3])  # thighs and calves


class Cycle:
    """Reads phase (rad), frequency (1/s) and amplitude off a place and its rate. One thread."""

    def __init__(self) -> None:
        self._seen: deque[tuple[float, float]] = deque(maxlen=WINDOW)
        self.phase, self.frequency, self.amplitude = 0.0, 0.0, 0.0

    def step(self, place: float, rate: float) -> None:
        """One more control period."""
        self._seen.append((place, rate))
        seen = np.array(self._seen)
        middle = float(seen[:, 0].mean())
        size, speed = float(seen[:, 0].std()), float(np.sqrt(np.mean(seen[:, 1] ** 2)))
        omega = max(speed / max(size, 1e-6), 1e-6)
        self.phase = math.atan2(-rate / omega, place - middle)
        self.frequency = omega / (2.0 * math.pi)
        self.amplitude = math.sqrt(2.0) * size


class Kim2020(FrameByFrame):
    """The walk expert: `axis` (F,) of q is the person's latent, `ahead` rad the robot's lead."""

    def __init__(self, axis: Array, ahead: float, speed: Array) -> None:
        self.axis, self.ahead, self.speed = axis, ahead, speed

    @classmethod
    def fit(cls, state: StateName, pairs: Pairs, seed: int = 0) -> "Kim2020":
        """Of whole performances. StudioError where person and robot share no cycle."""
        del seed
        human = np.zeros(FEATURE_DIM)
        qd = pairs.triplet[:, FEATURE_DIM : 2 * FEATURE_DIM][:, _SAGITTAL]
        human[_SAGITTAL] = _first_component(qd)
        joint_vel = pairs.rates[:, RATES["joint_vel"]][:, _SWING_JOINTS]
        robot = _first_component(joint_vel)
        person, marches = _read(pairs.triplet @ _doubled(human), pairs.clip)
        joint_pos = pairs.joint_pos[:, _SWING_JOINTS]
        own, _ = _read(np.stack([joint_pos @ robot, joint_vel @ robot], axis=1), pairs.clip)
        moving = marches & (np.abs(joint_vel).max(axis=1) > 0.3)
        between = np.exp(1j * (own[:, 0] - person[:, 0]))[moving]
        going, agree = float(np.mean(moving)), abs(np.mean(between)) if len(between) else 0.0
        if going < GOING or agree < AGREE:
            raise StudioError(
                f"kim2020 maps cycles alone, and these pairs of {state} are none (in motion "
                f"{going:.0%} of the time, phases agree to {agree:.2f}): use it with --state walk, "
                "or choose dontcheva2003, yamane2010, seol2013 or gmr"
            )
        ahead = float(np.angle(between.mean()) - np.angle(np.mean(_generated(robot))))
        known = _speed_terms(person[moving, 1], person[moving, 2])
        forward = pairs.rates[moving, RATES["base_lin_vel"].start]
        speed: Array = np.linalg.lstsq(known, forward, rcond=None)[0].astype(float)
        return cls(human, ahead, speed)

    def begin(self) -> "_March":
        """Start anew on somebody's march."""
        return _March(self)


class _March:
    """One person's march in progress, and the generator that it drives. One thread."""

    remembers = True

    def __init__(self, map_: Kim2020) -> None:
        self._map, self._axes = map_, _doubled(map_.axis)
        self._cycle, self._stepper, self._striding = Cycle(), Stepper("kim2020"), Striding()

    def __call__(self, triplet: NDArray) -> Mapped:
        """One control period's triplet (3F,) to what an expert says of it."""
        cycle, stepper = self._cycle, self._stepper
        cycle.step(*(triplet @ self._axes).tolist())
        goal = speed = lift = 0.0
        if cycle.amplitude > STILL:
            goal = min(max(cycle.frequency, CADENCES[0]), CADENCES[1])
            terms = _speed_terms(np.array([cycle.frequency]), np.array([cycle.amplitude]))
            speed = float(np.clip(terms @ self._map.speed, 0.0, gait.speed_limit(goal))[0])
            lift = max(0.3, float(gait.march_lift(goal, speed)))
        before = stepper.phase
        intent = stepper.step(CONTROL_DT, goal, speed)
        if goal > 0.0:
            late = stepper.behind((cycle.phase + self._map.ahead) / (2.0 * math.pi))
            stepper.phase = max(before, stepper.phase + PULL * late)
            intent = replace(intent, phase=stepper.phase, lift=lift)
        return _in_plane(self._striding.step(intent))


def _first_component(rows: NDArray) -> Array:
    """The unit vector along which rows (N, D) vary most."""
    _, vectors = np.linalg.eigh(np.cov(np.asarray(rows, np.float64), rowvar=False))
    axis = vectors[:, -1]
    return axis * np.sign(axis[np.argmax(np.abs(axis))])


def _doubled(axis: Array) -> Array:
    """(3F, 2): what makes place and velocity along an axis (F,) of a triplet."""
    out = np.zeros((3 * FEATURE_DIM, 2))
    out[:FEATURE_DIM, 0] = out[FEATURE_DIM : 2 * FEATURE_DIM, 1] = axis
    return out


def _read(latent: Array, clip: NDArray) -> tuple[Array, NDArray[np.bool_]]:
    """(N, 3) phase, frequency, amplitude of latents (N, 2), clip by clip; (N,) once they are
    known and something moves."""
    out, known = np.zeros((len(latent), 3)), np.zeros(len(latent), dtype=bool)
    for c in np.unique(clip):
        cycle = Cycle()
        for k, i in enumerate(np.flatnonzero(clip == c)):
            cycle.step(*latent[i].tolist())
            out[i] = cycle.phase, cycle.frequency, cycle.amplitude
            known[i] = k >= WINDOW and cycle.amplitude > STILL
    return out, known


def _generated(robot: Array) -> Array:
    """exp(i (the robot's phase − the generator's)) of walks at several cadences."""
    found = []
    for cadence in (0.5, 0.9, 1.5):
        stepper, striding, cycle = Stepper("kim2020"), Striding(), Cycle()
        speed = 0.5 * float(gait.speed_limit(cadence))
        for k in range(180):
            mapped = striding.step(stepper.step(CONTROL_DT, cadence, speed))
            joint_vel = mapped.rates[RATES["joint_vel"]]
            cycle.step(*(float(x[_SWING_JOINTS] @ robot) for x in (mapped.joint_pos, joint_vel)))
            if k > 2 * WINDOW:
                found.append(cycle.phase - 2.0 * math.pi * stepper.phase)
    return np.exp(1j * np.array(found))


def _speed_terms(frequency: Array, amplitude: Array) -> Array:
    return np.stack([np.ones_like(frequency), frequency, amplitude, frequency * amplitude], axis=-1)


def _in_plane(mapped: Mapped) -> Mapped:
    """The same without what leaves the sagittal plane: hips, roll, yaw, sideways motion."""
    joints, rates = mapped.joint_pos.copy(), mapped.rates.copy()
    joints[0::3] = 0.0
    rates[RATES["joint_vel"]][0::3] = rates[RATES["base_lin_vel"].start + 1] = 0.0
    rates[RATES["base_ang_vel"]][[0, 2]] = 0.0
    pitch = geometry.quat_to_rpy(mapped.base_quat)[1]
    return replace(
        mapped,
        joint_pos=joints,
        base_quat=geometry.quat_from_rpy(np.array([0.0, pitch, 0.0])),
        rates=rates,
        turn=0.0,
    )
