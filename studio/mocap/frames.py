"""A file of human frames, one JSON object a line (docs/contract.md) → HumanClip."""

import logging
from pathlib import Path

import numpy as np

from studio.errors import StudioError
from studio.human.pose import HumanClip, HumanPose
from studio.mocap.gate import MAX_BYTES, FrameGate, FrameRejected

log = logging.getLogger(__name__)

MAX_FRAMES = 1_000_000


def load_frames(path: str | Path) -> tuple[HumanClip, int]:
    """The clip in a file of frames, and how many lines were refused.

    A line that does not fit is refused, counted and logged (the first few), and the rest read on.
    Raises StudioError when the file cannot be read or holds no good frame, with the first reason.
    """
    path = Path(path)
    gate = FrameGate(live=False)
    poses: list[HumanPose] = []
    first = ""
    try:
        with path.open("rb") as file:
            number = 0
            # A bounded readline: a file without line ends must not fill the memory.
            while line := file.readline(MAX_BYTES + 2):
                number += 1
                if number == 1:
                    line = line.removeprefix(b"\xef\xbb\xbf")
                if not line.strip():
                    continue
                try:
                    poses.append(gate.check(line))
                except FrameRejected as e:
                    first = first or f"line {number}: {e}"
                    if gate.rejected <= 5:
                        log.warning("%s, line %d: %s", path.name, number, e)
                if len(poses) > MAX_FRAMES:
                    raise StudioError(f"{path.name}: more than {MAX_FRAMES} frames")
    except (OSError, ValueError) as e:  # ValueError: a NUL in the path
        raise StudioError(f"cannot read {path}: {e}; give a file of human frames") from e
    if not poses:
        raise StudioError(f"{path.name} holds no good frame; {first or 'it is empty'}")
    clip = HumanClip(
        name=path.stem,
        t=np.array([pose.t for pose in poses]),
        joint_pos_w=np.stack([pose.joint_pos_w for pose in poses]),
        confidence=np.stack([pose.confidence for pose in poses]),
    )
    return clip, gate.rejected
