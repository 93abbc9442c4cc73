"""`video:FILE`: what the page's camera would have seen of the person in a video, without a browser.

The same model as the page's looks at every picture, on this machine (`video_poses`).
"""

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from studio.errors import StudioError
from studio.files import open_regular
from studio.mocap import video_poses
from studio.mocap.frames import read_frames
from studio.mocap.recorded import Recorded
from studio.paths import package_folder

MODEL = "lite"
"""The page's own default."""
PYTHON = "A1_STUDIO_VIDEO_PYTHON"
"""Environment variable: the Python of an environment that has MediaPipe, if this one has not."""
MAX_BYTES = 4 * 2**30
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
    with tempfile.TemporaryDirectory(prefix="a1-studio-") as folder:
        frames = Path(folder) / f"{path.stem or 'video'}.jsonl"
        said = _look(path, model, frames)
        if not frames.stat().st_size:
            raise StudioError(f"{path.name} shows nobody whom the model could find")
        recorded = read_frames(frames)
    report, seen = recorded.report, len(recorded.clip)
    notes = [*report.notes, f"{seen} of {said['pictures']} pictures show a person"]
    if not said["whole"]:
        notes.append(f"only its first {video_poses.MAX_FRAMES} pictures were looked at")
    return replace(recorded, report=replace(report, notes=tuple(notes)))


def _look(path: Path, model: Path, frames: Path) -> dict[str, int]:
    """Run the model over the video; what it says at its end."""
    command = [
        os.environ.get(PYTHON) or sys.executable,
        video_poses.__file__,
        str(path),
        str(model),
    ]
    with frames.open("wb") as out:
        try:
            done = subprocess.run(
                command, stdout=out, stderr=subprocess.PIPE, timeout=MAX_S, check=False
            )
        except subprocess.TimeoutExpired as error:
            raise StudioError(f"{path.name} takes longer than {MAX_S:.0f} s to look at") from error
        except OSError as error:
            raise StudioError(f"{PYTHON}={command[0]} cannot be run: {error.strerror}") from error
    last = done.stderr.decode(errors="replace").strip().rpartition("\n")[2]
    if done.returncode == video_poses.UNUSABLE:
        raise StudioError(last)
    if done.returncode:
        raise StudioError(f"{path.name} could not be looked at ({done.returncode}): {last[:300]}")
    return json.loads(last)
