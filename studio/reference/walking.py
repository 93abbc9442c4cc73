"""Walking intents to poses: a causal planner that sways the trunk and puts feet down for good.

What it remembers is where the robot is: its path, and where each standing foot stands. So standing
feet never slide, whatever the intent does; everything else follows from phase, cadence, speed,
turn and lift of the moment. One step costs some tens of microseconds.
"""

import math

import numpy as np
from numpy.typing import NDArray

from studio.geometry import scalars
from studio.geometry.time_scaling import smoothstep
from studio.reference import gait, stances
from studio.reference.intent import Intent
from studio.robot import a1

Array = NDArray[np.float64]

TILT_LIMIT = math.radians(10.0)
"""rad: roll and pitch a walking trunk takes from the intent; its yaw is the path's."""
_CROUCH_SHORTER = 0.15  # share by which steps shorten in a full crouch: bent legs pass closer
_FEET = [tuple(p) for p in stances.NEUTRAL_FEET["walk"][:, :2].tolist()]


class Walker:
    """Plans trunk and feet, one control period at a time. One thread at a time may use it."""

    def __init__(self) -> None:
        self.reset()

    def reset(self, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> None:
        """Stand at (x, y) m with this heading, all feet down at their neutral places."""
        self._x, self._y, self._yaw = x, y, yaw
        self._phase: float | None = None
        self._tempo = self._turn = 0.0
        self._way = (0.0, 0.0)
        self._anchor = [_ahead(x, y, yaw, foot) for foot in _FEET]
        self._foot = [(*p, 0.0) for p in self._anchor]
        self._swinging = [False] * 4

    def step(self, intent: Intent) -> tuple[Array, Array, Array]:
        """Base position (3,), roll-pitch-yaw (3,) and foot centres (4, 3), world, of one period."""
        cadence = min(max(intent.cadence, 0.0), 3.0)
        advance = self._advance(intent.phase)
        self._tempo = self._next_tempo(intent.phase, float(gait.tempo(cadence)), advance)
        duty = float(gait.duty(self._tempo))
        per_stride, turn = self._stride(intent, cadence, advance)
        self._x, self._y, self._yaw = _arc(self._x, self._y, self._yaw, per_stride, turn, advance)
        aside = gait.STAGGER * min(abs(per_stride[0]) * duty / gait.MAX_TRAVEL, 1.0)
        clear = float(gait.clearance(intent.lift, cadence))
        for leg, offset in enumerate(gait.leg_offsets(self._tempo).tolist()):
            phase = (intent.phase - offset) % 1.0
            # The foot lands where it stands straight under the body half way through its stance.
            left = 1.0 - 0.5 * duty - phase
            there = _arc(self._x, self._y, self._yaw, per_stride, turn, left)
            x, y = _FEET[leg]
            landing = _ahead(*there, (x, y * (1.0 + math.copysign(aside, -x))))
            if phase < 1.0 - duty:
                self._swing(leg, phase / (1.0 - duty), landing, clear)
            elif self._swinging[leg]:
                # Swung through: down at the landing. Gone back (in a pause): down where it is.
                x, y, z = self._foot[leg]
                self._put_down(leg, landing if left > 0.0 and z > 1e-6 else (x, y))
        return self._pose(intent, cadence)

    def _advance(self, phase: float) -> float:
        """Strides since the last step; a phase that runs back or leaps moves nothing."""
        last, self._phase = self._phase, phase
        gone = 0.0 if last is None else phase - last
        return gone if 0.0 <= gone <= 0.5 else 0.0

    def _next_tempo(self, phase: float, wanted: float, advance: float) -> float:
        """Crawl or trot: at once while all feet stand, else slowly, so that no foot turns back."""
        if wanted == self._tempo:
            return wanted
        if not (_any_swings(phase, self._tempo) or _any_swings(phase, wanted)):
            return wanted
        most = max(advance, 0.03)
        return _towards(self._tempo, wanted, most)

    def _stride(
        self, intent: Intent, cadence: float, advance: float
    ) -> tuple[tuple[float, float], float]:
        """Way (m, forward and left) and turn (rad) of a stride, within what the legs can do and
        the last stride."""
        rate = max(cadence, 0.05)
        most = float(gait.max_yaw_per_stride(self._tempo))
        turn = min(max(intent.turn / rate, -most), most)
        crouch = min(max(intent.crouch, 0.0), 1.0)
        duty = float(gait.duty(self._tempo))
        longest = float(gait.max_travel(cadence)) * (1.0 - _CROUCH_SHORTER * crouch) / duty
        ahead = max(longest - gait.HALF_WIDTH * abs(turn), 0.0)
        forward, left = gait.within_reach(
            intent.speed / rate, intent.side / rate, ahead, gait.MAX_SIDESTEP / duty
        )
        gone = max(advance, 0.02)
        self._way = (
            _towards(self._way[0], forward, gait.WAY_GAIN * gone),
            _towards(self._way[1], left, gait.WAY_GAIN * gone),
        )
        self._turn = _towards(self._turn, turn, gait.TURN_GAIN * gone)
        return self._way, self._turn

    def _swing(self, leg: int, done: float, landing: tuple[float, float], clear: float) -> None:
        """Move the foot a share `done` in [0, 1) of the way from where it stood to `landing`."""
        (x, y), (to_x, to_y) = self._anchor[leg], landing
        way = math.hypot(to_x - x, to_y - y)
        if clear < 1e-4 and way < 0.005:
            self._put_down(leg, (x, y))
            return
        self._swinging[leg] = True
        s = float(gait.swing_profile(done))
        # Even without lift a foot that must move is lifted, never dragged.
        z = max(clear, min(gait.MIN_CLEARANCE, 0.6 * way)) * float(gait.swing_height(done))
        self._foot[leg] = (x + s * (to_x - x), y + s * (to_y - y), z)

    def _put_down(self, leg: int, place: tuple[float, float]) -> None:
        self._swinging[leg] = False
        self._anchor[leg] = (place[0], place[1])
        self._foot[leg] = (place[0], place[1], 0.0)

    def _pose(self, intent: Intent, cadence: float) -> tuple[Array, Array, Array]:
        active = float(smoothstep(intent.lift / 0.3))
        along, side = (active * gait.sway(intent.phase, cadence, self._tempo)).tolist()
        x, y = _ahead(self._x, self._y, self._yaw, (along, side))
        crouch = min(max(intent.crouch, 0.0), 1.0)
        base = np.array([x, y, a1.STAND_HEIGHT - gait.WALKING_CROUCH * crouch])
        roll, pitch = np.clip(intent.tilt[:2], -TILT_LIMIT, TILT_LIMIT).tolist()
        feet = np.array(self._foot)
        feet[:, 2] += a1.FOOT_RADIUS
        return base, np.array([roll, pitch, self._yaw]), feet


def _towards(value: float, goal: float, most: float) -> float:
    return value + min(max(goal - value, -most), most)


def _any_swings(phase: float, tempo: float) -> bool:
    swing = 1.0 - float(gait.duty(tempo))
    return any((phase - offset) % 1.0 < swing for offset in gait.leg_offsets(tempo).tolist())


def _arc(
    x: float, y: float, yaw: float, way: tuple[float, float], turn: float, share: float
) -> tuple[float, float, float]:
    """The pose after a share of a stride of `way` (m, forward and left) and `turn` (rad)."""
    dx, dy = scalars.turn_xy(way[0] * share, way[1] * share, yaw + 0.5 * turn * share)
    return x + dx, y + dy, yaw + turn * share


def _ahead(x: float, y: float, yaw: float, p: tuple[float, float]) -> tuple[float, float]:
    """The world's point of `p` in the frame at (x, y) with heading yaw."""
    dx, dy = scalars.turn_xy(*p, yaw)
    return x + dx, y + dy
