"""Without the future: PPO alone, a teacher that saw it, and having it for true."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studio.control.policy import MODELS
from studio.evaluation.curriculum import variant_rows
from studio.evaluation.options import PolicyOptions
from studio.evaluation.tracking import CACHE

ROWS = {
    "no_teacher": "no future (PPO)",
    "full": "distilled from a teacher that saw it",
    "true_future": "distilled, and the true future",
}


@dataclass(frozen=True, kw_only=True)
class Options(PolicyOptions):
    """Of `evaluate future`."""


def run_future(
    options: Options = Options(),
    *,
    models: Path = MODELS,
    cache: Path | None = CACHE,
    progress: bool = True,
) -> dict[str, Any]:
    """`{"rows": [...]}` as `tracking` has them: walking policies of 3 million samples each."""
    return variant_rows(ROWS, models, options, cache, progress)
