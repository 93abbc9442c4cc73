"""A take's human stream to what `cleaning` would leave out of it, block by block."""

import numpy as np
from numpy.typing import NDArray

from studio.robot import a1
from studio.takes.columns import Columns
from studio.takes.dataset import cleaning
from studio.takes.dataset.cleaning import Suggestion

BLOCK_S, OVERLAP_S = 60.0, 1.0
"""s of a block in which suggestions are looked for, and how far blocks overlap."""


def suggestions(table: Columns) -> list[Suggestion]:
    """Everything `cleaning` finds in the human stream, at times of the take; block by block."""
    size, more = round(BLOCK_S * a1.CONTROL_HZ), round(OVERLAP_S * a1.CONTROL_HZ)
    out: list[Suggestion] = []
    for first, rows in table.blocks(size, more):
        at = np.flatnonzero(rows["fresh"])
        if len(at) < 3:
            continue
        t, used = np.asarray(rows["human_t"][at]), (first + at) / a1.CONTROL_HZ
        if not np.all(np.diff(t) > 0.0):
            t = used  # a source that looped: the time of use stands in
        pos = np.asarray(rows["human"][at], dtype=np.float64)
        confidence = np.asarray(rows["confidence"][at], dtype=np.float64)
        for s in cleaning.suggestions(t, pos, confidence):
            start, end = np.interp([s.start, s.end], t, used)
            out.append(
                Suggestion(kind=s.kind, start=start, end=end, share=s.share, message=s.message)
            )
    return _merged(out)


def _merged(found: list[Suggestion]) -> list[Suggestion]:
    """Those of a kind that overlap (blocks do) as one, in order of time."""
    out: list[Suggestion] = []
    last: dict[str, int] = {}
    for s in sorted(found, key=lambda s: (s.start, s.end)):
        i = last.get(s.kind)
        if i is not None and s.start < out[i].end - 1e-9:
            a = out[i]
            out[i] = Suggestion(
                kind=s.kind,
                start=a.start,
                end=max(a.end, s.end),
                share=max(a.share, s.share),
                message=a.message,
            )
        else:
            last[s.kind] = len(out)
            out.append(s)
    return out


def touches(s: Suggestion, keep: NDArray[np.bool_]) -> bool:
    """Whether any tick of the suggestion, from start to end s, is kept (T,)."""
    a, b = int(s.start * a1.CONTROL_HZ), int(np.ceil(s.end * a1.CONTROL_HZ)) + 1
    return bool(keep[a:b].any())
