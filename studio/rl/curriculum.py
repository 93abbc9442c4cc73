"""Which references and dynamics to train on: by task, then range, then randomisation."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

DIFFICULTIES = (0.4, 0.7, 1.0)
"""Ranges of motion, as shares of a task's full range, that a bank holds."""


@dataclass(frozen=True, kw_only=True)
class Rung:
    """What may be drawn: the tasks so far, the widest range, the scale of Table I's ranges."""

    tasks: tuple[str, ...]
    difficulty: float
    randomisation: float


def stages(tasks: Sequence[str], randomisation: Sequence[float] = (0.34, 0.67, 1.0)) -> list[Rung]:
    """The whole ladder: tasks join one by one at a narrow range, ranges widen, dynamics spread.

    The paper sorts by task first and difficulty second; its randomisation grows likewise.
    randomisation: shares of Table I's ranges.
    """
    ladder = [
        Rung(tasks=tuple(tasks[: k + 1]), difficulty=DIFFICULTIES[0], randomisation=0.0)
        for k in range(len(tasks))
    ]
    ladder += [Rung(tasks=tuple(tasks), difficulty=d, randomisation=0.0) for d in DIFFICULTIES[1:]]
    ladder += [Rung(tasks=tuple(tasks), difficulty=1.0, randomisation=r) for r in randomisation]
    return ladder


@dataclass(kw_only=True)
class Curriculum:
    """Moves up a stage when the tracked-time ratio of recent episodes reaches `gate`.

    window: episodes that are averaged, all of them begun in the present stage. patience: episodes
    after which a stage is left anyway, so that one hard range cannot hold up the dynamics.
    """

    ladder: list[Rung]
    gate: float = 0.75
    window: int = 192
    patience: int = 800
    level: int = 0
    episodes: int = 0
    ratio: float = 0.0

    def __post_init__(self) -> None:
        self._recent: list[float] = []

    @property
    def stage(self) -> Rung:
        """What to draw from now."""
        return self.ladder[self.level]

    @property
    def done(self) -> bool:
        """The last stage is reached."""
        return self.level == len(self.ladder) - 1

    def finish(self) -> None:
        """Jump to the last stage (no curriculum: the ablation, and every evaluation)."""
        self.level = len(self.ladder) - 1

    def record(self, ratios: NDArray[np.float64]) -> bool:
        """Ended episodes' tracked-time ratios (n,); True if the stage changed."""
        self._recent = (self._recent + [float(r) for r in ratios])[-self.window :]
        self.episodes += len(ratios)
        if self._recent:
            self.ratio = float(np.mean(self._recent))
        full = len(self._recent) >= self.window
        passed = (full and self.ratio >= self.gate) or self.episodes >= self.patience
        if self.done or not passed:
            return False
        self.level += 1
        self.episodes = 0
        self._recent = []
        return True

    def state(self) -> dict[str, float]:
        """What a checkpoint keeps."""
        return {"level": self.level, "episodes": self.episodes, "ratio": self.ratio}

    def load(self, state: dict[str, float]) -> None:
        """Back to a kept state; the window of recent episodes starts afresh."""
        self.level = min(int(state["level"]), len(self.ladder) - 1)
        self.episodes, self.ratio = int(state["episodes"]), float(state["ratio"])
        self._recent = []
