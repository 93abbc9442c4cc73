"""Where a head and two hands are, and a stick → the whole person: what none of them shows is
acted by the synthetic person's own rules, and said to be inferred.

Head: from its place over the feet the trunk's lean, from its height the knees, from its turn the
twist. Hands: wrists; elbows by two-bone inverse kinematics, hanging. Stick: a march in place.
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.skeleton import INDEX, NUM_JOINTS
from studio.reference import gait
from studio.reference.tasks_walk import MAX_TURN
from studio.synthetic import signals as sig
from studio.synthetic.acting import act
from studio.synthetic.body import Body
from studio.synthetic.forward_kinematics import joints
from studio.synthetic.habits import Habits
from studio.synthetic.person import Person

Array = NDArray[np.float64]

INFERRED = 0.5
"""Confidence of what is guessed: as of a Kinect's joint that is "inferred", over `SEEN`."""
EYES = np.array([-0.08, 0.0, -0.03])
"""m, the middle between the ears as seen from that between the eyes, in the head's own axes."""
TALLEST, SHORTEST = 2.2, 0.6
"""m, of a head's height: who sits on a chair stands as tall as that."""

_BODY = Body()
_PERSON = Person(
    body=_BODY,
    # Angles as they are, and no lean that only balance would ask for: the head says how far.
    habits=replace(
        Habits(),
        gain=np.ones(4),
        slouch=0.0,
        crouch_lean=0.0,
        head_share=0.0,
        turn_yaw=3.2,
        turn_lean=0.6,
    ),
)
_TRUNK = _BODY.trunk + _BODY.neck + _BODY.head  # m, pelvis to head
_AHEAD, _ASIDE = _TRUNK - _PERSON.habits.hips_back, _TRUNK - 0.5 * _PERSON.habits.hips_back
_LEG = _BODY.thigh + _BODY.shin
_DEEPEST = 1.9  # rad of the knees
_PITCH, _ROLL = (-0.45, 1.05), (-0.6, 0.6)
_NOD, _GLANCE = math.radians(10.0), math.radians(15.0)  # a head turns so far by itself
_SHARE = 0.5, 0.9  # of what is beyond, that is the trunk's: nod, glance
_TURNED = math.radians(70.0)  # beyond, the feet have turned, too
_SLOW, _STEPPED, _TURNS, _TALLER = 30.0, 1.0, 8.0, 0.5  # s
_REST = 0.15  # of the stick's way
_STARTS, _ENDS = 0.25, 0.15  # s, of a march
_SPEED = 0.75  # m/s, the stick all the way
_LEGS = [INDEX[f"{s}_{j}"] for s in "lr" for j in ("hip", "knee", "ankle", "toe")]


@dataclass(frozen=True, kw_only=True)
class Worn:
    """What is tracked at `t` s: m and wxyz, z up, forward x.

    head_pos (3,) between the eyes, head_quat (4,). wrists: left and right (3,), None where it is
    not tracked. stick: (2,) in [-1, 1], forward and to the left. body: joints (19, 3) and
    confidence (19,), where the browser tracks more of it.
    """

    t: float
    head_pos: Array
    head_quat: Array
    wrists: tuple[Array | None, Array | None] = (None, None)
    stick: Array = field(default_factory=lambda: np.zeros(2))
    body: tuple[Array, Array] | None = None


UPRIGHT = Worn(t=0.0, head_pos=np.array([0.0, 0.0, 1.6]), head_quat=np.array([1.0, 0, 0, 0]))
"""Somebody who stands quietly, with nothing in the hands."""


