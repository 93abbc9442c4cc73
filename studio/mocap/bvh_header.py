"""The HIERARCHY of a BVH file: words → joints, channels and their forward kinematics."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError

Array = NDArray[np.float64]
ByJoint = tuple[tuple[tuple[int, int], ...], ...]

MAX_JOINTS = 1_000
MAX_LINE = 200_000
"""Characters in a line; no honest frame is longer."""
_AXIS = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True, kw_only=True)
class Hierarchy:
    """Joints in file order (end sites too, as "J/end"), and the columns of the motion table.

    names: J. parents: index of each's parent, -1 for the root. offsets: (J, 3) file units.
    positions, rotations: per joint (axis, column) in file order. num_channels: columns.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Array
    positions: ByJoint
    rotations: ByJoint
    num_channels: int

    def joint_pos(self, motion: Array) -> Array:
        """Forward kinematics: rows (T, C), angles in degrees → (T, J, 3), file units and axes.

        A joint's R is R1 R2 R3 in the order of its channels; position channels replace OFFSET.
        """
        num = len(motion)
        pos = np.empty((num, len(self.names), 3))
        rot: list[Array] = []
        for j, parent in enumerate(self.parents):
            local = np.broadcast_to(self.offsets[j], (num, 3)).copy()
            for axis, column in self.positions[j]:
                local[:, axis] = motion[:, column]
            turn = rot[parent] if parent >= 0 else np.broadcast_to(np.eye(3), (num, 3, 3))
            at = pos[:, parent] if parent >= 0 else 0.0
            pos[:, j] = at + (turn @ local[..., None])[..., 0]
            for axis, column in self.rotations[j]:
                turn = turn @ _about(axis, np.radians(motion[:, column]))
            rot.append(turn)
        return pos


def _about(axis: int, angle: Array) -> Array:
    """Rotation matrices (T, 3, 3) about a coordinate axis."""
    out = np.zeros((len(angle), 3, 3))
    i, k = (axis + 1) % 3, (axis + 2) % 3
    out[:, axis, axis] = 1.0
    out[:, i, i] = out[:, k, k] = np.cos(angle)
    out[:, k, i] = np.sin(angle)
    out[:, i, k] = -out[:, k, i]
    return out


class Lines:
    """A text file as lines of words that know their number; `error` names the line."""

    def __init__(self, file: TextIO, name: str) -> None:
        self._file, self.name, self.number = file, name, 0
        self._words: list[str] = []

    def error(self, what: str) -> StudioError:
        """The complaint about the line read last."""
        return StudioError(f"{self.name}, line {self.number}: {what}")

    def rows(self) -> Iterator[list[str]]:
        """The words of each line left that is not blank; a brace is always a word of its own."""
        while text := self._file.readline(MAX_LINE + 1):
            self.number += 1
            if len(text) > MAX_LINE:
                raise self.error(f"longer than {MAX_LINE} characters: this is no BVH file")
            if "{" in text or "}" in text:
                text = text.replace("{", " { ").replace("}", " } ")
            if words := text.split():
                yield words

    def word(self) -> str:
        """The next word, on this line or a later one."""
        if not self._words:
            self._words = next(self.rows(), [])
        if not self._words:
            raise self.error("the file ends here, inside its header")
        return self._words.pop(0)

    def name_until_brace(self) -> str:
        """What is left of this line, up to a brace, as one name (some names hold blanks)."""
        name = []
        while self._words and self._words[0] != "{":
            name.append(self._words.pop(0))
        if not name:
            raise self.error("a joint without a name")
        return " ".join(name)

    def finite(self, word: str) -> float:
        """The number a word says."""
        try:
            value = float(word)
        except ValueError:
            raise self.error(f"{word[:40]!r} is no number") from None
        if not np.isfinite(value):
            raise self.error(f"{word[:40]!r} is not finite")
        return value


@dataclass(kw_only=True)
class _Joint:
    name: str
    parent: int
    offset: Array = field(default_factory=lambda: np.zeros(3))
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
        if key == "root" and not joints:
            joints.append(_Joint(name=lines.name_until_brace(), parent=-1))
            opening = True
        elif key in ("joint", "end") and inside:
            name = _end(lines, joints[stack[-1]]) if key == "end" else lines.name_until_brace()
            joints.append(_Joint(name=name, parent=stack[-1]))
            opening = True
        elif key == "{" and opening:
            stack.append(len(joints) - 1)
            opening = False
        elif key == "}" and inside:
            stack.pop()
        elif key == "offset" and inside:
            joints[stack[-1]].offset = np.array([lines.finite(lines.word()) for _ in range(3)])
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


def _end(lines: Lines, parent: _Joint) -> str:
    if lines.word().lower() != "site":
        raise lines.error("End is followed by Site")
    return f"{parent.name}/end"


def _read_channels(lines: Lines, joint: _Joint, column: int) -> int:
    """Read CHANNELS of one joint; the number of columns so far, with these."""
    count = lines.finite(lines.word())
    if joint.channels or count not in range(7):
        raise lines.error(f"CHANNELS {count:g} of {joint.name}: once per joint, 0 to 6 of them")
    for k in range(int(count)):
        word = lines.word().lower()
        kind, axis = word[1:], _AXIS.get(word[:1])
        if axis is None or kind not in ("position", "rotation"):
            raise lines.error(f"{word[:40]!r} is no channel: Xposition … Zrotation are")
        joint.channels.append((kind, axis, column + k))
    return column + int(count)


def _hierarchy(joints: list[_Joint], columns: int) -> Hierarchy:
    def by_joint(kind: str) -> ByJoint:
        return tuple(tuple((a, c) for k, a, c in joint.channels if k == kind) for joint in joints)

    return Hierarchy(
        names=tuple(joint.name for joint in joints),
        parents=tuple(joint.parent for joint in joints),
        offsets=np.array([joint.offset for joint in joints]),
        positions=by_joint("position"),
        rotations=by_joint("rotation"),
        num_channels=columns,
    )
