"""Arrays to IntentTracks: what is not given rests at zero."""

import numpy as np
from numpy.typing import NDArray

from studio.reference.intent import IntentTrack, StateName
from studio.robot import a1

Array = NDArray[np.float64]

_SHAPES: dict[str, tuple[int, ...]] = {
    "tilt": (3,),
    "crouch": (),
    "reach": (2,),
    "reach_side": (2,),
    "speed": (),
    "turn": (),
    "phase": (),
    "cadence": (),
    "lift": (),
    "side": (),
}


def make_track(
    state: StateName, task: str, length: int, dt: float = a1.CONTROL_DT, **fields: Array
) -> IntentTrack:
    """An IntentTrack of `length` frames with the given fields (T, ...), the others zero."""
    full = {name: np.zeros((length, *shape)) for name, shape in _SHAPES.items()}
    for name, value in fields.items():
        assert full[name].shape == np.shape(value), f"{name} must be {full[name].shape}"
        full[name] = np.asarray(value, dtype=np.float64)
    return IntentTrack(state=state, task=task, dt=dt, **full)


def frames_in(seconds: float, dt: float = a1.CONTROL_DT) -> int:
    """Number of frames of a track of this length: at least one."""
    return max(1, round(seconds / dt))