class HeadsetPerson:
    """Remembers how tall the person is, where they stand and face, and the march. One thread."""

    def __init__(self) -> None:
        self._standing = float(_acted(np.zeros(sig.NUM), 0.0)[INDEX["head"], 2])
        self.reset()

    def reset(self) -> None:
        """Somebody else, who stands upright in the next frame and faces ahead."""
        self._t: float | None = None
        self._walk = self._phase = self._cadence = self._lift = self._turn = 0.0

    def see(self, worn: Worn) -> tuple[Array, Array]:
        """Joints (19, 3) m, the feet around the origin, facing x, and confidence (19,)."""
        roll, pitch, yaw = geometry.quat_to_rpy(worn.head_quat).tolist()
        head = worn.head_pos + geometry.quat_rotate(worn.head_quat, EYES)
        if self._t is None:
            self._t, self._home, self._heading = worn.t, head[:2].copy(), yaw
            self._top = min(max(float(head[2]), SHORTEST), TALLEST)
        dt = min(max(worn.t - self._t, 0.0), 0.1)
        self._t = worn.t
        self._march(worn.stick, dt)
        scale = self._top / self._standing
        here = self._from_home(head) / scale
        down = (self._top - float(head[2])) / scale
        lean = math.asin(_clip(here[0] / _AHEAD, -0.45, 0.85))
        side = math.asin(_clip(-here[1] / _ASIDE, -0.55, 0.55))
        bowed = _TRUNK * (1.0 - math.cos(lean) * math.cos(side))
        glance = geometry.wrap_angle(yaw - self._heading).item()

        bent = 2.0 * math.acos(_clip(1.0 - (down - bowed) / _LEG, math.cos(0.5 * _DEEPEST), 1.0))
        rest, crouched = _PERSON.habits.knee_rest, _PERSON.habits.crouch_knee
        row = np.zeros(sig.NUM)
        still = 1.0 - self._walk
        row[sig.CROUCH] = max(bent - rest, 0.0) / (crouched - rest)
        row[sig.TILT] = (
            still * _clip(side + _SHARE[0] * _beyond(roll, _NOD), *_ROLL),
            still * _clip(lean + _SHARE[0] * _beyond(pitch, _NOD), *_PITCH),
            still * _SHARE[1] * _beyond(glance, _GLANCE),
        )
        row[[sig.CADENCE, sig.LIFT, sig.WALK]] = self._cadence, self._lift, self._walk
        row[[sig.PHASE, sig.TURN]] = self._phase, self._turn
        self._learn(head, yaw, down, bowed, dt)
        out = scale * _acted(row, self._walk)
        confidence = np.full(NUM_JOINTS, INFERRED)
        if worn.body is not None:
            return self._with_body(out, *worn.body)
        confidence[INDEX["head"]] = 1.0
        for side_name, wrist in zip("lr", worn.wrists):
            rows = [INDEX[f"{side_name}_{j}"] for j in ("shoulder", "elbow", "wrist")]
            if wrist is None:
                confidence[rows[1:]] = 0.0
                continue
            arm = self._from_home(wrist) - self._from_home(head)
            # The stick turns the trunk that is acted, and with it the hands.
            arm[:2] = geometry.turn_xy(arm[:2], self._walk * _PERSON.habits.turn_yaw * self._turn)
            goal = out[INDEX["head"]] + arm
            outward = 1.0 if side_name == "l" else -1.0
            upper, fore = scale * _BODY.upper_arm, scale * _BODY.forearm
            out[rows[1]], out[rows[2]] = arm_to(out[rows[0]], goal, outward, upper, fore)
            confidence[rows[2]] = 1.0
        return out, confidence

    def _with_body(self, acted: Array, joint_pos: Array, sure: Array) -> tuple[Array, Array]:
        """What the browser tracks besides. No headset sees legs: where it gives some, they are
        inferred, too; where it gives none, or the stick is pushed, they are acted."""
        out, confidence = self._from_home(joint_pos), sure.copy()
        moved = acted[_LEGS] - acted[INDEX["pelvis"]] + out[INDEX["pelvis"]]
        if self._walk > 0.0 or confidence[_LEGS].min() == 0.0:
            out[_LEGS] = moved
        confidence[_LEGS] = INFERRED
        return out, confidence

    def _from_home(self, point: Array) -> Array:
        """Points (..., 3) m in the person's own frame: the middle of the feet, facing x."""
        out = np.array(point, dtype=np.float64)
        out[..., :2] = geometry.turn_xy(out[..., :2] - self._home, -self._heading)
        return out

    def _learn(self, head: Array, yaw: float, down: float, bowed: float, dt: float) -> None:
        """Where they stand, which way, how tall: slowly, but for what cannot be a lean."""
        # Who leans that far comes down by it; who does not has made a step.
        stepped = bowed > 0.01 and down < 0.5 * bowed
        self._home += (head[:2] - self._home) * min(1.0, dt / (_STEPPED if stepped else _SLOW))
        off = geometry.wrap_angle(yaw - self._heading).item()
        self._heading += off * min(1.0, dt / _TURNS) * (1.0 - self._walk) + _beyond(off, _TURNED)
        # Up with who straightens, not with who hops; down only with who seems to slump.
        higher = float(head[2]) - self._top
        tau = _TALLER if higher > 0.0 else _SLOW if down < 0.05 else math.inf
        self._top = _clip(self._top + higher * min(1.0, dt / tau), SHORTEST, TALLEST)

    def _march(self, stick: Array, dt: float) -> None:
        """The stick at rest is standing: the foot in the air comes down, and that is all."""
        forward, left = _beyond(float(stick[0]), _REST), _beyond(float(stick[1]), _REST)
        forward, left = max(forward, 0.0) / (1.0 - _REST), left / (1.0 - _REST)
        pushed = forward > 0.0 or left != 0.0
        step = dt / _STARTS if pushed else -dt / _ENDS
        self._walk = _clip(self._walk + step, 0.0, 1.0)
        if pushed:
            self._cadence = 0.9 + forward
            self._turn = MAX_TURN * left
            lift = float(gait.march_lift(self._cadence, _SPEED * forward))
            self._lift = _clip(lift, 0.15, 0.9)
        elif self._walk == 0.0:
            self._phase = self._cadence = self._lift = self._turn = 0.0
        self._phase += self._cadence * dt


