"""The person of a take to human frames, a JSON object a line: opens as source frames:FILE."""

from pathlib import Path

from studio.takes.export.bvh import some_poses
from studio.takes.record import codec
from studio.takes.take import Take


def write_frames(take: Take, path: Path) -> None:
    """Human frames of docs/contract.md (skeleton "studio") within the trim."""
    lines = [codec.encode("human", pose) for pose in some_poses(take)]
    path.write_bytes(b"\n".join(lines) + b"\n")
