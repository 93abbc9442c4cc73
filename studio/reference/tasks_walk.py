"""Walking tasks: marching in place is what a person does, walking and turning what is meant."""

import numpy as np

from studio.reference import gait
from studio.reference.intent import IntentTrack
from studio.reference.marching import Bout, march_track
from studio.reference.task import Task, amplitude, draw_cadence, draw_lift

MAX_TURN = float(np.radians(15.0))


def _walk(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """Walk straight on: 0 to 0.97 m/s, by a crawl or a trot as the cadence asks."""
    top = gait.MAX_SPEED * amplitude(difficulty)
    cadence = draw_cadence(rng)
    bout = Bout(
        half_strides=int(np.ceil(2.0 * seconds * cadence)),
        cadence=cadence,
        lift=draw_lift(rng, cadence, top),
        ramp=float(rng.uniform(0.4, 1.2)),
    )
    crouch = float(rng.uniform(0.0, 1.0)) if rng.random() < 0.3 else 0.0
    return march_track("walk", seconds, [bout], lead=float(rng.uniform(0.1, 0.6)), crouch=crouch)


def _turn(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """Walk and turn: up to 15 degrees a second to either side, changing on the way."""
    size = amplitude(difficulty)
    cadence = draw_cadence(rng)
    lift = draw_lift(rng, cadence, gait.MAX_SPEED * size)
    bouts, gone = [], 0.0
    while gone < seconds:
        half_strides = int(rng.integers(3, 9))
        turn = float(rng.uniform(-1.0, 1.0) * MAX_TURN * size)
        bouts.append(Bout(half_strides=half_strides, cadence=cadence, lift=lift, turn=turn))
        gone += 0.5 * half_strides / cadence
    return march_track("turn", seconds, bouts, lead=float(rng.uniform(0.1, 0.6)))


def _march(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """March as people do in place: a few steps, a pause, steps at another pace, a stop."""
    size = amplitude(difficulty)
    bouts, gone = [], 0.0
    while gone < seconds:
        cadence = draw_cadence(rng, fastest=1.8)
        bout = Bout(
            half_strides=int(rng.integers(2, 9)),
            cadence=cadence,
            lift=draw_lift(rng, cadence, gait.MAX_SPEED * size),
            turn=float(rng.uniform(-1.0, 1.0) * MAX_TURN * size) if rng.random() < 0.3 else 0.0,
            pause=float(rng.uniform(0.1, 1.5)),
            ramp=float(rng.uniform(0.3, 1.0)),
        )
        bouts.append(bout)
        gone += 0.5 * bout.half_strides / cadence + bout.pause
    return march_track("march", seconds, bouts, lead=float(rng.uniform(0.1, 1.0)))


WALK_TASKS = (
    Task(name="walk", state="walk", draw=_walk),
    Task(name="turn", state="walk", draw=_turn),
    Task(name="march", state="walk", draw=_march),
)
