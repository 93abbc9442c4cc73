"""The tables of a page of ours, read back from its Markdown: what was measured, as written."""

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Shown:
    """A table as shown. heading: of the section it is in. note: the paragraph before it. rows: a
    cell a column, as written: "0.994 [0.993, 0.996]"."""

    heading: str
    note: str
    columns: list[str]
    rows: list[list[str]]

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


def tables_of(text: str) -> list[Shown]:
    """Every table of a page, in order."""
    found: list[Shown] = []
    heading, note, lines = "", "", [*text.splitlines(), ""]
    block: list[list[str]] = []
    for line in lines:
        if line.startswith("|"):
            block.append([cell.strip() for cell in line.strip().strip("|").split("|")])
            continue
        if len(block) > 2:
            rows = [row for row in block[2:] if len(row) == len(block[0])]
            found.append(Shown(heading=heading, note=note, columns=block[0], rows=rows))
        block = []
        if line.startswith("#"):
            heading, note = line.lstrip("#").strip(), ""
        elif line.strip():
            note = line.strip()
    return found
