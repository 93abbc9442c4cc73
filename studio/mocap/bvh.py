"""BVH file → HumanClip: a forgiving reader that either gives the motion or names the bad line.

Layout: https://research.cs.wisc.edu/graphics/Courses/cs-838-1999/Jeff/BVH.html. Files are read a
block of frames at a time, and only the canonical joints are kept, so memory is bounded.
"""

import logging
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.pose import HumanClip
from studio.human.skeleton import INDEX, LEG_LENGTH
from studio.human.sources import AXES_STUDIO, AXES_Y_UP, SourceSkeleton, bvh_skeleton
from studio.mocap.bvh_header import Hierarchy, Lines, read_hierarchy

Array = NDArray[np.float64]
log = logging.getLogger(__name__)

MAX_FRAMES = 1_000_000
BLOCK = 1024
"""Frames turned into joints at a time."""
# A human leg, thigh plus shin, m; and the units files are found in: m, cm, mm, inch, foot, and
# CMU's own (an inch over their .45).
_LEG_RANGE = (0.60, 1.10)
_UNITS = (1.0, 0.01, 0.001, 0.0254, 0.3048, 0.0254 / 0.45)


def load_bvh(path: str | Path) -> HumanClip:
    """The clip in a BVH file, at the file's own rate, in metres, z up.

    Joint names as CMU, MotionBuilder, cgspeed or Acclaim have them; the scale is found from the
    legs. Raises StudioError with the line number for what cannot be read; a frame count that
    claims too much or too little is only logged.
    """
    path = Path(path)
    try:
        with path.open(encoding="utf-8-sig", errors="replace", newline=None) as file:
            return _read(Lines(file, path.name), path.stem)
    except (OSError, ValueError) as e:  # ValueError: a NUL in the path
        raise StudioError(f"cannot read {path}: {e}; give a BVH file") from e


def _read(lines: Lines, name: str) -> HumanClip:
    hierarchy = read_hierarchy(lines)
    try:
        skeleton = bvh_skeleton(hierarchy.names)
        scale = find_scale(hierarchy, skeleton)
    except StudioError as e:
        raise lines.error(str(e)) from None
    claimed, dt = _read_timing(lines)
    positions, confidences = [], []
    for block in _read_blocks(lines, hierarchy.num_channels):
        joints = hierarchy.joint_pos(block)
        if not positions:
            skeleton = bvh_skeleton(hierarchy.names, _find_axes(joints, skeleton))
        position, confidence = skeleton.to_canonical(joints * scale)
        positions.append(position)
        confidences.append(confidence)
    if not positions:
        raise lines.error("no frames after the header")
    joint_pos_w = np.concatenate(positions)
    if len(joint_pos_w) != claimed:
        log.warning("%s: claims %d frames, has %d", lines.name, claimed, len(joint_pos_w))
    return HumanClip(
        name=name,
        t=np.arange(len(joint_pos_w), dtype=np.float64) * dt,
        joint_pos_w=joint_pos_w,
        confidence=np.concatenate(confidences),
    )


def _read_timing(lines: Lines) -> tuple[int, float]:
    """Frames claimed and seconds a frame, of "Frames: 12" and "Frame Time:.01" however spaced."""
    values = []
    for key, example in (("frames:", "Frames: N"), ("frametime:", "Frame Time: SECONDS")):
        text = "".join(next(lines.rows(), [])).lower()
        if not text.startswith(key):
            raise lines.error(f"expected {example!r}")
        values.append(lines.finite(text[len(key) :]))
    frames, dt = values
    if not (frames >= 0 and frames == int(frames)):
        raise lines.error(f"Frames: {frames:g} is no count")
    if not 1e-4 <= dt <= 1.0:
        raise lines.error(f"Frame Time: {dt:g} s; 0.0001 to 1 would work")
    return int(frames), dt


def _read_blocks(lines: Lines, num_channels: int) -> Iterator[Array]:
    """Motion rows (≤ BLOCK, C), all finite; a last row that the end of the file cuts is dropped."""
    rows: list[Array] = []
    total = 0
    cut: StudioError | None = None
    for words in lines.rows():
        if cut is not None:
            raise cut  # a short row that is not the last
        if len(words) != num_channels:
            cut = lines.error(f"{len(words)} values; the joints have {num_channels} channels")
            if len(words) > num_channels or total == 0:
                raise cut
            continue
        try:
            row = np.array(words, dtype=np.float64)
        except ValueError:
            row = np.array([lines.finite(word) for word in words])
        if not np.isfinite(row).all():
            raise lines.error(f"{words[int(np.argmin(np.isfinite(row)))][:40]!r} is not finite")
        if np.abs(row).max() > 1e9:
            raise lines.error("a value beyond a thousand million: no position, no angle")
        rows.append(row)
        total += 1
        if total > MAX_FRAMES:
            raise lines.error(f"more than {MAX_FRAMES} frames")
        if len(rows) == BLOCK:
            yield np.array(rows)
            rows = []
    if cut is not None:
        log.warning("%s: the last frame is cut short and left out", lines.name)
    if rows:
        yield np.array(rows)


def find_scale(hierarchy: Hierarchy, skeleton: SourceSkeleton) -> float:
    """Metres in a file unit: the unit in use that makes the legs human, from their rest lengths.

    Where none does, the scale that makes them as long as the template's.
    """
    joints = hierarchy.joint_pos(np.zeros((1, hierarchy.num_channels)))[0]
    rest = skeleton.weights @ joints
    leg = 0.0
    for side in "lr":
        hip, knee, ankle = (rest[INDEX[f"{side}_{j}"]] for j in ("hip", "knee", "ankle"))
        leg += 0.5 * float(np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee))
    if not 1e-6 < leg < 1e9:
        raise StudioError(f"legs of length {leg:g}: OFFSETs of knees and ankles are needed")
    fitting = [unit for unit in _UNITS if _LEG_RANGE[0] <= leg * unit <= _LEG_RANGE[1]]
    if not fitting:
        return LEG_LENGTH / leg
    return min(fitting, key=lambda unit: abs(np.log(leg * unit / LEG_LENGTH)))


def _find_axes(joints: Array, skeleton: SourceSkeleton) -> Array:
    """Y-up or z-up: the axis along which the chest mostly is above the ankles, joints (T, J, 3)."""
    canonical = skeleton.weights @ joints
    ankles = 0.5 * (canonical[:, INDEX["l_ankle"]] + canonical[:, INDEX["r_ankle"]])
    up = np.median(canonical[:, INDEX["chest"]] - ankles, axis=0)
    return AXES_STUDIO if up[2] > abs(up[1]) else AXES_Y_UP
