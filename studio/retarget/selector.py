"""Which expert: k nearest neighbours over the training inputs, with hysteresis and an "unknown"."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.errors import unknown_name
from studio.retarget.experts import EXPERTS
from studio.retarget.network import clipped_z

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

NAMES: tuple[str, ...] = tuple(EXPERTS)
UNKNOWN = "unknown"


@dataclass(frozen=True, kw_only=True)
class SelectorConfig:
    """k neighbours vote. A switch needs a lead of `margin` held for `hold` frames.

    unknown_margin: times the 99th percentile of the training data's own distances, beyond which a
    frame is unknown once it has been so for `hold_unknown` frames.
    """

    k: int = 10
    margin: float = 0.2
    hold: int = 8
    unknown_margin: float = 1.5
    hold_unknown: int = 8


@dataclass(frozen=True, kw_only=True)
class Prototypes:
    """What the neighbours are found among.

    points: (P, D) prototypes, already in the metric's space. label: (P,) index into NAMES.
    mean, scale: (3F,) z-score of a triplet. project: (3F, D) from z-scores to the metric's space.
    p99: 99th percentile, over held-back training frames, of the mean distance to their k nearest.
    """

    points: Array32
    label: NDArray[np.int64]
    mean: Array32
    scale: Array32
    project: Array32
    p99: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "_square", np.square(self.points).sum(axis=1))
        object.__setattr__(self, "_minus_two", -2.0 * self.points)

    @staticmethod
    def from_tensors(tensors: Mapping[str, NDArray]) -> "Prototypes":
        """Read from the arrays of a selector's safetensors file."""
        return Prototypes(
            points=np.ascontiguousarray(tensors["points"], np.float32),
            label=tensors["label"].astype(np.int64),
            mean=tensors["mean"].astype(np.float32),
            scale=tensors["scale"].astype(np.float32),
            project=np.ascontiguousarray(tensors["project"], np.float32),
            p99=float(tensors["p99"].reshape(())),
        )

    def tensors(self) -> dict[str, NDArray]:
        """The arrays `from_tensors` reads."""
        return {
            "points": self.points,
            "label": self.label.astype(np.int32),
            "mean": self.mean,
            "scale": self.scale,
            "project": self.project,
            "p99": np.array([self.p99], np.float32),
        }

    def embed(self, triplet: NDArray) -> Array32:
        """Triplets (..., 3F) in the metric's space (..., D)."""
        return clipped_z(np.asarray(triplet, np.float32), self.mean, self.scale) @ self.project

    def nearest(self, point: Array32, k: int) -> tuple[NDArray[np.int64], Array32]:
        """Labels and distances (k,) of the k prototypes nearest to an embedded point (D,)."""
        # |p - x|^2 less its constant |x|^2: one matrix-vector product
        d2 = self._minus_two @ point
        d2 += self._square
        best = d2.argpartition(k)[:k]
        return self.label[best], np.sqrt(np.maximum(d2[best] + point @ point, 0.0))


@dataclass(frozen=True, kw_only=True)
class Choice:
    """One frame's selection.

    expert: the votes' decision, whatever is locked: a state, or "unknown". active: the state to
    act on (unknown keeps it, a lock decides it). votes: share of the neighbours per state.
    distance: mean distance to the neighbours, in units of the training data's 99th percentile.
    """

    expert: str
    active: str
    votes: dict[str, float]
    distance: float


class Selector:
    """Votes per frame, decides with hysteresis; `reset` forgets the decision, not the lock."""

    def __init__(self, prototypes: Prototypes, config: SelectorConfig | None = None) -> None:
        self.prototypes = prototypes
        self.config = config or SelectorConfig()
        self.lock: str | None = None
        self.reset()

    def reset(self) -> None:
        """The next frame's vote is taken at once."""
        self._active: str | None = None
        self._lead = 0
        self._leader: str | None = None
        self._far = 0
        self._unknown = False

    def set_lock(self, name: str | None) -> None:
        """Act on this state whatever the votes (None: automatic). StudioError if there is none."""
        if name is not None and name not in NAMES:
            raise unknown_name("state", name, NAMES)
        self.lock = name

    def step(self, triplet: NDArray) -> Choice:
        """Decide on one frame's triplet (3F,), as `human.features` makes it."""
        p = self.prototypes
        labels, distances = p.nearest(p.embed(triplet), self.config.k)
        share = np.bincount(labels, minlength=len(NAMES)) / len(labels)
        return self.decide(share, float(distances.mean()) / max(p.p99, 1e-9))

    def decide(self, share: Array, distance: float) -> Choice:
        """The hysteresis alone: vote shares (3,) in order of NAMES, distance in p99s."""
        votes = dict(zip(NAMES, share.tolist(), strict=True))
        self._update_unknown(distance)
        self._update_active(votes)
        active = self.lock or self._active
        assert active is not None
        assert self._active is not None
        expert = UNKNOWN if self._unknown else self._active
        return Choice(expert=expert, active=active, votes=votes, distance=distance)

    def _update_unknown(self, distance: float) -> None:
        far = distance > self.config.unknown_margin
        self._far = 0 if far == self._unknown else self._far + 1
        if self._far >= self.config.hold_unknown or self._active is None:
            self._unknown, self._far = far, 0

    def _update_active(self, votes: dict[str, float]) -> None:
        best = max(votes, key=lambda name: votes[name])
        if self._active is None:
            self._active = best  # the first vote at once
            return
        leads = votes[best] - votes[self._active] >= self.config.margin - 1e-9
        if best == self._active or not leads or self._unknown:
            self._lead, self._leader = 0, None
            return
        self._lead = self._lead + 1 if best == self._leader else 1
        self._leader = best
        if self._lead >= self.config.hold:
            self._active, self._lead, self._leader = best, 0, None


class TripletFilter:
    """A causal first-order low-pass of the selector's triplets: slow joints tell states apart.

    Cut-off in Hz at a step of dt seconds; `reset` takes the next value as it is.
    """

    def __init__(self, cutoff_hz: float, dt: float) -> None:
        self.gain = np.float32(1.0 - np.exp(-2.0 * np.pi * cutoff_hz * dt))
        self._value: NDArray | None = None

    def reset(self) -> None:
        """Forget the past."""
        self._value = None

    def step(self, triplet: NDArray) -> Array32:
        """The filtered triplet (3F,)."""
        x = np.asarray(triplet, np.float32)
        last = self._value
        value = x if last is None else last + self.gain * (x - last)
        self._value = value
        return value


SELECTOR_CUTOFF_HZ = 3.0
"""Cut-off of the selector's own filter: .94 -> .95 of frames right on motion capture, .86 -> .90
on webcam tracking, measured between two people before the start."""
