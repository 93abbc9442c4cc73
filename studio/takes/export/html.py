"""A take to one HTML file that replays the three figures anywhere, without a server or a network.

The robots are drawn with Unitree's meshes. The page's parts are in web_assets/replay.
"""

import base64
import html
import re
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.errors import StudioError
from studio.human.shape import BONE_RADII, BONES, JOINT_RADII
from studio.human.skeleton import INDEX, PARENTS
from studio.paths import package_folder
from studio.robot import a1
from studio.robot.meshes import link_meshes
from studio.takes.export.episodes import nothing_left
from studio.takes.export.extent import Extent, extent
from studio.takes.take import Take

Array = NDArray[np.float64]

MOST_FRAMES = 15_000
"""Eight minutes at 30 Hz, some 4 MB; longer takes are thinned."""
SCRIPTS = ("space.js", "solids.js", "painter.js", "figures.js", "player.js")
"""Of the page, in the order in which they need each other."""
TINT = (0.36, 0.61, 1.0)
_TRUNK, _LIMB, _JOINT = (0.80, 0.41, 0.24), (0.87, 0.51, 0.33), (0.91, 0.62, 0.46)
_ANGLE, _TURN = 7000.0, 32767.0
_FOLLOW = 0.12
"""How fast a figure's column follows it, a frame."""


def write_html(take: Take, path: Path) -> None:
    """Person, shown motion and simulated robot, side by side: play, scrub, speed, turn the view.

    Raises StudioError when the edits leave nothing of the take.
    """
    part = extent(take)
    if not len(part.tick):
        raise StudioError(nothing_left(take))
    step = max(1, -(-len(part.tick) // MOST_FRAMES))
    tick = part.tick[::step]
    groups = (
        ("What it should do", take.arrays.reference, TINT),
        ("What physics lets it do", take.arrays.robot, None),
    )
    robots = [
        _robot(title, {key: x[tick] for key, x in group.items()}, color)
        for title, group, color in groups
    ]
    shapes, links = _meshes()
    data = {
        "name": take.name,
        "label": take.label,
        "fps": a1.CONTROL_HZ / step,
        "states": [take.arrays.state[i] for i in tick.tolist()],
        "person": _person(take, part, step),
        "robots": [robot for robot, _ in robots],
        "passed": _packed(robots[-1][1], "<f4"),
        "shapes": shapes,
        "links": links,
        "offsets": _offsets(),
        "foot": a1.CALF_LENGTH,
    }
    path.write_text(_page(f"{take.label or take.name} · a1-studio", data), encoding="utf-8")


def _page(title: str, data: dict[str, Any]) -> str:
    folder = package_folder("web_assets") / "replay"
    parts = {
        "title": html.escape(title),
        "style": (folder / "page.css").read_text("utf-8"),
        "script": script([(folder / name).read_text("utf-8") for name in SCRIPTS]),
        # "<" would end the script element early if a label held "</script>".
        "data": msgspec.json.encode(data).decode().replace("<", "\\u003c"),
    }
    page = (folder / "page.html").read_text("utf-8")
    return re.sub(r"{{(\w+)}}", lambda found: parts[found[1]], page)


def script(modules: list[str]) -> str:
    """Modules as one: a page from a file may import nothing. Their names must differ."""
    text = "\n".join(modules)
    text = re.sub(r"^import [^;]*;\n", "", text, flags=re.MULTILINE)
    return re.sub(r"^export ", "", text, flags=re.MULTILINE)


def _robot(
    title: str, pose: dict[str, Array], color: tuple[float, ...] | None
) -> tuple[dict[str, Any], Array]:
    """A row a frame, and (N, 2) m where its column has followed it; it faces ahead at first."""
    begun = geometry.quat_conj(geometry.heading_quat(pose["base_quat"][0]))
    pos = geometry.quat_rotate(begun, pose["base_pos"] - pose["base_pos"][0] * (1.0, 1.0, 0.0))
    quat = geometry.quat_mul(begun, pose["base_quat"])
    follow = _followed(pos[:, :2])
    pos[:, :2] -= follow
    stands = (pose["foot_contact"] > 0.5) @ (1 << np.arange(4))
    rows = np.column_stack([1e3 * pos, _TURN * quat, _ANGLE * pose["joint_pos"], stands])
    return {"title": title, "data": _packed(rows, "<i2"), "color": color}, follow


def _person(take: Take, part: Extent, step: int) -> dict[str, Any] | None:
    """None where nobody was seen. They face ahead at first, their lowest foot on the floor."""
    seen = np.flatnonzero(part.confidence[::step].any(axis=1))
    if not len(seen):
        return None
    # As they were seen last; before they were seen at all, as they were then.
    last = np.searchsorted(seen, np.arange(len(part.human[::step])), side="right") - 1
    joints = part.human[::step][seen[np.maximum(last, 0)]]
    left = INDEX["l_hip"], INDEX["r_hip"]
    across = joints[0, left[0]] - joints[0, left[1]]
    turned = joints.copy()
    turned[..., :2] = geometry.turn_xy(joints[..., :2], -np.arctan2(-across[0], across[1]))
    follow = _followed(turned[:, INDEX["pelvis"], :2])
    turned[..., :2] -= follow[:, None]
    turned[..., 2] -= np.percentile(turned[..., 2].min(axis=1), 5)
    invented = str((take.meta.get("about") or {}).get("source", "")).startswith("operator")
    colors = [
        _TRUNK if name in ("pelvis", "spine", "chest") else _JOINT if "_" not in name else _LIMB
        for name in INDEX
    ]
    return {
        "title": "Synthetic person" if invented else "Recorded person",
        "data": _packed(1e3 * turned, "<i2"),
        "bones": [[PARENTS[i], i, *radii] for i, radii in zip(BONES, BONE_RADII.tolist())],
        "joints": JOINT_RADII.tolist(),
        "left": left,
        "colors": colors,
    }


def _followed(xy: Array) -> Array:
    """(N, 2) smoothed, there and back, so that it does not lag."""
    out = xy.copy()
    for order in (range(1, len(xy)), range(len(xy) - 2, -1, -1)):
        for i in order:
            before = out[i - order.step]
            out[i] = before + _FOLLOW * (out[i] - before)
    return out


def _meshes() -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """The different shapes, and which of them each link has, in which colour."""
    shapes: list[dict[str, Any]] = []
    links, known = [], dict[int, int]()
    for mesh in link_meshes().values():
        if id(mesh) not in known:
            known[id(mesh)] = len(shapes)
            unit = float(np.abs(mesh.vertices).max()) / 32767.0
            shapes.append(
                {
                    "vertices": _packed(mesh.vertices / unit, "<i2"),
                    "faces": _packed(mesh.faces, "<u2"),
                    "unit": unit,
                }
            )
        color = [round(part / 255, 3) for part in mesh.color]
        links.append({"shape": known[id(mesh)], "color": color})
    return shapes, links


def _offsets() -> dict[str, Any]:
    """Of each joint in the link before it, m."""
    thigh = [[0.0, side * a1.THIGH_OFFSET, 0.0] for side in a1.SIDE.tolist()]
    return {"hip": a1.HIP_OFFSET.tolist(), "thigh": thigh, "calf": [0.0, 0.0, -a1.THIGH_LENGTH]}


def _packed(values: NDArray[Any], kind: str) -> str:
    """Base64 of numbers of a numpy kind; whole ones rounded, and no larger than fit."""
    if kind != "<f4":
        values = np.clip(np.rint(values), np.iinfo(kind).min, np.iinfo(kind).max)
    return base64.b64encode(np.ascontiguousarray(values, kind).tobytes()).decode()
