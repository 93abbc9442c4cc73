"""The datagrams of a link: orders in, states out; hostile until checked (docs/robot-link.md).

Little-endian, of one size a kind:

    magic "A1RL" | version u8 | kind u8 | flags u16 | session u64 | sequence u32 | body | tag 16 B

`session` is drawn anew by each who drives, `sequence` rises by one. The tag, with a shared secret
only, is HMAC-SHA256 of all before it, cut to 16 bytes.
"""

import hmac
import struct
from dataclasses import dataclass
from hashlib import sha256
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from studio.link.guards import Why
from studio.link.link import Level, Order
from studio.link.robot_side import PHASES, Heard, Phase
from studio.reference.intent import STATES
from studio.robot import a1, kinematics
from studio.robot.pose import ReferencePose, RobotState

Array = NDArray[np.float64]
MAGIC, VERSION = b"A1RL", 1
HELLO, TARGETS, REFERENCES, STATE = 1, 2, 3, 4
STOP, IN_TRANSITION = 1, 2
TRUNK_CONTACT, SELF_COLLISION = 1, 2
"""Flags: of orders, and of states."""
Refusal = Literal[
    "size", "magic", "version", "kind", "tag", "number", "range", "old", "late", "driver"
]
"""Why a datagram is not believed, in the order of the checks. old: a later one came before it.
late: it answers a state that is too old. driver: somebody else drives."""
WHYS: tuple[Why, ...] = get_args(Why)

_HEAD = struct.Struct("<4sBBHQI")
_ECHO = struct.Struct("<QdIB3x")  # boot, t of the newest state, rise, expert
_REPORT = struct.Struct("<QdBB6x")  # boot, t, phase, why
_POSE = (("base_pos", 3), ("base_quat", 4), ("joint_pos", 12), ("foot_contact", 4),
         ("base_lin_vel_w", 3), ("base_ang_vel_b", 3), ("joint_vel", 12))  # fmt: skip
_POSE_SIZE = 8 * sum(size for _, size in _POSE)
SIZES = {
    HELLO: _HEAD.size,
    TARGETS: _HEAD.size + _ECHO.size + 8 * 14,
    REFERENCES: _HEAD.size + _ECHO.size + _POSE_SIZE,
    STATE: _HEAD.size + _REPORT.size + _POSE_SIZE + 8 * 25,
}
TAG_SIZE = 16
LARGEST = max(SIZES.values()) + TAG_SIZE


class Refused(Exception):
    """A datagram that is not believed; `why` says which check it failed."""

    def __init__(self, why: Refusal) -> None:
        super().__init__(why)
        self.why: Refusal = why


@dataclass(frozen=True, kw_only=True)
class Head:
    """Of any datagram."""

    kind: int
    session: int
    sequence: int
    flags: int = 0


@dataclass(frozen=True, kw_only=True)
class Echo:
    """Which state an order answers: of the robot's process `boot`, at its time t s."""

    boot: int = 0
    t: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Report:
    """A state as it arrived. t: s since the robot's process `boot` began. target: (12,) rad, what
    the motors are held to."""

    boot: int
    t: float
    phase: Phase
    why: Why
    target: Array
    robot: RobotState


def hello(head: Head, secret: bytes) -> bytes:
    """Asks for one state."""
    return _sealed(head, b"", secret)


def order(head: Head, echo: Echo, rise: int, given: Order, level: Level, secret: bytes) -> bytes:
    """One period's order at this level."""
    asked = given.asked
    expert = STATES.index(asked.state) if asked is not None else 0
    body = _ECHO.pack(echo.boot, echo.t, rise, expert)
    if level == "targets":
        body += np.append(given.target, [given.kp, given.kd]).astype("<f8").tobytes()
    else:
        assert asked is not None
        body += _pose_bytes(asked.reference)
    return _sealed(head, body, secret)


def state(head: Head, report: Report, secret: bytes) -> bytes:
    """What the robot says of itself."""
    body = _REPORT.pack(report.boot, report.t, PHASES.index(report.phase), WHYS.index(report.why))
    more = np.concatenate([report.robot.torque, report.target, [report.robot.t]])
    return _sealed(head, body + _pose_bytes(report.robot) + more.astype("<f8").tobytes(), secret)


