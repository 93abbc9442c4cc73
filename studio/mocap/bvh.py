"""BVH file → HumanClip: a forgiving reader that either gives the motion or names the bad line.

Layout: https://research.cs.wisc.edu/graphics/Courses/cs-838-1999/Jeff/BVH.html. Files are read a
block of frames at a time, and only the canonical joints are kept, so memory is bounded.
"""

import logging
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.joint_names import bvh_skeleton
from studio.human.pose import HumanClip
from studio.human.sensor_skeletons import SourceSkeleton
from studio.human.skeleton import INDEX, LEG_LENGTH
from studio.mocap.bvh_header import Hierarchy, read_hierarchy
from studio.mocap.bvh_motion import MotionRows, read_timing
from studio.mocap.joint_maps import JointMaps
from studio.mocap.recorded import Recorded, settled
from studio.mocap.source_report import report_on
from studio.mocap.text import Lines, open_text
from studio.mocap.upright import find_axes

Array = NDArray[np.float64]
log = logging.getLogger(__name__)

MAX_BYTES = 512 * 2**20
# A human leg, thigh plus shin, m; and the units files are found in: m, cm, mm, inch, foot, and
# CMU's own (an inch over their .45).
_LEG_RANGE = (0.60, 1.10)
_UNITS = (1.0, 0.01, 0.001, 0.0254, 0.3048, 0.0254 / 0.45)


def load_bvh(path: str | Path) -> HumanClip:
    """The clip in a BVH file; see `read_bvh`."""
    return read_bvh(path).clip


def read_bvh(
    path: str | Path,
    joint_map: Mapping[str, Sequence[str]] | None = None,
    remembered: JointMaps | None = None,
) -> Recorded:
    """The clip in a BVH file, at the file's own rate, in metres, z up, and the report on it.

    Which joint is which is told by their names, by `joint_map` before that, and where none is
    given by the one remembered for these names; one that is given is remembered once it worked.
    Scale and the way up are found from the skeleton; the place is counted from where the person
    starts. Frames with what is no number are left out and reported. Raises StudioError with the
    line number for what cannot be read; a frame count that claims too much or too little is only
    logged.
    """
    path = Path(path)
    try:
        with open_text(path, MAX_BYTES) as file:
            recorded = _read(Lines(file, path.name), path.stem, joint_map, remembered)
    except OSError as e:
        raise StudioError(f"cannot read {path}: {e}; give a BVH file") from e
    if joint_map is not None and remembered is not None:
        remembered.remember(recorded.report.names, joint_map)
    return recorded


def read_joints(path: str | Path) -> Hierarchy:
    """The joints of a BVH file as it calls them, whoever they are; StudioError as above."""
    path = Path(path)
    with open_text(path, MAX_BYTES) as file:
        return read_hierarchy(Lines(file, path.name))


def _read(
    lines: Lines,
    name: str,
    by_hand: Mapping[str, Sequence[str]] | None,
    remembered: JointMaps | None,
) -> Recorded:
    hierarchy = read_hierarchy(lines)
    if by_hand is None and remembered is not None:
        by_hand = remembered.of(hierarchy.names)
    try:
        skeleton = bvh_skeleton(hierarchy.names, np.eye(3), hierarchy.parents, by_hand)
    except StudioError as e:
        raise type(e)(str(lines.error(str(e)))) from None
    claimed, dt = read_timing(lines)
    rows = MotionRows(lines, hierarchy.num_channels)
    body, blocks = None, []
    for numbers, motion in rows.blocks():
        try:
            body = body or _body(hierarchy, skeleton, motion)
        except StudioError as e:
            raise lines.error(str(e)) from None
        blocks.append((numbers * dt, *body.canonical(motion)))
    if body is None:
        if rows.refused.why:
            raise StudioError(f"{lines.name}, {rows.refused.why[0]}; it has no good frame")
        raise lines.error("no frames after the header")
    if rows.count != claimed:
        log.warning("%s: claims %d frames, has %d", lines.name, claimed, rows.count)
    t, joint_pos_w, confidence = (np.concatenate(part) for part in zip(*blocks, strict=True))
    clip = HumanClip(name=name, t=t, joint_pos_w=joint_pos_w, confidence=confidence)
    report = report_on(
        body.skeleton, scale_m=body.scale, refused=rows.refused, notes=tuple(_notes(body, by_hand))
    )
    return settled(clip, report)


@dataclass(frozen=True, kw_only=True)
class _Body:
    """A hierarchy whose size and axes are known. scale: m in a file unit. mirrored: the file's
    world is left-handed."""

    hierarchy: Hierarchy
    skeleton: SourceSkeleton
    scale: float
    mirrored: bool

    def canonical(self, motion: Array) -> tuple[Array, Array]:
        """joint_pos_w (T, 19, 3) m and confidence (T, 19) of rows (T, C)."""
        joints = self.hierarchy.joint_pos(motion, _needed(self.skeleton))
        return self.skeleton.to_canonical(joints * self.scale)


def _body(hierarchy: Hierarchy, skeleton: SourceSkeleton, motion: Array) -> _Body:
    """What rest pose and first rows (T, C) tell of a body. skeleton: in the file's own axes."""
    hierarchy = hierarchy.as_in(motion[0])
    rest, _ = skeleton.to_canonical(hierarchy.rest_pos())
    moving, _ = skeleton.to_canonical(hierarchy.joint_pos(motion, _needed(skeleton)))
    axes, mirrored = find_axes(moving, rest)
    return _Body(
        hierarchy=hierarchy,
        skeleton=replace(skeleton, axes=axes),
        scale=find_scale(rest, moving[0]),
        mirrored=mirrored,
    )


def _needed(skeleton: SourceSkeleton) -> list[int]:
    return np.flatnonzero(skeleton.weights.any(axis=0)).tolist()


def _notes(body: _Body, by_hand: Mapping[str, Sequence[str]] | None) -> Iterator[str]:
    if by_hand:
        yield f"by a joint map: {', '.join(by_hand)}"
    if body.mirrored:
        yield "a left-handed world: left and right were swapped"
    if body.hierarchy.added:
        yield "positions of joints are added to their OFFSETs"


def find_scale(rest: Array, first: Array) -> float:
    """Metres in a file unit: the unit in use that makes the legs human.

    rest, first: canonical joints (19, 3) in the rest pose and in the first frame, file units. The
    rest pose tells, unless the motion's positions say something else altogether. Where no unit
    fits, the scale is the one that makes the legs as long as the template's. Raises StudioError
    for legs of no length.
    """
    leg, moving = _leg(rest), _leg(first)
    if not 0.5 * moving < leg < 2.0 * moving:
        leg = moving
    if not 1e-6 < leg < 1e9:
        raise StudioError(f"legs of length {leg:g}: OFFSETs or positions of knees are needed")
    fitting = [unit for unit in _UNITS if _LEG_RANGE[0] <= leg * unit <= _LEG_RANGE[1]]
    if not fitting:
        return LEG_LENGTH / leg
    return min(fitting, key=lambda unit: abs(np.log(leg * unit / LEG_LENGTH)))


def _leg(joints: Array) -> float:
    """Thigh plus shin, mean of both legs, of canonical joints (19, 3)."""
    out = 0.0
    for side in "lr":
        hip, knee, ankle = (joints[INDEX[f"{side}_{j}"]] for j in ("hip", "knee", "ankle"))
        out += 0.5 * float(np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee))
    return out
