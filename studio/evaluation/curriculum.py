"""What the curriculum is worth: walking by PPO alone, 3 million samples with it and without."""

from pathlib import Path
from typing import Any

from studio.control.policy import MODELS
from studio.evaluation.ablation import TRAINED, trained_variants
from studio.evaluation.tracking import CACHE, compare

ROWS = {"no_teacher": "curriculum", "no_curriculum": "no curriculum", "full": "teacher instead"}


def run_curriculum(
    episodes: int = 1024,
    seed: int = 0,
    *,
    threads: int | str = 0,
    models: Path = MODELS,
    cache: Path | None = CACHE,
    progress: bool = True,
) -> dict[str, Any]:
    """`{"rows": [...]}` as `tracking` has them, on full ranges and full Table I for everybody."""
    return variant_rows(ROWS, models, (episodes, seed, int(threads), cache, progress))


def variant_rows(
    names: dict[str, str], models: Path, settings: tuple[int, int, int, Path | None, bool]
) -> dict[str, Any]:
    """Rows of the trained variants among `names`, each with its `variant` in words."""
    found = trained_variants(models)
    rows = []
    for name, words in names.items():
        if name in found:
            row = compare([(TRAINED, found[name])], *settings)[0]
            rows.append({"variant": words, **row})
    return {"rows": rows}
