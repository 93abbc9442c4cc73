"""What the paper says of its results, each beside what was measured here: numbers from our pages.

Where it gives a bar without a number, or words, so it says; what wants the real robot is said to be
out of reach.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

from studio.evaluation.markdown_tables import Shown

NOT_MEASURED = "not on these pages"


@dataclass(frozen=True, kw_only=True)
class Figure:
    """One measured cell: of the first table whose heading begins so, the row that has these cells,
    by column, and of it the columns named in `says`, "{ratio} ×"."""

    heading: str
    row: dict[str, str]
    says: str

    def read(self, tables: list[Shown]) -> str | None:
        """In words; None where that table or row is not there."""
        for table in tables:
            if not table.heading.startswith(self.heading):
                continue
            for row in table.rows:
                cells = dict(zip(table.columns, row))
                if all(cells.get(key) == value for key, value in self.row.items()):
                    return self.says.format_map(cells)
        return None


@dataclass(frozen=True, kw_only=True)
class Claim:
    """what: the paper's table, figure or sentence. paper: what it says. ours: measured, a figure
    each. beyond: why there is none."""

    what: str
    paper: str
    ours: tuple[Figure, ...] = ()
    beyond: str = field(default="")


def _goal(words: str, says: str) -> Figure:
    return Figure(heading="Goals", row={"what": words}, says=says)


def _tested(state: str, variant: str) -> Figure:
    return Figure(
        heading="Ablation",
        row={"kind": "test", "state": state, "variant": variant, "controller": "policy"},
        says=f"{state}, {variant}: {{success}}",
    )


def _trained(variant: str) -> Figure:
    row = {"kind": "training", "state": "walk", "variant": variant}
    return Figure(heading="Ablation", row=row, says=f"walk, {variant}: {{success}}, {{joints °}}°")


CLAIMS: tuple[Claim, ...] = (
    Claim(
        what="Individual tasks: tilt, standing",
        paper="−40° to 40° on every axis (maker's controller: ±20°, yaw ±28°)",
        ours=(_goal("stand ±40° on each axis, off by", "±40° asked, held within {worst}"),),
    ),
    Claim(
        what="Individual tasks: tilt, sitting",
        paper="30° pitch, 15° roll, 7° yaw",
        ours=tuple(
            _goal(f"sit {axis}, {deg}° of range, off by", f"{axis} {deg}°, off by {{worst}}")
            for axis, deg in (("pitch", 30), ("roll", 15), ("yaw", 7))
        ),
    ),
    Claim(
        what="Individual tasks: walking",
        paper="0.0 to 0.97 m/s, turning up to 15°/s",
        ours=(
            _goal("speeds 0 to 0.97 m/s, off by", "0 to 0.97 m/s, off by {worst} at most"),
            _goal("turns of ±15°/s, off by", "±15°/s, off by {worst} at most"),
        ),
    ),
    Claim(
        what="A target 0.8 m high",
        paper="touched sitting, out of reach standing (on the real robot)",
        ours=(
            _goal("a paw sitting", "sitting {worst}"),
            _goal("a paw standing (must fail)", "standing {worst}"),
        ),
    ),
    Claim(
        what="Workspace of a front paw, standing",
        paper="with tilts 2.7 times that without",
        ours=(
            Figure(
                heading="Volume that the standing robot's right paw reaches",
                row={"controller": "policy"},
                says="{ratio} times ({litres} → {with tilts} litres)",
            ),
        ),
    ),
    Claim(
        what="Consistency, 5,120 noisy episodes (bars without numbers)",
        paper="both essential; contact more for standing and sitting, temporal for walking",
        ours=tuple(
            _tested(state, variant)
            for state in ("stand", "walk", "sit")
            for variant in ("both", "no contact consistency", "no temporal consistency")
        ),
    ),
    Claim(
        what="Domain randomisation (bars without numbers)",
        paper="essential for all tasks",
        ours=(_trained("full"), _trained("no randomisation")),
    ),
    Claim(
        what="Curriculum (pictures)",
        paper="essential for the best imitation; without it conservative",
        ours=tuple(
            Figure(
                heading="Curriculum", row={"variant": each}, says=f"{each}: joints {{joints °}}°"
            )
            for each in ("curriculum", "no curriculum")
        ),
    ),
    Claim(
        what="Future reference (video)",
        paper="with it more stable motions",
        ours=tuple(
            Figure(
                heading="Without the future",
                row={"variant": each},
                says=f"{each}: joints {{joints °}}°, lag {{lag ms}} ms",
            )
            for each in ("no future (PPO)", "distilled, and the true future")
        ),
    ),
    Claim(
        what="Responsiveness",
        paper="control inference under 10 ms at 30 Hz",
        ours=(
            Figure(
                heading="Figures of a machine",
                row={"what": "all of a tick but physics"},
                says="all of a tick but physics: {measured} ms (p50 / p95 / p99)",
            ),
        ),
    ),
    Claim(
        what="Styles of walking",
        paper="marching in place and circling hands both walk (pictures)",
        ours=(
            Figure(
                heading="All figures",
                row={"state": "walk", "mapper": "expert"},
                says="fitted to marches: joints {joints °}°; to circles: {circles °}°",
            ),
        ),
    ),
    Claim(
        what="Comparison with (A) to (D)",
        paper="by criteria, its own method (here first; then measured)",
        ours=tuple(
            Figure(
                heading="The paper's table",
                row={"": row},
                says=f"{row}: {{ours}}",
            )
            for row in ("Mapping dimension", "Real-time", "Dynamics", "Mapping flexibility")
        ),
    ),
    Claim(
        what="Pictures of the tasks: person, reference, simulated robot; the real robot",
        paper="pictures",
        beyond="below (a1-studio evaluate figures); the real robot is out of reach",
    ),
    Claim(
        what="Walking beside a regular controller",
        paper="less stable, by words",
        beyond="not measured: no velocity policy to compare with was trained",
    ),
    Claim(
        what="Composite tasks, three on the real robot",
        paper="completed (pictures, video)",
        beyond="in simulation: a1-studio evaluate composite, docs/guide/scenes.md; "
        "the real robot is out of reach",
    ),
    Claim(
        what="Sim-to-real",
        paper="with randomisation the real robot follows",
        beyond="out of reach: no robot. A second engine instead: a1-studio evaluate sim2sim",
    ),
)
"""In the paper's order."""


def beside(tables: list[Shown]) -> Iterator[tuple[str, str, str]]:
    """Of each claim: what it is about, what the paper says, what was measured here."""
    for claim in CLAIMS:
        found = [said for figure in claim.ours if (said := figure.read(tables))]
        yield claim.what, claim.paper, "; ".join(found) or claim.beyond or NOT_MEASURED
