"""A take and its edits to what an operator judges it by: suggestions, alignment, score.

Everything is worked out in blocks or windows of the take's table (`columns`), so that an hour
costs no more memory than a minute. The tape is never changed; what is accepted becomes an edit.
"""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from studio.errors import StudioError
from studio.robot import a1
from studio.takes.align.alignment import Alignment
from studio.takes.align.synchrony import align, liveliest, session_curves
from studio.takes.columns import columns
from studio.takes.dataset.cleaning import Suggestion, take_suggestions, touches
from studio.takes.dataset.quality import Quality, median_jerk, quality
from studio.takes.edit import edits as edit_log
from studio.takes.edit.edited import kept
from studio.takes.edit.edits import Edits
from studio.takes.session_library import SessionLibrary


@dataclass(frozen=True, kw_only=True)
class Review:
    """What was found in a take as its edits leave it.

    kept_seconds: within the trim and outside the cuts. suggestions: of what is kept, s into the
    take. before: the alignment as it is (lag of the edits, its correlation); found: the one
    proposed, None when nothing moves or no person was seen. score: [0, 1], also written to the
    take; quality: why. problems: of the tape.
    """

    name: str
    seconds: float
    kept_seconds: float
    ticks: int
    edits: Edits
    suggestions: tuple[Suggestion, ...]
    before: Alignment | None
    found: Alignment | None
    quality: Quality
    score: float
    problems: tuple[str, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return asdict(self)


def review(library: SessionLibrary, name: str) -> Review:
    """Look a take over, and write its score into the list unless somebody gave it one.

    Raises StudioError for an unknown take or one that cannot be read.
    """
    folder = library.folder(name)
    table, edits = columns(folder), edit_log.read_edits(folder).edits
    if not len(table):
        raise StudioError(f"take {name} holds no tick that could be reviewed: delete it")
    keep = kept(len(table), edits)
    seconds = float(keep.sum()) / a1.CONTROL_HZ
    found = [s for s in take_suggestions(table) if touches(s, keep)]
    before, proposed = align(table, edits, session_curves(library, name))
    left = None
    if before is not None and proposed is not None:
        # What is still out of step, and how well the two agree once that is put right.
        left = Alignment(
            lag=proposed.lag - before.lag if proposed.certainty > 0.0 else 0.0,
            # A warp that was accepted agrees better than any lag alone.
            correlation=max(proposed.correlation, before.correlation if edits.warp else 0.0),
            certainty=proposed.certainty,
        )
    start, end = liveliest(table, keep)
    wrists = np.asarray(table.rows["human"][start:end, [7, 10]], dtype=np.float64)
    verdict = quality(
        seconds=seconds,
        found=found,
        alignment=left,
        jerk_m_s3=median_jerk(wrists, a1.CONTROL_DT) if np.isfinite(wrists).all() else 0.0,
        fallen_share=float(np.mean(table.rows["fallen"][keep])) if seconds else 0.0,
    )
    score = round(verdict.score / 100.0, 4)
    if edits.score is None or abs(edits.score - score) > 5e-5:
        # A score somebody gave stays: `found` rows never stand over a decision.
        edit_log.record(folder, score=score)
    return Review(
        name=name,
        seconds=table.seconds,
        kept_seconds=seconds,
        ticks=len(table),
        edits=edits,
        suggestions=tuple(found),
        before=before,
        found=proposed,
        quality=verdict,
        score=score,
        problems=(table.problem,) if table.problem else (),
    )


def accept_suggestions(library: SessionLibrary, name: str, which: list[int] | None = None) -> Edits:
    """Cut out suggestions of the present review, by index (all of them without).

    Raises StudioError for an index that it does not have, and if there is nothing to cut.
    """
    found = review(library, name)
    chosen = found.suggestions if which is None else []
    for i in which or ():
        if not 0 <= i < len(found.suggestions):
            raise StudioError(
                f"there is no suggestion {i}: take {name} has {len(found.suggestions)}"
            )
        chosen = [*chosen, found.suggestions[i]]
    if not chosen:
        raise StudioError(f"there is nothing to cut out of take {name}")
    cuts = [*(found.edits.cuts or ()), *((s.start, max(s.end, s.start + 1e-3)) for s in chosen)]
    library.edit(name, cuts=tuple(cuts))
    return edit_log.read_edits(library.folder(name)).edits
