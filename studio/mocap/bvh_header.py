"""The HIERARCHY of a BVH file: words → joints, channels and their forward kinematics."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from studio.mocap.text import Lines

Array = NDArray[np.float64]
ByJoint = tuple[tuple[tuple[int, int], ...], ...]

MAX_JOINTS = 1_000
_AXIS = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True, kw_only=True)
class Hierarchy:
    """Joints in file order (end sites too, as "J/end"), and the columns of the motion table.

    names: J. parents: index of each's parent, -1 for the root. offsets: (J, 3) file units: the
    rest pose. positions, rotations: per joint (axis, column) in file order. num_channels: columns.
    added: positions of all but the root are added to OFFSET; else they replace it.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Array
    positions: ByJoint
    rotations: ByJoint
    num_channels: int
    added: bool = False

    def rest_pos(self) -> Array:
        """(J, 3), file units: the joints of the rest pose, the root where its OFFSET says."""
        pos = self.offsets.copy()
        for j, parent in enumerate(self.parents):
            if parent >= 0:
                pos[j] += pos[parent]
        return pos

    def joint_pos(self, motion: Array, joints: Iterable[int] | None = None) -> Array:
        """Forward kinematics: rows (T, C), angles in degrees → (T, J, 3), file units and axes.

        A joint's R is R1 R2 R3 in the order of its channels; position channels replace OFFSET
        unless `added`. joints: those that matter (default all); others come back as zeros.
        """
        num = len(motion)
        pos = np.zeros((num, len(self.names), 3))
        rot: dict[int, Array] = {-1: np.broadcast_to(np.eye(3), (num, 3, 3))}
        for j in sorted(self._with_ancestors(range(len(self.names)) if joints is None else joints)):
            parent = self.parents[j]
            local = np.broadcast_to(self.offsets[j], (num, 3)).copy()
            for axis, column in self.positions[j]:
                kept = self.offsets[j][axis] if self.added and parent >= 0 else 0.0
                local[:, axis] = kept + motion[:, column]
            turn = rot[parent]
            at = pos[:, parent] if parent >= 0 else 0.0
            pos[:, j] = at + (turn @ local[..., None])[..., 0]
            for axis, column in self.rotations[j]:
                turn = turn @ _about(axis, np.radians(motion[:, column]))
            rot[j] = turn
        return pos

    def _with_ancestors(self, joints: Iterable[int]) -> set[int]:
        out: set[int] = set()
        for joint in joints:
            while joint >= 0 and joint not in out:
                out.add(joint)
                joint = self.parents[joint]
        return out

    def as_in(self, row: Array) -> "Hierarchy":
        """The same with `added` as a first row (C,) shows it: positions that are all about zero, of
        joints whose OFFSETs are not, are displacements."""
        lengths = [
            (np.linalg.norm([row[c] for _, c in self.positions[j]]), np.linalg.norm(offset))
            for j, offset in enumerate(self.offsets)
            if self.parents[j] >= 0 and len(self.positions[j]) == 3
        ]
        moved, rest = np.median(lengths, axis=0) if lengths else (0.0, 0.0)
        return replace(self, added=bool(moved < 0.1 * rest))


def _about(axis: int, angle: Array) -> Array:
    """Rotation matrices (T, 3, 3) about a coordinate axis."""
    out = np.zeros((len(angle), 3, 3))
    i, k = (axis + 1) % 3, (axis + 2) % 3
    out[:, axis, axis] = 1.0
    out[:, i, i] = out[:, k, k] = np.cos(angle)
    out[:, k, i] = np.sin(angle)
    out[:, i, k] = -out[:, k, i]
    return out


@dataclass(kw_only=True)
class _Joint:
    name: str
    parent: int
    offset: Array | None = None
    channels: list[tuple[str, int, int]] = field(default_factory=list)  # kind, axis, column


def read_hierarchy(lines: Lines) -> Hierarchy:
    """Everything up to and with the word MOTION; StudioError with the line for what is wrong."""
    if lines.word().lower() != "hierarchy":
        raise lines.error("a BVH file begins with HIERARCHY")
    joints: list[_Joint] = []
    stack: list[int] = []
    columns = 0
    opening = False  # a joint was named and its brace is still to come
    while True:
        word = lines.word()
        key = word.lower()
        inside = bool(stack) and not opening
        if (key == "root" and not joints) or (key in ("joint", "end") and inside):
            name = lines.name_until_brace()  # of an end site "Site", and what some call it
            if not name:
                raise lines.error(
                    "a joint without a name" if key != "end" else "End is followed by Site"
                )
            parent = stack[-1] if stack else -1
            if key == "end":
                name = f"{joints[parent].name}/end"
            joints.append(_Joint(name=name, parent=parent))
            opening = True
        elif key == "{" and opening:
            stack.append(len(joints) - 1)
            opening = False
        elif key == "}" and inside:
            stack.pop()
        elif key == "offset" and inside:
            _read_offset(lines, joints[stack[-1]])
        elif key == "channels" and inside:
            columns = _read_channels(lines, joints[stack[-1]], columns)
        elif key == "motion" and not opening and not stack and columns:
            return _hierarchy(joints, columns)
        else:
            raise lines.error(f"{word[:40]!r} is not expected here, {_where(joints, stack)}")
        if len(joints) > MAX_JOINTS:
            raise lines.error(f"more than {MAX_JOINTS} joints")


def _where(joints: list[_Joint], stack: list[int]) -> str:
    if stack:
        return f"inside {joints[stack[-1]].name}"
    return f"after {joints[-1].name}" if joints else "where ROOT NAME should come"


def _read_offset(lines: Lines, joint: _Joint) -> None:
    if joint.offset is not None:
        raise lines.error(f"OFFSET of {joint.name}: once per joint")
    joint.offset = np.array([lines.finite(lines.word()) for _ in range(3)])


def _read_channels(lines: Lines, joint: _Joint, column: int) -> int:
    """Read CHANNELS of one joint; the number of columns so far, with these.

    Channels of scale have their columns and mean nothing: bones do not grow.
    """
    count = lines.finite(lines.word())
    if joint.channels or count not in range(10):
        raise lines.error(f"CHANNELS {count:g} of {joint.name}: once per joint, 0 to 9 of them")
    for k in range(int(count)):
        word = lines.word().lower()
        kind, axis = word[1:], _AXIS.get(word[:1])
        if axis is None or kind not in ("position", "rotation", "scale"):
            raise lines.error(f"{word[:40]!r} is no channel: Xposition … Zrotation are")
        joint.channels.append((kind, axis, column + k))
    return column + int(count)


def _hierarchy(joints: list[_Joint], columns: int) -> Hierarchy:
    def by_joint(kind: str) -> ByJoint:
        return tuple(tuple((a, c) for k, a, c in joint.channels if k == kind) for joint in joints)

    return Hierarchy(
        names=tuple(joint.name for joint in joints),
        parents=tuple(joint.parent for joint in joints),
        offsets=np.array([np.zeros(3) if j.offset is None else j.offset for j in joints]),
        positions=by_joint("position"),
        rotations=by_joint("rotation"),
        num_channels=columns,
    )
