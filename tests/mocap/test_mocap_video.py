"""A video as a source: errors of what is none; with MediaPipe, the person in one."""

import ast
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

from studio.control.drive_command import PuppeteerConfig
from studio.errors import StudioError
from studio.human.skeleton import INDEX, NEUTRAL
from studio.live.source_reader import open_for
from studio.mocap import video, video_poses
from studio.mocap.video import PYTHON, read_video
from studio.sources import open_source
from studio.synthetic.mannequin import Mannequin, mjpeg
from studio.synthetic.operator import OperatorSource


@pytest.fixture(scope="module")
def mediapipe():
    """Skips where it is not installed: it is an extra."""
    python = os.environ.get(PYTHON) or sys.executable
    asked = [python, "-c", "import mediapipe, cv2"]
    if subprocess.run(asked, capture_output=True, check=False).returncode:
        pytest.skip("no MediaPipe: pip install 'a1-studio[video]'")


@pytest.fixture(scope="module")
def sitting(tmp_path_factory) -> Path:
    """Who stands for a second, then sits for two, as a mannequin at 15 pictures a second."""
    mannequin, pictures = Mannequin(), []
    for task, seconds in (("quiet", 1.0), ("sit_quiet", 2.0)):
        person = OperatorSource(task, seed=0)
        for k in range(0, round(30 * seconds), 2):
            pose = person.read(k / 30.0)
            assert pose is not None
            pictures.append(mannequin.picture(pose.joint_pos_w))
    path = tmp_path_factory.mktemp("video") / "sit.mjpeg"
    path.write_bytes(b"".join(mjpeg(pictures)))
    return path


@pytest.mark.usefixtures("mediapipe")
def test_the_person_in_a_video_sits_down(sitting):
    recorded = read_video(sitting)
    assert any(note.startswith("45 of 45") for note in recorded.report.notes)
    clip = recorded.clip
    assert np.all(np.diff(clip.t) > 0.0)
    hips, ankles = INDEX["l_hip"], INDEX["l_ankle"]
    tall = clip.joint_pos_w[:, hips, 2] - clip.joint_pos_w[:, ankles, 2]
    assert tall[-1] < 0.75 * tall[5]
    assert open_source(f"video:{sitting}").duration == pytest.approx(clip.seconds)


@pytest.mark.usefixtures("mediapipe")
def test_what_is_no_video_and_what_shows_nobody_are_refused(tmp_path):
    (tmp_path / "a.mp4").write_bytes(b"no video at all" * 100)
    with pytest.raises(StudioError, match=r"a\.mp4 is no video"):
        read_video(tmp_path / "a.mp4")
    grey = np.full((240, 320, 3), 128, np.uint8)
    (tmp_path / "b.mjpeg").write_bytes(b"".join(mjpeg([grey] * 5)))
    with pytest.raises(StudioError, match=r"b\.mjpeg shows nobody"):
        read_video(tmp_path / "b.mjpeg")


def test_what_is_not_there_is_said_so(tmp_path):
    with pytest.raises(StudioError, match=r"none\.mp4"):
        read_video(tmp_path / "none.mp4")
    with pytest.raises(StudioError):
        read_video("/dev/zero")
    with pytest.raises(StudioError, match="video:FILE"):
        open_source("video")


def _python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str) -> Path:
    """A program in Python's place, and a file to look at."""
    python = tmp_path / "python"
    python.write_text(f"#!/bin/sh\n{script}\n")
    python.chmod(0o755)
    monkeypatch.setenv(PYTHON, str(python))
    (tmp_path / "a.mp4").write_bytes(b"x")
    return tmp_path / "a.mp4"


def test_where_mediapipe_is_missing_it_is_said_how_to_get_it(tmp_path, monkeypatch):
    # -S: without any installed package.
    file = _python(tmp_path, monkeypatch, f'exec "{sys.executable}" -S "$@"')
    with pytest.raises(StudioError, match=r"pip install 'a1-studio\[video\]'"):
        read_video(file)


def test_a_decoder_that_crashes_or_hangs_takes_nothing_along(tmp_path, monkeypatch):
    file = _python(tmp_path, monkeypatch, "echo lost >&2; kill -SEGV $$")
    with pytest.raises(StudioError, match=r"a\.mp4 could not be looked at \(-11\)"):
        read_video(file)
    file = _python(tmp_path, monkeypatch, "exec sleep 60")
    monkeypatch.setattr(video, "MAX_S", 0.2)
    with pytest.raises(StudioError, match="takes longer"):
        read_video(file)
    monkeypatch.setenv(PYTHON, str(tmp_path / "nobody"))
    with pytest.raises(StudioError, match=PYTHON):
        read_video(file)


@pytest.mark.parametrize(
    "script",
    [
        "true",
        """echo '{"pictures": "x"}' >&2""",
        "head -c 100000 /dev/zero >&2",
        "printf '\\033[31mred' >&2; exit 3",
        """printf '{"t": 1' ; echo '[1]' >&2""",
    ],
)
def test_a_program_that_says_nonsense_is_a_line_of_text(tmp_path, monkeypatch, script):
    file = _python(tmp_path, monkeypatch, script)
    with pytest.raises(StudioError) as error:
        read_video(file)
    assert str(error.value).isprintable()
    assert len(str(error.value)) < 400


def test_what_a_library_says_after_the_end_loses_no_film(tmp_path, monkeypatch):
    frame = {"skeleton": "studio", "positions": NEUTRAL.tolist()}
    said = tmp_path / "said"
    said.write_text("\n".join(json.dumps({"t": k / 30, **frame}) for k in range(30)))
    told = json.dumps({"pictures": 30, "whole": True})
    _python(tmp_path, monkeypatch, f"cat '{said}'; echo '{told}' >&2; echo bye >&2")
    film = tmp_path / ("x" * 251 + ".mp4")
    film.write_bytes(b"x")
    assert read_video(film).clip.name == "x" * 251
    assert not list(Path(tempfile.gettempdir()).glob("a1-studio-*/video.jsonl"))


def test_a_studio_that_is_served_looks_at_no_video(tmp_path):
    with pytest.raises(StudioError, match="drive --source video"):
        open_for("video:a.mp4", PuppeteerConfig(), tmp_path)


def test_the_program_imports_nothing_of_the_studio():
    tree = ast.parse(Path(video_poses.__file__).read_text())
    found = {
        name.partition(".")[0]
        for node in ast.walk(tree)
        for name in (
            [alias.name for alias in node.names] if isinstance(node, ast.Import)
            else [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        )
    }  # fmt: skip
    assert found == {"json", "os", "sys", "pathlib", "typing", "cv2", "mediapipe"}
