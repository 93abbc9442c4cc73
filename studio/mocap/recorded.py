"""A file of motion once read: the clip, and the report on what was found in it."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.human.pose import HumanClip
from studio.human.posture import SEEN
from studio.human.skeleton import INDEX
from studio.mocap.source_report import SourceReport

Array = NDArray[np.float64]
_GROUND = 2.0
"""m: a floor further up or down than this is no sensor's height, it is another origin."""

_FLUNG = 10.0
"""m/s: arms that drop from a T-pose within 1/24 s do 19, whatever happens to the place."""


@dataclass(frozen=True, kw_only=True)
class Recorded:
    """clip: the motion, as `settled`. report: what was found, and what was left out."""

    clip: HumanClip
    report: SourceReport


def settled(clip: HumanClip, report: SourceReport) -> Recorded:
    """A clip as read, without a rest pose for its first frame, its place counted from the start.

    Files of a capture volume, a game or a map may begin anywhere: forward and left are counted
    from the pelvis of the first frame, up from the floor where that is far from 0.
    """
    if _begins_at_rest(clip):
        report = replace(
            report,
            refused=report.refused.plus("frame 1: a rest pose, from which the motion jumps"),
        )
        clip = _from(clip, 1)
    pos, sure = clip.joint_pos_w[0], clip.confidence[0] >= SEEN
    origin = np.append(pos[INDEX["pelvis"], :2] if sure[INDEX["pelvis"]] else np.zeros(2), 0.0)
    lowest = pos[sure, 2].min() if sure.any() else 0.0
    origin[2] = lowest if abs(lowest) > _GROUND else 0.0
    if np.linalg.norm(origin) > 10.0:
        at = ", ".join(f"{v:.6g}" for v in origin)
        report = replace(report, notes=(*report.notes, f"it begins at {at} m: counted from there"))
    return Recorded(clip=replace(clip, joint_pos_w=clip.joint_pos_w - origin), report=report)


def _begins_at_rest(clip: HumanClip) -> bool:
    """The body is flung from the first frame to the second, and nothing of the kind follows."""
    if len(clip) < 3:
        return False
    moved = np.linalg.norm(np.diff(clip.joint_pos_w[:3], axis=0), axis=-1)
    both = np.minimum(clip.confidence[:2], clip.confidence[1:3]) >= SEEN
    speed = (moved * both).max(axis=-1) / np.diff(clip.t[:3])
    return bool(speed[0] > max(_FLUNG, 4.0 * speed[1]))


def _from(clip: HumanClip, first: int) -> HumanClip:
    return HumanClip(
        name=clip.name,
        t=clip.t[first:],
        joint_pos_w=clip.joint_pos_w[first:],
        confidence=clip.confidence[first:],
    )
