"""One expert: a person's triplet (q, q', q'') becomes the robot's (p, p', p''), in plain numpy.

The network is the paper's (three leaky-ReLU layers; the joint head a tanh shifted and scaled to
the joint limits). Where the paper leaves a head open: the root head is a normalised quaternion,
the rotation away from the state's neutral trunk in the state's own frame (small for every state,
so that a sitting trunk, near vertical, is as well conditioned as a standing one); derivative heads
are linear, in units of the training data's standard deviation.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.geometry import scalars
from studio.retarget.network import Mlp, clipped_z
from studio.robot import a1

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

JOINT_MID = 0.5 * (a1.JOINT_UPPER + a1.JOINT_LOWER)
JOINT_HALF = 0.5 * (a1.JOINT_UPPER - a1.JOINT_LOWER)

RATES: dict[str, slice] = {
    "joint_vel": slice(0, 12),
    "joint_acc": slice(12, 24),
    "base_lin_vel": slice(24, 27),
    "base_lin_acc": slice(27, 30),
    "base_ang_vel": slice(30, 33),
    "base_ang_acc": slice(33, 36),
}
"""The derivative head; the base's linear ones in the state's frame, angular in the body."""
NUM_RATES = 36
NUM_OUTPUTS = 12 + 4 + NUM_RATES


@dataclass(frozen=True, kw_only=True)
class Mapped:
    """What an expert says of one frame, before any consistency.

    joint_pos: (12,) rad, inside the joint limits. base_quat: (4,) wxyz, trunk in the state's frame
    (stand, sit: the frame the feet were planted in, so yaw is the twist; walk: the heading frame).
    rates: (36,) derivatives in SI, laid out as RATES. contact_prob: (4,) in [0, 1]. turn: rad/s of
    heading where it is told by rule; None: it is felt from the rates.
    """

    joint_pos: Array
    base_quat: Array
    rates: Array
    contact_prob: Array
    turn: float | None = None


_SHAPES = {"joint_pos": (12,), "base_quat": (4,), "rates": (NUM_RATES,), "contact_prob": (4,)}


def misfit(said: Mapped) -> str:
    """In what the answer to one frame is none that a robot can be given; "" where it is one.

    AttributeError, TypeError or ValueError for what is no answer at all.
    """
    for part, shape in _SHAPES.items():
        value = np.asarray(getattr(said, part))
        if value.shape != shape:
            return f"{part} must be {shape}, not {value.shape}"
        if not np.isfinite(value).all():
            return f"{part} must be finite"
    return ""


class Expert(Protocol):
    """What a state's expert is, trained or made of rules.

    remembers: it must see every frame, also those on which the robot does not follow.
    """

    @property
    def remembers(self) -> bool: ...

    def begin(self) -> Callable[[NDArray], Mapped]:
        """What maps the frames of one stretch of motion, a triplet (3F,) a control period."""
        ...

    def __call__(self, triplet: NDArray) -> Mapped:
        """Map a batch (N, 3F) of frames, one control period apart."""
        ...


class FrameByFrame(ABC):
    """An expert that goes by what came before: a batch is one stretch of motion."""

    remembers = True

    @abstractmethod
    def begin(self) -> Callable[[NDArray], Mapped]:
        """Start anew from rest: what maps one triplet (3F,) a control period."""

    def __call__(self, triplet: NDArray) -> Mapped:
        """Map frames (N, 3F) that follow one another by a control period, from rest on."""
        going = self.begin()
        rows = [going(row) for row in np.atleast_2d(triplet)]
        return Mapped(
            joint_pos=np.stack([row.joint_pos for row in rows]),
            base_quat=np.stack([row.base_quat for row in rows]),
            rates=np.stack([row.rates for row in rows]),
            contact_prob=np.stack([row.contact_prob for row in rows]),
        )


@dataclass(frozen=True, kw_only=True)
class Mapper:
    """An expert's networks and what scales their inputs and outputs.

    trunk: the mapping network, input 3F. contact: the contact network, input 2F (q and q').
    mean, scale: (3F,) of the training inputs. rate_scale: (36,) sigma of the training derivatives.
    neutral_quat: (4,) the state's neutral trunk that the root head turns away from.
    """

    trunk: Mlp
    contact: Mlp
    mean: Array32
    scale: Array32
    rate_scale: Array
    neutral_quat: Array

    @staticmethod
    def from_tensors(tensors: Mapping[str, NDArray]) -> "Mapper":
        """Read an expert from the arrays of its safetensors file (`training.mapper_net`)."""
        return Mapper(
            trunk=Mlp.from_tensors(tensors, "trunk"),
            contact=Mlp.from_tensors(tensors, "contact"),
            mean=tensors["mean"].astype(np.float32),
            scale=tensors["scale"].astype(np.float32),
            rate_scale=tensors["rate_scale"].astype(np.float64),
            neutral_quat=tensors["neutral_quat"].astype(np.float64),
        )

    def normalize(self, triplet: NDArray) -> Array32:
        """Network inputs (..., 3F) of triplets (..., 3F), cut off at INPUT_CLIP sigmas."""
        return clipped_z(np.asarray(triplet, np.float32), self.mean, self.scale)

    @property
    def remembers(self) -> bool:
        """A network sees one frame at a time."""
        return False

    def begin(self) -> "Mapper":
        """The expert itself: there is nothing to forget."""
        return self

    def __call__(self, triplet: NDArray) -> Mapped:
        """Map one triplet (3F,) = q, q', q'' end to end; also takes a batch (..., 3F)."""
        x = self.normalize(triplet)
        out = self.trunk(x).astype(np.float64)
        joint_pos = JOINT_MID + JOINT_HALF * np.tanh(out[..., :12])
        return Mapped(
            joint_pos=joint_pos,
            base_quat=root_quat(out[..., 12:16], self.neutral_quat),
            rates=out[..., 16:] * self.rate_scale,
            contact_prob=self.contact_prob(x),
        )

    def contact_prob(self, x: Array32) -> Array:
        """Contact probabilities (..., 4) of normalised inputs (..., 3F): sees q and q' only."""
        logit = self.contact(x[..., : self.contact.input_dim]).astype(np.float64)
        return 1.0 / (1.0 + np.exp(-np.minimum(np.maximum(logit, -30.0), 30.0)))


def root_quat(raw: Array, neutral_quat: Array) -> Array:
    """Trunk orientation (..., 4) of the raw root head (..., 4): normalise(raw + 1) * neutral.

    The added identity makes a network that says nothing mean the neutral trunk.
    """
    if raw.ndim == 1:  # live: seven times quicker than arrays of one element
        w, x, y, z = raw.tolist()
        w += 1.0
        turned = scalars.mul((w, x, y, z), neutral_quat.tolist())
        return np.array(turned) / max(math.sqrt(w * w + x * x + y * y + z * z), 1e-6)
    w, x, y, z = raw[..., 0] + 1.0, raw[..., 1], raw[..., 2], raw[..., 3]
    inv = 1.0 / np.sqrt(np.maximum(w * w + x * x + y * y + z * z, 1e-12))
    turned = geometry.quat_mul(np.stack([w, x, y, z], axis=-1), neutral_quat)
    return turned * inv[..., None]
