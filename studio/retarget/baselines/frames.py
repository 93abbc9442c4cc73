"""What every way of mapping frames takes and gives, so that all are fitted and scored alike."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.retarget.mapper import NUM_RATES, Mapped
from studio.robot import a1

Array = NDArray[np.float64]


class FrameMapper(Protocol):
    """Maps triplets (N, 3F) to Mapped values with N rows."""

    def __call__(self, triplet: NDArray) -> Mapped: ...


class Pairs(Protocol):
    """Pairs of one state to fit to, such as a `PairSet`: N frames of performances, in order.

    triplet (N, 3F); joint_pos (N, 12), base_quat (N, 4), rates (N, 36), contact (N, 4) in the
    state's frame (`retarget.mapper`); clip (N,): which performance a frame came from.
    """

    @property
    def triplet(self) -> NDArray: ...
    @property
    def joint_pos(self) -> NDArray: ...
    @property
    def base_quat(self) -> NDArray: ...
    @property
    def rates(self) -> NDArray: ...
    @property
    def contact(self) -> NDArray: ...
    @property
    def clip(self) -> NDArray: ...


@dataclass(frozen=True, kw_only=True)
class Targets:
    """Labels of N frames: joint_pos (N, 12), base_quat (N, 4), rates (N, 36), contact (N, 4)."""

    joint_pos: NDArray
    base_quat: NDArray
    rates: NDArray
    contact: NDArray

    @classmethod
    def of(cls, pairs: Pairs) -> "Targets":
        """The labels of pairs."""
        return cls(**{name: getattr(pairs, name) for name in cls.__dataclass_fields__})

    def stacked(self) -> Array:
        """(N, 56) float64, one row per frame."""
        parts = (self.joint_pos, self.base_quat, self.rates, self.contact)
        return np.concatenate([np.asarray(p, np.float64) for p in parts], axis=1)


class Memoryless:
    """A FrameMapper in an expert's place (`mapper.Expert`): each frame by itself."""

    remembers = False

    def __init__(self, method: FrameMapper) -> None:
        self._method = method

    def begin(self) -> "Memoryless":
        """Itself: there is nothing to forget."""
        return self

    def __call__(self, triplet: NDArray) -> Mapped:
        """Map one triplet (3F,), or a batch (N, 3F)."""
        said = self._method(np.atleast_2d(triplet))
        return said if np.ndim(triplet) == 2 else row_of(said, 0)


def row_of(mapped: Mapped, i: int) -> Mapped:
    """Frame i of a batch."""
    return Mapped(
        joint_pos=mapped.joint_pos[i],
        base_quat=mapped.base_quat[i],
        rates=mapped.rates[i],
        contact_prob=mapped.contact_prob[i],
    )


def unstack(rows: Array) -> Mapped:
    """Rows (N, 56) as a Mapped: joints held to their limits, quaternions made unit."""
    return Mapped(
        joint_pos=np.clip(rows[:, :12], a1.JOINT_LOWER, a1.JOINT_UPPER),
        base_quat=geometry.normalize(rows[:, 12:16]),
        rates=rows[:, 16 : 16 + NUM_RATES],
        contact_prob=np.clip(rows[:, 16 + NUM_RATES :], 0.0, 1.0),
    )
