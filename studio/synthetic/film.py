"""What a fake camera shows: the synthetic person, filmed as a mannequin."""

from pathlib import Path

from studio.synthetic.mannequin import Camera, Mannequin, mjpeg
from studio.synthetic.operator import OperatorSource
from studio.synthetic.time_code import stamp

FPS = 30
"""At which Chromium plays a file of joined JPEGs, again and again."""


def film(
    path: Path, *parts: tuple[str, float], camera: Camera | None = None, seed: int = 0
) -> Path:
    """A video of one person at one task after another, each for so many seconds.

    Each picture stands for two, as of a camera of 15 frames a second: drawing takes its time. Each
    frame says which it is (`time_code`), so that its way to the robot can be followed.
    """
    mannequin = Mannequin(camera)
    pictures = []
    for task, seconds in parts:
        person = OperatorSource(task, seed=seed)
        for k in range(0, round(seconds * FPS), 2):
            pose = person.read(k / FPS)
            assert pose is not None
            pictures.append(mannequin.picture(pose.joint_pos_w))
    frames = (stamp(pictures[k // 2], k) for k in range(2 * len(pictures)))
    path.write_bytes(b"".join(mjpeg(frames)))
    return path
