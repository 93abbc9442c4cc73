"""A take to a small picture: person, reference and robot at the instant that shows most of it.

Lines in an SVG of a few hundred bytes, drawn from the take's table alone: no meshes, no fonts, no
style sheet, so that a page may show it as an image in either theme.
"""

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.errors import StudioError
from studio.human.skeleton import INDEX, PARENTS
from studio.robot.kinematics import foot_pos_w, link_frames_w
from studio.takes import bin
from studio.takes.columns import Columns
from studio.takes.edit import edited
from studio.takes.edit.edits import EDITS, Edits
from studio.takes.record.meta import TAPE
from studio.takes.session_library import SessionLibrary

Array = NDArray[np.float64]

WIDTH, HEIGHT = 200, 100
COLORS = {"person": "#e08a54", "reference": "#4f8ff2", "robot": "#8592a6"}
"""To be told apart on white and on nearly black."""
MOST_ROWS = 1500
"""Of the take that are looked through for the instant."""
_COLUMN = {"person": 34.0, "reference": 96.0, "robot": 162.0}
_FLOOR = 90.0
_LARGEST = {"person": 46.0, "reference": 104.0, "robot": 104.0}
"""Across the picture, units a metre: a robot of 0.3 m beside a person needs to be drawn larger."""
_ROOM = 0.31 * WIDTH, HEIGHT - 18.0
"""What a figure may take up."""
_AZIMUTH, _ELEVATION = -0.7, 0.22
"""rad: seen from ahead and from the figure's right, from a little above."""
_TRUNK = np.array([[x, y, z] for x in (-0.23, 0.25) for y in (-0.07, 0.07) for z in (-0.05, 0.06)])
"""(8, 3) m, corners of a box about the trunk, in its frame."""
_FACES = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
_FRONT = 1
_NEAR, _FAR = (0, 2), (1, 3)
"""Legs on the side that is seen, and on the other."""
PERSON_LINES = [(parent, i) for i, parent in enumerate(PARENTS) if parent >= 0]


def key_of(folder: Path) -> tuple[int, ...]:
    """Changes where a take's picture may; StudioError for a take without a tape."""
    try:
        tape = (folder / TAPE).stat()
    except OSError as error:
        raise StudioError(f"take {folder.name} has no tape: {error.strerror}") from error
    try:
        edits = os.stat(folder / EDITS).st_size
    except OSError:
        edits = 0
    return tape.st_size, tape.st_mtime_ns, edits


def folder_of(sessions: Path, name: str) -> Path:
    """The folder of a take by its name, or by its place in the bin; StudioError for neither."""
    if bin.is_place(name):
        return bin.folder_at(sessions, name)
    return SessionLibrary(sessions).folder(name)


def thumbnails(sessions: Path, names: Sequence[str]) -> tuple[dict[str, str], dict[str, str]]:
    """Pictures by name (or place in the bin), and why there is none of the others."""
    drawn, refused = {}, {}
    for name in names:
        try:
            drawn[name] = thumbnail(*edited.open_folder(folder_of(sessions, name)))
        except StudioError as error:
            refused[name] = str(error)
    return drawn, refused


def thumbnail(table: Columns, edits: Edits) -> str:
    """The SVG of a take as its edits leave it, WIDTH by HEIGHT."""
    i = telling_row(table, edits)
    row = table.rows[i]
    joints, _ = edited.human_at(table, edited.human_rows(np.array([i]), edits))
    drawn = []
    if np.isfinite(joints).all():
        drawn.append(_person(joints[0]))
    for name in ("reference", "robot"):
        pos, quat, joint_pos = (
            np.asarray(row[f"{name}_{key}"], dtype=np.float64)
            for key in ("base_pos", "base_quat", "joint_pos")
        )
        # Each faces the same way, wherever it went.
        level = geometry.quat_mul(geometry.quat_conj(geometry.heading_quat(quat)), quat)
        drawn.append(_robot(name, np.array([0.0, 0.0, pos[2]]), level, joint_pos))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" fill="none" '
        f'stroke-linecap="round" stroke-linejoin="round">{"".join(drawn)}</svg>'
    )


