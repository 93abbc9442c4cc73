"""The reference's own past → its near future: what a policy without the future may foresee.

Ridge regression, in closed form: with X the noisy references of the last MEMORY frames and Y the
clean ones k control periods ahead, both less the newest noisy frame and scaled by its spread,
W = (XᵀX + λI)⁻¹ XᵀY. A reference that stands still is foreseen to stand still.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.control.observation import MEMORY, REFERENCE_DIM
from studio.rl.bank import MotionBank
from studio.rl.noise import NoiseConfig, ReferenceNoise

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Foresight:
    """weight: ((MEMORY − 1) · 18 + 18, 18 · K); mean, scale: (18,) of one frame of p̄.

    Calling it turns past references (N, MEMORY, 18), newest last, into (N, 18 · K).
    """

    weight: Array
    mean: Array
    scale: Array

    def __call__(self, past: Array) -> Array:
        newest = past[:, -1]
        moved = _inputs(past, self.mean, self.scale) @ self.weight
        moved = moved.reshape(len(past), -1, REFERENCE_DIM)
        return (newest[:, None] + moved * self.scale).reshape(len(past), -1)

    def tensors(self) -> dict[str, NDArray[np.float32]]:
        """As saved beside a policy's layers."""
        fields = {"weight": self.weight, "mean": self.mean, "scale": self.scale}
        return {f"foresight_{k}": v.astype(np.float32) for k, v in fields.items()}

    @classmethod
    def of(cls, tensors: dict[str, NDArray[np.float32]]) -> "Foresight | None":
        """Back from a policy's tensors; None if it has none."""
        if "foresight_weight" not in tensors:
            return None
        names = ("weight", "mean", "scale")
        return cls(**{k: tensors[f"foresight_{k}"].astype(np.float64) for k in names})


def _inputs(past: Array, mean: Array, scale: Array) -> Array:
    """(N, MEMORY · 18): how each older frame differs from the newest, and the newest itself."""
    newest = past[:, -1:]
    older = (past[:, :-1] - newest) / scale
    return np.concatenate([older, (newest - mean) / scale], axis=1).reshape(len(past), -1)


def fit(
    bank: MotionBank,
    ahead: Sequence[int],
    noise: NoiseConfig,
    rng: np.random.Generator,
    *,
    samples: int = 40_000,
    ridge: float = 10.0,
) -> Foresight:
    """Learn the bank's futures `ahead` control periods from now, under reference noise."""
    motions = rng.integers(0, len(bank), max(samples // bank.frames, 1))
    clean = bank.feature[motions]
    flat = clean.reshape(-1, REFERENCE_DIM)
    mean, scale = flat.mean(axis=0), np.maximum(flat.std(axis=0), 1e-3)
    source = ReferenceNoise(len(motions), noise, rng)
    noisy = np.empty_like(clean)
    noisy[:, 0] = source.reset(np.arange(len(motions)), clean[:, 0].copy())
    for k in range(1, bank.frames):
        noisy[:, k] = source.step(clean[:, k].copy())
    inputs, futures = [], []
    for k in range(MEMORY - 1, bank.frames - max(ahead)):
        past = noisy[:, k - MEMORY + 1 : k + 1]
        inputs.append(_inputs(past, mean, scale))
        later = clean[:, [k + a for a in ahead]] - past[:, -1:]
        futures.append((later / scale).reshape(len(motions), -1))
    x, y = np.concatenate(inputs), np.concatenate(futures)
    gram = x.T @ x + ridge * np.eye(x.shape[1])
    weight = np.asarray(np.linalg.solve(gram, x.T @ y), dtype=np.float64)
    return Foresight(weight=weight, mean=mean, scale=scale)