def opened(datagram: bytes, secret: bytes) -> tuple[Head, bytes]:
    """Head and body, the tag verified. Refused for anything else."""
    tag_size = TAG_SIZE if secret else 0
    if not _HEAD.size + tag_size <= len(datagram) <= LARGEST:
        raise Refused("size")
    magic, version, kind, flags, session, sequence = _HEAD.unpack_from(datagram)
    if magic != MAGIC:
        raise Refused("magic")
    if version != VERSION:
        raise Refused("version")
    if kind not in SIZES:
        raise Refused("kind")
    if len(datagram) != SIZES[kind] + tag_size:
        raise Refused("size")
    end = SIZES[kind]
    if secret and not hmac.compare_digest(_tag(datagram[:end], secret), datagram[end:]):
        raise Refused("tag")
    head = Head(kind=kind, session=session, sequence=sequence, flags=flags)
    return head, datagram[_HEAD.size : end]


def read_order(head: Head, body: bytes) -> tuple[Echo, Heard]:
    """Of a TARGETS or REFERENCES datagram. Refused for what is no order."""
    if head.kind not in (TARGETS, REFERENCES):
        raise Refused("kind")
    boot, t, rise, expert = _ECHO.unpack_from(body)
    values = _numbers(body[_ECHO.size :])
    if not np.isfinite(t):
        raise Refused("number")
    if expert >= len(STATES):
        raise Refused("range")
    common = {"rise": rise, "stop": bool(head.flags & STOP)}
    if head.kind == TARGETS:
        kp, kd = values[12:].tolist()
        heard = Heard(level="targets", target=values[:12], kp=kp, kd=kd, **common)
    else:
        heard = Heard(
            level="references",
            target=a1.STAND_JOINT_POS,
            reference=ReferencePose(**_pose(values)),
            state=STATES[expert],
            in_transition=bool(head.flags & IN_TRANSITION),
            **common,
        )
    return Echo(boot=boot, t=t), heard


def read_state(head: Head, body: bytes) -> Report:
    """Of a STATE datagram. Refused for what is none."""
    if head.kind != STATE:
        raise Refused("kind")
    boot, t, phase, why = _REPORT.unpack_from(body)
    values = _numbers(body[_REPORT.size :])
    if not np.isfinite(t):
        raise Refused("number")
    if phase >= len(PHASES) or why >= len(WHYS):
        raise Refused("range")
    pose, rest = _pose(values), values[_POSE_SIZE // 8 :]
    robot = RobotState(
        **pose,
        t=float(rest[24]),
        foot_pos_w=kinematics.foot_pos_w(pose["base_pos"], pose["base_quat"], pose["joint_pos"]),
        torque=rest[:12],
        trunk_contact=bool(head.flags & TRUNK_CONTACT),
        self_collision=bool(head.flags & SELF_COLLISION),
    )
    return Report(
        boot=boot, t=t, phase=PHASES[phase], why=WHYS[why], target=rest[12:24], robot=robot
    )


def _sealed(head: Head, body: bytes, secret: bytes) -> bytes:
    out = _HEAD.pack(MAGIC, VERSION, head.kind, head.flags, head.session, head.sequence) + body
    return out + _tag(out, secret) if secret else out


def _tag(data: bytes, secret: bytes) -> bytes:
    return hmac.digest(secret, data, sha256)[:TAG_SIZE]


def _pose_bytes(pose: ReferencePose | RobotState) -> bytes:
    return np.concatenate([getattr(pose, name) for name, _ in _POSE]).astype("<f8").tobytes()


def _numbers(data: bytes) -> Array:
    values = np.frombuffer(data, dtype="<f8").astype(np.float64)
    if not np.isfinite(values).all():
        raise Refused("number")
    if np.abs(values).max() > 1e6:
        raise Refused("range")
    return values


def _pose(values: Array) -> dict[str, Array]:
    """Fields of a pose from the first numbers. Refused where its quaternion is no rotation."""
    out, at = {}, 0
    for name, size in _POSE:
        out[name], at = values[at : at + size], at + size
    length = float(np.linalg.norm(out["base_quat"]))
    if abs(length - 1.0) > 1e-3:
        raise Refused("range")
    return out
