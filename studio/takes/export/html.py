"""A take to one HTML file that replays both figures anywhere, without a server or a network."""

import base64
import html
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.skeleton import PARENTS
from studio.robot import a1, kinematics
from studio.robot.legs import link_frames_w
from studio.takes.export.episodes import nothing_left
from studio.takes.export.extent import extent
from studio.takes.export.replay_page import PAGE
from studio.takes.take import Take

Array = NDArray[np.float64]

MOST_FRAMES = 18_000
"""Ten minutes at 30 Hz, some 8 MB; longer takes are thinned."""
_UNIT = 1e-3
"""m: points are whole millimetres from each figure's middle of the way, in 16 bits."""


def write_html(take: Take, path: Path) -> None:
    """Person, shown motion and simulated robot, side by side: play, scrub, speed, turn the view.

    Raises StudioError when the edits leave nothing of the take.
    """
    part = extent(take)
    if not len(part.tick):
        raise StudioError(nothing_left(take))
    step = max(1, -(-len(part.tick) // MOST_FRAMES))
    tick = part.tick[::step]
    figures = []
    if part.confidence.any():
        bones = [[p, i] for i, p in enumerate(PARENTS) if p >= 0]
        figures.append(_figure("person", part.human[::step], bones))
    for title, group in (("shown", take.arrays.reference), ("robot", take.arrays.robot)):
        poses = [group[key][tick] for key in ("base_pos", "base_quat", "joint_pos")]
        figures.append(_figure(title, robot_points(*poses), ROBOT_LINES))
    data = {
        "name": take.name,
        "label": take.label,
        "fps": a1.CONTROL_HZ / step,
        "states": [take.arrays.state[i] for i in tick.tolist()],
        "figures": figures,
    }
    # "<" would end the script element early if a label held "</script>".
    text = msgspec.json.encode(data).decode().replace("<", "\\u003c")
    title = html.escape(f"{take.label or take.name} · a1-studio")
    page = PAGE.replace("{{title}}", title).replace("{{data}}", text)
    path.write_text(page, encoding="utf-8")


def _figure(title: str, points: Array, lines: list[list[int]]) -> dict[str, object]:
    """Points (N, P, 3) m, drawn about where the figure stands on average."""
    middle = np.append(np.median(points[..., :2], axis=(0, 1)), 0.0)
    whole = np.clip(np.rint((points - middle) / _UNIT), -32768, 32767).astype("<i2")
    return {
        "title": title,
        "points": points.shape[1],
        "lines": lines,
        "data": base64.b64encode(whole.tobytes()).decode(),
    }


def robot_points(base_pos: Array, base_quat: Array, joint_pos: Array) -> Array:
    """Points (N, 17, 3) m in the world: trunk, hip, thigh and calf frame of FR FL RR RL, four feet.

    base (N, 3), (N, 4) in the world, joints (N, 12) rad.
    """
    links, _ = link_frames_w(base_pos, base_quat, joint_pos)
    return np.concatenate([links, kinematics.foot_pos_w(base_pos, base_quat, joint_pos)], axis=-2)


def _robot_lines() -> list[list[int]]:
    hips = [1 + 3 * leg for leg in range(4)]
    trunk = [[hips[0], hips[1]], [hips[1], hips[3]], [hips[3], hips[2]], [hips[2], hips[0]]]
    legs = [
        pair
        for leg, hip in enumerate(hips)
        for pair in ([hip, hip + 1], [hip + 1, hip + 2], [hip + 2, 13 + leg])
    ]
    return trunk + legs


ROBOT_LINES = _robot_lines()
