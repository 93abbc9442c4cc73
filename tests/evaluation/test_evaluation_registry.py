"""Every table names what it takes; nothing given is dropped without a word."""

import inspect
import json
from dataclasses import fields
from pathlib import Path
from typing import Any, get_type_hints

import pytest

from studio.errors import StudioError
from studio.evaluation.options import AllOptions, TableOptions
from studio.evaluation.registry import TABLES, run_table, table


@pytest.mark.parametrize("name", TABLES)
def test_a_table_is_run_with_its_own_options_and_nothing_else(name: str) -> None:
    found = table(name)
    assert issubclass(found.options, TableOptions)  # seed, episodes: what the contract promises
    first, *others = inspect.signature(found.run).parameters.values()
    assert issubclass(get_type_hints(found.run)[first.name], found.options)
    assert all(p.kind is p.KEYWORD_ONLY and p.default is not p.empty for p in others)
    assert found.needs in ([], ["clips"])  # what `all` may be given
    assert bool(found.needs) is ("(needs --clips)" in TABLES[name])


@pytest.mark.parametrize("name", [*TABLES, "all"])
def test_no_table_is_made_of_no_episodes(name: str) -> None:
    needed: Any = {option: Path("clips") for option in table(name).needs}
    with pytest.raises(StudioError, match="at least 1"):
        table(name).options(episodes=0, **needed)


def test_what_all_takes_some_table_has() -> None:
    known = {option for name in TABLES for option in table(name).takes}
    assert {f.name for f in fields(AllOptions)} <= known


def test_an_unknown_table_is_answered_with_the_known_ones() -> None:
    with pytest.raises(StudioError, match="kicks"):
        table("juggling")


@pytest.mark.slow
def test_a_script_played_twice_has_a_row_for_each_seed_and_is_kept(tmp_path: Path) -> None:
    options = table("reach").options(seed=4, episodes=2)
    rows = run_table("reach", options, keep=tmp_path)["rows"]
    assert [row["seed"] for row in rows] == [4] * (len(rows) // 2) + [5] * (len(rows) // 2)
    assert json.loads((tmp_path / "reach.json").read_text()) == rows
