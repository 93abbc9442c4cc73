"""The robot's end of a link: datagrams in, checked and counted; states out; its body in between."""

from collections import Counter
from dataclasses import replace
from secrets import randbits

from studio import geometry
from studio.errors import StudioError
from studio.link import wire
from studio.link.engine import LYING, Engine
from studio.link.guards import unfit_to_rise
from studio.link.robot_side import Heard, RobotSide
from studio.link.wire import Echo, Head, Refused, Report
from studio.robot.pose import RobotPose

Address = tuple[str, int]
MAX_AGE = 1.0
"""s that the state which an order answers may be old: way there, way back, and waiting."""
FREE_AFTER = 1.0
"""s of silence after which somebody else may drive."""
GREETS_EVERY = 0.02
"""s between two answers to those who do not drive."""


class RobotServer:
    """One robot and who drives it. One thread; `now`: s on any clock that only goes on.

    counts: datagrams by what became of them, "heard" or the word of a refusal.
    """

    def __init__(self, engine: Engine, side: RobotSide, secret: bytes = b"") -> None:
        self.engine, self.side = engine, side
        self.counts: Counter[str] = Counter()
        self._secret, self._boot = secret, randbits(64)
        self._began: float | None = None
        self._driver: tuple[int, Address] | None = None
        self._sequence = -1
        self._heard_at, self._greeted_at = 0.0, float("-inf")
        self._sent = 0

    def hear(self, datagram: bytes, address: Address, now: float) -> bytes | None:
        """One datagram from outside; what to answer it with, if anything. Never fails."""
        try:
            head, body = wire.opened(datagram, self._secret)
            if head.kind == wire.HELLO:
                return self._greet(head, now)
            echo, heard = wire.read_order(head, body)
            if heard.stop and not (self._drives(head) and head.sequence <= self._sequence):
                self.side.stop("asked to")  # anybody may, however late
            self._check(head, echo, now)
        except Refused as refusal:
            self.counts[refusal.why] += 1
            return None
        if not self._drives(head):
            self.side.new_driver()
        self._driver, self._sequence = (head.session, address), head.sequence
        self._heard_at = now
        self._lift(heard)
        self.side.hear(heard, now)
        self.counts["heard"] += 1
        return None

    def step(self, now: float) -> tuple[bytes, Address] | None:
        """One step of the body; its state, for whoever drives."""
        command = self.side.step(self.engine.state(), now)
        try:
            self.engine.step(command)
        except StudioError:
            self.side.stop("not finite")
            self.engine.place(self._crouch())
        if self._driver is None or now - self._heard_at > FREE_AFTER:
            return None
        session, address = self._driver
        return self._state(session, now), address

    def _greet(self, head: Head, now: float) -> bytes | None:
        """A state, but no flood of them: whoever asks may have lied about where it is."""
        if now - self._greeted_at < GREETS_EVERY:
            return None
        self._greeted_at = now
        self.counts["hello"] += 1
        return self._state(head.session, now)

    def _drives(self, head: Head) -> bool:
        return self._driver is not None and self._driver[0] == head.session

    def _check(self, head: Head, echo: Echo, now: float) -> None:
        if not self._drives(head) and self._driver and now - self._heard_at <= FREE_AFTER:
            raise Refused("driver")
        if self._drives(head) and head.sequence <= self._sequence:
            raise Refused("old")
        if echo.boot != self._boot or not -1e-6 <= self._time(now) - echo.t <= MAX_AGE:
            raise Refused("late")

    def _time(self, now: float) -> float:
        self._began = now if self._began is None else self._began
        return now - self._began

    def _state(self, session: int, now: float) -> bytes:
        self._sent += 1
        robot, side = self.engine.state(), self.side
        flags = wire.TRUNK_CONTACT * robot.trunk_contact
        flags |= wire.SELF_COLLISION * robot.self_collision
        head = Head(kind=wire.STATE, session=session, sequence=self._sent & 0xFFFFFFFF, flags=flags)
        report = Report(
            boot=self._boot,
            t=self._time(now),
            phase=side.phase,
            why=side.why,
            target=side.target,
            robot=robot,
        )
        return wire.state(head, report, self._secret)

    def _lift(self, heard: Heard) -> None:
        """A simulated robot on its side is set onto its belly when it is asked to rise."""
        if self.side.asks_to_rise(heard) and unfit_to_rise(self.engine.state()) == "tilt":
            self.engine.place(self._crouch())

    def _crouch(self) -> RobotPose:
        robot = self.engine.state()
        quat = geometry.quat_from_yaw(robot.yaw)
        return replace(LYING, base_pos=robot.base_pos, base_quat=quat)
