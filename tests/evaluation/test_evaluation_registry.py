"""Every table names what it takes; nothing given is dropped without a word."""

import inspect
import json
from dataclasses import fields
from pathlib import Path
from typing import Any, get_type_hints

import pytest

from studio.errors import StudioError
from studio.evaluation import all as all_tables
from studio.evaluation import registry
from studio.evaluation.all import SMOKE, run_all
from studio.evaluation.options import AllOptions, TableOptions
from studio.evaluation.registry import TABLES, Table, run_table, table


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
    assert {f.name for f in fields(AllOptions)} - {"fresh", "smoke"} <= known


def test_an_unknown_table_is_answered_with_the_known_ones() -> None:
    with pytest.raises(StudioError, match="kicks"):
        table("juggling")


@pytest.mark.slow
def test_a_script_played_twice_has_a_row_for_each_seed_and_is_kept(tmp_path: Path) -> None:
    options = table("reach").options(seed=4, episodes=2)
    rows = run_table("reach", options, keep=tmp_path)["rows"]
    assert [row["seed"] for row in rows] == [4] * (len(rows) // 2) + [5] * (len(rows) // 2)
    assert json.loads((tmp_path / "reach.json").read_text()) == rows


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> dict[str, int]:
    """Tables of no cost in the place of three real ones; how often each was made."""
    made = {"tilt": 0, "reach": 0, "kicks": 0}

    def table_of(name: str) -> Table:
        def run(options: Any) -> dict[str, Any]:
            made[name] += 1
            if name == "reach":
                raise StudioError("no paw")
            return {"rows": [{"case": name, "seed": options.seed, "episodes": options.episodes}]}

        return Table(name, TableOptions, run)

    monkeypatch.setattr(registry, "table", table_of)
    monkeypatch.setattr(all_tables, "table", table_of)
    monkeypatch.setattr(all_tables, "TABLES", made)
    return made


def test_all_goes_on_after_a_table_that_fails_and_skips_what_is_kept(
    quick: dict[str, int], tmp_path: Path
) -> None:
    options = AllOptions(episodes=3)
    first = run_all(options, keep=tmp_path)
    assert [row["table"] for row in first["rows"]] == ["tilt", "reach", "kicks"]
    assert first["rows"][1]["failed"] == "no paw"
    assert first["_failed"] == "not made: reach (the row of each says why)"
    again = run_all(options, keep=tmp_path)
    assert again == first
    assert quick == {"tilt": 1, "reach": 2, "kicks": 1}
    about = all_tables.made_how(tmp_path, "tilt")
    assert about["options"] == {"seed": 0, "episodes": 3}
    assert about["seconds"] >= 0.0


def test_all_makes_anew_what_was_made_otherwise_and_what_it_is_told_to(
    quick: dict[str, int], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_all(AllOptions(episodes=3), keep=tmp_path)
    run_all(AllOptions(episodes=4), keep=tmp_path)  # with other options
    assert quick["tilt"] == 2
    registry.run_table("tilt", TableOptions(episodes=9), keep=tmp_path)  # by itself
    run_all(AllOptions(episodes=4), keep=tmp_path)
    assert quick["tilt"] == 4
    monkeypatch.setattr(all_tables, "fingerprint", lambda *parts: "other code")
    run_all(AllOptions(episodes=4), keep=tmp_path)
    assert quick["tilt"] == 5
    run_all(AllOptions(episodes=4, fresh=True), keep=tmp_path)
    assert quick["tilt"] == 6
    (tmp_path / "tilt.json").write_text("[{")  # torn
    run_all(AllOptions(episodes=4), keep=tmp_path)
    assert quick["tilt"] == 7


def test_every_table_that_needs_nothing_of_the_machine_has_a_smallest_size() -> None:
    assert set(TABLES) - set(SMOKE) == {"latency", "people", "operator_statistics"}
    for name, size in SMOKE.items():
        assert size.keys() <= set(table(name).takes)


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_all_tables_are_made_at_their_smallest(tmp_path: Path) -> None:
    made = run_all(AllOptions(smoke=True), keep=tmp_path)
    assert "_failed" not in made, [row for row in made["rows"] if "failed" in row]
    tables = {row["table"] for row in made["rows"]}
    assert set(SMOKE) - tables <= {"sim2sim"}
    for row in made["rows"]:
        assert {"seed", "episodes", "commit", "controller"} <= row.keys()
        assert "case" in row or "state" in row