def _acted(row: Array, walk: float) -> Array:
    """(19, 3) m of one row of a signal, as someone of `_BODY` acts it who does nothing else."""
    one, none = np.full(1, walk), np.zeros(1)
    posture, _ = act(
        _PERSON, row[None], row[None, sig.CADENCE], one, one, none,
        np.zeros((1, 8)), np.zeros((1, 2, 4)), none, np.zeros((1, 2, 4)), np.zeros((1, 2)),
    )  # fmt: skip
    return joints(_BODY, posture)[0]


def arm_to(
    shoulder: Array, goal: Array, outward: float, upper: float, fore: float
) -> tuple[Array, Array]:
    """Elbow and wrist (3,) of an arm of these lengths (m) that reaches for a goal (3,).

    The elbow hangs, a little outwards (1 left, -1 right) and back; who cannot reach is straight.
    """
    way = goal - shoulder
    far = float(np.linalg.norm(way))
    span = _clip(far, abs(upper - fore) + 0.02, 0.999 * (upper + fore))
    way = way / far if far > 1e-6 else np.array([0.0, 0.0, -1.0])
    hangs = np.array([-0.3, 0.35 * outward, -1.0])
    aside = geometry.normalize(hangs - (hangs @ way) * way)
    along = (upper**2 - fore**2 + span**2) / (2.0 * span)
    off = math.sqrt(max(upper**2 - along**2, 0.0))
    return shoulder + along * way + off * aside, shoulder + span * way


def _clip(x: float, least: float, most: float) -> float:
    return min(max(x, least), most)


def _beyond(x: float, dead: float) -> float:
    """What of x lies beyond a dead zone."""
    return math.copysign(max(abs(x) - dead, 0.0), x)
