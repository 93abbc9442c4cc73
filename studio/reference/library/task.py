"""What a task of the library is: a name, the state it belongs to, and a way to draw intents."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from studio.reference.intent import IntentTrack, StateName

Draw = Callable[[np.random.Generator, float, float], IntentTrack]


@dataclass(frozen=True, kw_only=True)
class Task:
    """One task. draw(rng, seconds, difficulty) gives its random intents."""

    name: str
    state: StateName
    draw: Draw

    def sample(
        self, rng: np.random.Generator, seconds: float, difficulty: float = 1.0
    ) -> IntentTrack:
        """A random track at 30 Hz. difficulty in [0, 1]: 0 a third of the range, 1 all of it."""
        return self.draw(rng, seconds, min(max(difficulty, 0.0), 1.0))


def amplitude(difficulty: float, easiest: float = 0.3) -> float:
    """Share of a range to be used: from `easiest` at difficulty 0 to 1 at difficulty 1."""
    return easiest + (1.0 - easiest) * difficulty