def telling_row(table: Columns, edits: Edits) -> int:
    """Of what the edits leave (of all, where that is nothing), the row in which the reference is
    furthest from how it mostly stands: in its joints, its tilt and its height, all near 1."""
    rows = np.flatnonzero(edited.kept(len(table), edits))
    rows = rows if len(rows) else np.arange(len(table))
    rows = rows[:: max(1, len(rows) // MOST_ROWS)]
    # Field by field: a row is a kilobyte, and the table may be of an hour.
    joint_pos = np.asarray(table.rows["reference_joint_pos"][rows], dtype=np.float64)
    up = geometry.up_in_body(table.rows["reference_base_quat"][rows])
    height = np.asarray(table.rows["reference_base_pos"][rows, 2:], dtype=np.float64)
    seen = np.isfinite(table.rows["human_t"][rows])
    pose = np.concatenate([joint_pos, 4.0 * up[:, :2], 5.0 * height], axis=1)
    far = np.abs(pose - np.median(pose, axis=0)).sum(axis=1)
    return int(rows[np.argmax(np.where(seen, far, far - 1e3))])


def _person(joints: Array) -> str:
    """joints (19, 3) m."""
    across = joints[INDEX["l_hip"]] - joints[INDEX["r_hip"]]
    turned = joints - joints[INDEX["pelvis"]]
    turned[:, :2] = geometry.turn_xy(turned[:, :2], -np.arctan2(-across[0], across[1]))
    turned[:, 2] -= turned[:, 2].min()
    xy = _projected("person", turned)
    x, y = xy[INDEX["head"]]
    head = f'<circle cx="{x:.1f}" cy="{y - 2:.1f}" r="6" fill="{COLORS["person"]}"/>'
    return _lines("person", xy, PERSON_LINES) + head


def _robot(name: str, base_pos: Array, base_quat: Array, joint_pos: Array) -> str:
    """base in the picture's frame, x forward; joints (12,) rad."""
    links, _ = link_frames_w(base_pos, base_quat, joint_pos)
    feet = foot_pos_w(base_pos, base_quat, joint_pos)
    trunk = base_pos + geometry.quat_rotate(base_quat, _TRUNK)
    xy = _projected(name, np.concatenate([trunk, links[2::3], links[3::3], feet]))
    corners, rest = xy[:8], xy[8:]

    def legs(which: tuple[int, int]) -> str:
        parts = [part for leg in which for part in ((leg, leg + 4), (leg + 4, leg + 8))]
        return _lines(name, rest, parts)

    faces = "".join(_outline(corners[list(face)]) for face in _FACES)
    front = _outline(corners[list(_FACES[_FRONT])])
    return (
        f'<g opacity=".6">{legs(_FAR)}</g>'
        f'<path stroke="{COLORS[name]}" stroke-width="3" fill="{COLORS[name]}" d="{faces}"/>'
        f'<path fill="#fff" fill-opacity=".4" d="{front}"/>{legs(_NEAR)}'
    )


def _projected(name: str, points: Array) -> Array:
    """(P, 2) where in the picture points (P, 3) m are, x forward; the lowest on the floor."""
    sin, cos = np.sin(_AZIMUTH), np.cos(_AZIMUTH)
    across = -sin * points[:, 0] + cos * points[:, 1]
    towards = cos * points[:, 0] + sin * points[:, 1]
    up = np.cos(_ELEVATION) * points[:, 2] - np.sin(_ELEVATION) * towards
    low = min(up.min(), 0.0)
    room = np.array(_ROOM) / np.maximum([np.ptp(across), up.max() - low], 0.01)
    scale = min(_LARGEST[name], *room)
    middle = 0.5 * (across.min() + across.max())
    return np.stack(
        [_COLUMN[name] + scale * (across - middle), _FLOOR - scale * (up - low)], axis=-1
    )


def _lines(name: str, xy: Array, pairs: Sequence[tuple[int, int]]) -> str:
    path = "".join(
        f"M{xy[a][0]:.1f} {xy[a][1]:.1f}L{xy[b][0]:.1f} {xy[b][1]:.1f}" for a, b in pairs
    )
    return f'<path stroke="{COLORS[name]}" stroke-width="5" d="{path}"/>'


def _outline(xy: Array) -> str:
    """A closed path, always round the same way: what lies over another is then filled, too."""
    x, y = xy.T
    if np.dot(x, np.roll(y, -1)) < np.dot(y, np.roll(x, -1)):
        xy = xy[::-1]
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in xy.tolist()) + "Z"
