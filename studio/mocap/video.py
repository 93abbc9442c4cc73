"""`video:FILE`: what the page's camera would have seen of the person in a video, without a browser.

The same model as the page's looks at every picture, on this machine (`video_poses`).
"""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import msgspec

from studio.errors import StudioError
from studio.files import open_regular, scratch_folder
from studio.mocap import video_poses
from studio.mocap.frames import read_frames
from studio.mocap.recorded import Recorded
from studio.paths import package_folder

MODEL = "lite"
"""The page's own default."""
PYTHON = "A1_STUDIO_VIDEO_PYTHON"
"""Environment variable: the Python of an environment that has MediaPipe, if this one has not."""
MAX_BYTES = 4 * 2**30
_TAIL = 65_536
"""Bytes of what the program said last that are read."""
MAX_S = 3600.0
"""s that looking at a video may take."""


def read_video(path: str | Path) -> Recorded:
    """The person in a video, and how many of its pictures show nobody.

    Raises StudioError for what is no video, shows nobody, or where MediaPipe is not installed.
    """
    path = Path(path)
    with open_regular(path, MAX_BYTES):
        pass  # a regular file, and there
    model = package_folder("web_assets") / "vendor" / "mediapipe" / f"pose_{MODEL}.task"
    if not model.is_file():
        raise StudioError("the pose model is not installed: run `make setup` first")
    with scratch_folder("a1-studio-") as folder:
        frames = folder / "video.jsonl"
        said = _look(path, model, frames)
        if not frames.stat().st_size:
            raise StudioError(f"{path.name} shows nobody whom the model could find")
        recorded = read_frames(frames)
    recorded = replace(recorded, clip=replace(recorded.clip, name=path.stem))
    report, seen = recorded.report, len(recorded.clip)
    notes = [*report.notes, f"{seen} of {said.pictures} pictures show a person"]
    if not said.whole:
        notes.append(f"only its first {video_poses.MAX_FRAMES} pictures were looked at")
    return replace(recorded, report=replace(report, notes=tuple(notes)))


class _Said(msgspec.Struct):
    """What the program says at its end."""

    pictures: int
    whole: bool


def _look(path: Path, model: Path, frames: Path) -> _Said:
    """Run the model over the video; what it says at its end."""
    command = [
        os.environ.get(PYTHON) or sys.executable,
        video_poses.__file__,
        str(path),
        str(model),
    ]
    spoken = frames.with_suffix(".log")
    with frames.open("wb") as out, spoken.open("wb") as err:
        try:
            done = subprocess.run(command, stdout=out, stderr=err, timeout=MAX_S, check=False)
        except subprocess.TimeoutExpired as error:
            raise StudioError(f"{path.name} takes longer than {MAX_S:.0f} s to look at") from error
        except OSError as error:
            raise StudioError(f"{PYTHON}={command[0]} cannot be run: {error.strerror}") from error
    with spoken.open("rb") as file:
        file.seek(max(0, spoken.stat().st_size - _TAIL))
        lines = [line for line in file.read().decode(errors="replace").splitlines() if line.strip()]
    last = "".join(c for c in (lines or ["it said nothing"])[-1] if c.isprintable())[:300]
    if done.returncode == video_poses.UNUSABLE:
        raise StudioError(last)
    for line in reversed(lines):  # libraries that it uses speak, too
        if not done.returncode and line.startswith("{"):
            try:
                return msgspec.json.decode(line, type=_Said)
            except msgspec.MsgspecError:
                continue
    raise StudioError(f"{path.name} could not be looked at ({done.returncode}): {last}")
