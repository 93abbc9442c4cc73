"""The cards at the head of the models' pages say what the models' own sidecars say."""

import json
import re
from pathlib import Path

import pytest

MODELS = Path(__file__).resolve().parents[1] / "models"


def rows(page: str) -> dict[str, list[str]]:
    """The card's tables: the first cell of each row, and those behind it."""
    card = re.split(r"^## ", (MODELS / page).read_text("utf-8"), flags=re.MULTILINE)[1]
    assert card.startswith("Card")
    lines = [line for line in card.splitlines() if line.startswith("| ")]
    cells = [[cell.strip() for cell in line.strip("| ").split(" | ")] for line in lines]
    return {first: rest for first, *rest in reversed(cells)}  # of two the upper one


@pytest.mark.parametrize("state", ["stand", "walk", "sit"])
def test_a_policys_card_is_its_sidecars(state: str) -> None:
    said = json.loads((MODELS / f"policy/{state}.json").read_text())
    scores = said["scores"]
    tracked = [
        f"{scores[who]['tracked_time_ratio']:.3f}"
        for who in ("policy", "pd_playback", "stand_still")
    ]
    assert rows("policy/README.md")[state] == [
        f"{said['samples']:,}", str(said["hours"]), str(said["seed"]), said["commit"],
        f"{said['recipe']['distil']:,} lessons", ", ".join(tracked),
        f"{scores['policy']['joint_rmse_deg']:.1f}",
    ]  # fmt: skip


@pytest.mark.parametrize("file", sorted(MODELS.glob("mapper/*/*.json")), ids=str)
def test_a_mappers_card_is_its_sidecars(file: Path) -> None:
    said = json.loads(file.read_text())
    scores = said["scores"]
    if file.stem == "selector":
        text = (MODELS / "mapper/README.md").read_text("utf-8")
        assert f"{scores['right']:.3f}" in text.partition("The selectors choose")[2][:200]
        return
    assert rows("mapper/README.md")[f"{file.parent.name}, {file.stem}"] == [
        f"{scores['train_frames']:,.0f}", str(said["seconds"]), str(said["seed"]), said["commit"],
        f"{scores['joint_rmse_deg']:.2f}", f"{scores['orientation_error_deg']:.2f}",
        f"{scores['contact_f1']:.3f}",
    ]  # fmt: skip
