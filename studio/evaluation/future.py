"""Without the future: PPO alone, a teacher that saw it, and having it for true."""

from pathlib import Path
from typing import Any

from studio.control.policy import MODELS
from studio.evaluation.curriculum import variant_rows
from studio.evaluation.tracking import CACHE

ROWS = {
    "no_teacher": "no future (PPO)",
    "full": "distilled from a teacher that saw it",
    "true_future": "distilled, and the true future",
}


def run_future(
    episodes: int = 1024,
    seed: int = 0,
    *,
    threads: int | str = 0,
    models: Path = MODELS,
    cache: Path | None = CACHE,
    progress: bool = True,
) -> dict[str, Any]:
    """`{"rows": [...]}` as `tracking` has them: walking policies of 3 million samples each."""
    return variant_rows(ROWS, models, (episodes, seed, int(threads), cache, progress))
