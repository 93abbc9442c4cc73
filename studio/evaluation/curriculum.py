"""What the curriculum is worth: walking by PPO alone, 3 million samples with it and without."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studio.control.policy import MODELS
from studio.evaluation.ablation import TRAINED, trained_variants
from studio.evaluation.options import PolicyOptions
from studio.evaluation.tracking import CACHE, compare

ROWS = {"no_teacher": "curriculum", "no_curriculum": "no curriculum", "full": "teacher instead"}


@dataclass(frozen=True, kw_only=True)
class Options(PolicyOptions):
    """Of `evaluate curriculum`."""


def run_curriculum(
    options: Options = Options(),
    *,
    models: Path = MODELS,
    cache: Path | None = CACHE,
    progress: bool = True,
) -> dict[str, Any]:
    """`{"rows": [...]}` as `tracking` has them, on full ranges and full Table I for everybody."""
    return variant_rows(ROWS, models, options, cache, progress)


def variant_rows(
    names: dict[str, str], models: Path, options: PolicyOptions, cache: Path | None, progress: bool
) -> dict[str, Any]:
    """Rows of the trained variants among `names`, each with its `variant` in words."""
    found = trained_variants(models)
    rows = []
    for name, words in names.items():
        if name in found:
            row = compare(
                [(TRAINED, found[name])],
                options.episodes,
                options.seed,
                options.threads,
                cache,
                progress,
            )[0]
            rows.append({"variant": words, **row})
    return {"rows": rows}
