"""Noisy human frames to suggestions: what to cut, where and why; the operator decides.

Functions over a take's human stream, whole or block by block: t (T,) s ascending, joint_pos_w
(T, 19, 3) m, confidence (T, 19) in [0, 1]. Nothing here changes data.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.human.posture import SEEN
from studio.human.skeleton import INDEX, JOINTS
from studio.robot import a1
from studio.takes.columns import Columns

Array = NDArray[np.float64]

GAP_PERIODS = 1.6
"""A gap this many median periods long has lost at least one frame."""
FROZEN_FRAMES = 4
"""So many identical frames in a row are a stalled sensor, not a person holding still."""
JITTER_M = 0.035
"""Median second difference over a window, m; 30 Hz webcam noise of 15 mm gives about 0.04."""
WINDOW_S = 0.3
BLOCK_S, OVERLAP_S = 60.0, 1.0
"""s of a block in which suggestions are looked for, and how far blocks overlap."""
SWAP_MIN_JUMP_M = 0.15
LIMBS: tuple[tuple[str, ...], ...] = (
    ("elbow", "wrist"),
    ("knee", "ankle", "toe"),
)


@dataclass(frozen=True, kw_only=True)
class Suggestion:
    """One stretch worth looking at. start, end: s. share: how much of a body it touches, [0, 1]."""

    kind: str
    start: float
    end: float
    share: float
    message: str


def suggestions(t: Array, joint_pos_w: Array, confidence: Array) -> list[Suggestion]:
    """Everything found in a human stream, in order of time: t (T,) s, joints (T, 19, 3) m and
    confidence (T, 19), as for every finding here."""
    if len(t) < 3:
        return []
    found = [
        *dropped_frames(t),
        *frozen_frames(t, joint_pos_w),
        *jitter(t, joint_pos_w, confidence),
        *low_confidence(t, confidence),
        *limb_swaps(t, joint_pos_w),
    ]
    return sorted(found, key=lambda s: (s.start, s.kind))


def dropped_frames(t: Array) -> list[Suggestion]:
    """Gaps longer than GAP_PERIODS median periods."""
    steps = np.diff(t)
    period = float(np.median(steps))
    out = []
    for i in np.flatnonzero(steps > GAP_PERIODS * period):
        lost = round(float(steps[i]) / period) - 1
        message = f"{lost} frame{'s' if lost > 1 else ''} lost"
        out.append(_suggest("dropped", t[i], t[i + 1], 1.0, message))
    return out


def frozen_frames(t: Array, joint_pos_w: Array) -> list[Suggestion]:
    """Runs of at least FROZEN_FRAMES identical frames."""
    same = np.all(np.diff(joint_pos_w, axis=0) == 0.0, axis=(1, 2))
    return [
        _suggest("frozen", t[a], t[b], 1.0, f"the sensor gave the same frame {b - a + 1} times")
        for a, b in _runs(same)
        if b - a + 1 >= FROZEN_FRAMES
    ]


def jitter(t: Array, joint_pos_w: Array, confidence: Array) -> list[Suggestion]:
    """Windows in which a seen joint shakes: median |x[i+1] - 2 x[i] + x[i-1]| over JITTER_M.

    The median over WINDOW_S lets a fast but smooth limb pass: its second difference at 30 Hz
    (v = 3 m/s on a 0.5 m circle: a dt^2 = 18 / 900 = 0.02 m) stays under the threshold.
    """
    second = np.linalg.norm(np.diff(joint_pos_w, n=2, axis=0), axis=-1)
    seen = confidence[1:-1] > SEEN
    second = np.where(seen, second, 0.0)
    width = max(3, round(WINDOW_S / float(np.median(np.diff(t)))))
    if len(second) < width:
        return []
    windows = np.lib.stride_tricks.sliding_window_view(second, width, axis=0)
    level = np.median(windows, axis=-1)
    shaking = level > JITTER_M
    out = []
    for a, b in _runs(np.any(shaking, axis=1), single=True):
        joints = np.flatnonzero(shaking[a : b + 1].any(axis=0))
        worst = JOINTS[int(np.argmax(level[a : b + 1].max(axis=0)))]
        share = len(joints) / len(JOINTS)
        end = t[min(b + width + 1, len(t) - 1)]
        out.append(_suggest("jitter", t[a], end, share, f"{worst} shakes"))
    return out


def low_confidence(t: Array, confidence: Array) -> list[Suggestion]:
    """Runs in which at least a quarter of the joints ever seen are below SEEN."""
    ever = confidence.max(axis=0) > SEEN
    if not ever.any():
        return [_suggest("low_confidence", t[0], t[-1], 1.0, "no joint was seen clearly")]
    hidden = confidence[:, ever] < SEEN
    share = hidden.mean(axis=1)
    out = []
    for a, b in _runs(share >= 0.25, single=True):
        worst = np.flatnonzero(ever)[int(np.argmax(hidden[a : b + 1].mean(axis=0)))]
        message = f"{JOINTS[worst]} and others not seen"
        out.append(_suggest("low_confidence", t[a], t[b], float(share[a : b + 1].max()), message))
    return out


def limb_swaps(t: Array, joint_pos_w: Array) -> list[Suggestion]:
    """Stretches in which a left and a right limb change places.

    A swap is an instant at which crossing the limb's joints (left now to right before) is a
    shorter way than keeping them, and keeping them is a jump of SWAP_MIN_JUMP_M or more. Two
    instants bound a stretch; a last odd one runs to the end.
    """
    out = []
    for limb in LIMBS:
        left = joint_pos_w[:, [INDEX[f"l_{j}"] for j in limb]]
        right = joint_pos_w[:, [INDEX[f"r_{j}"] for j in limb]]
        keep = _step(left[1:], left[:-1]) + _step(right[1:], right[:-1])
        cross = _step(left[1:], right[:-1]) + _step(right[1:], left[:-1])
        instants = np.flatnonzero((cross < 0.5 * keep) & (keep > 2 * SWAP_MIN_JUMP_M)) + 1
        name = "arms" if limb[0] == "elbow" else "legs"
        bounds = [*instants.tolist(), len(t) - 1] if len(instants) % 2 else instants.tolist()
        for a, b in zip(bounds[::2], bounds[1::2], strict=True):
            share = 2 * len(limb) / len(JOINTS)
            out.append(_suggest("limb_swap", t[a], t[b], share, f"left and right {name} swapped"))
    return out


def _step(a: Array, b: Array) -> Array:
    return np.linalg.norm(a - b, axis=-1).mean(axis=-1)


def _runs(mask: NDArray[np.bool_], *, single: bool = False) -> list[tuple[int, int]]:
    """First and last index of each run of True; over steps, the last index is the frame after."""
    padded = np.concatenate([[False], mask, [False]]).astype(np.int8)
    edges = np.flatnonzero(np.diff(padded))
    starts, ends = edges[::2], edges[1::2]
    return [(int(a), int(b) - 1 if single else int(b)) for a, b in zip(starts, ends, strict=True)]


def _suggest(kind: str, start: float, end: float, share: float, message: str) -> Suggestion:
    return Suggestion(
        kind=kind, start=float(start), end=float(end), share=float(share), message=message
    )


def take_suggestions(table: Columns) -> list[Suggestion]:
    """Everything found in a take's human stream, at times of the take; block by block."""
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
        for s in suggestions(t, pos, confidence):
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
