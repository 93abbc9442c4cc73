"""What a fake camera shows: the synthetic person, filmed as a mannequin."""

from pathlib import Path

from studio.synthetic.mannequin import Camera, Mannequin, mjpeg
from studio.synthetic.operator import OperatorSource

FPS = 30
"""At which Chromium plays a file of joined JPEGs, again and again."""


def film(path: Path, *parts: tuple[str, float], camera: Camera | None = None) -> Path:
    """A video of one person at one task after another, each for so many seconds.

    Each picture stands for two, as of a camera of 15 frames a second: drawing takes its time.
    """
    mannequin = Mannequin(camera)
    pictures = []
    for task, seconds in parts:
        person = OperatorSource(task, seed=0)
        for k in range(0, round(seconds * FPS), 2):
            pose = person.read(k / FPS)
            assert pose is not None
            pictures.append(mannequin.picture(pose.joint_pos_w))
    path.write_bytes(b"".join(2 * picture for picture in mjpeg(pictures)))
    return path
