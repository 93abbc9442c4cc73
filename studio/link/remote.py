"""The studio's end of a link to a robot that is not in this process's hands: by datagrams."""

from abc import abstractmethod
from dataclasses import replace
from secrets import randbits

from studio.control.drive_command import Directive, DriveCommand
from studio.link import wire
from studio.link.link import Level, Order, RobotLink, Told
from studio.link.robot_side import STILL_WITHIN
from studio.link.wire import Echo, Head, Refused, Report
from studio.robot.pose import RobotPose, RobotState

SILENT = 0.3
"""s without a state from which the robot counts as lost."""
RISES_WITHIN = STILL_WITHIN + 1.0
"""s that a robot which was asked to rise may stay limp before that counts as a stop of its own."""


class RemoteLink(RobotLink):
    """Remembers the newest state, and what it has asked for. One thread.

    refused: datagrams that were not believed.
    """

    def __init__(self, name: str, level: Level, secret: bytes = b"") -> None:
        self.name, self.level = name, level
        self.refused = 0
        self._secret, self._session = secret, randbits(64)
        self._sequence = self._rises = 0
        self._report: Report | None = None
        self._seen_at = self._asked_at = float("-inf")
        self._state_sequence = -1

    # What a way to carry datagrams has -----------------------------------------------------------

    @abstractmethod
    def _send(self, datagram: bytes) -> None:
        """Give it to the line; never waits."""

    @abstractmethod
    def _receive(self) -> list[bytes]:
        """What has arrived since."""

    @abstractmethod
    def _now(self) -> float:
        """s."""

    # The robot --------------------------------------------------------------------------------

    def sense(self) -> RobotState:
        """The newest state that arrived; `_report` must be there (`open` waits for it)."""
        for datagram in self._receive():
            self._see(datagram)
        assert self._report is not None
        return self._report.robot

    def exchange(self, order: Order) -> RobotState:
        """Send the order; the newest state that arrived."""
        robot = self.sense()
        report = self._report
        assert report is not None
        asked = order.asked
        flags = wire.STOP * order.damping
        flags |= wire.IN_TRANSITION * (asked is not None and asked.in_transition)
        kind = wire.TARGETS if self.level == "targets" else wire.REFERENCES
        echo = Echo(boot=report.boot, t=report.t)
        head = self._head(kind, flags)
        self._send(wire.order(head, echo, self._rises, order, self.level, self._secret))
        if self.silent:  # started anew, it knows nothing of us
            self._hello()
        self.target = order.target if self.level == "targets" else report.target
        return robot

    def place(self, pose: RobotPose) -> RobotState:
        """Nobody can: it stays as it is."""
        return self.sense()

    def rise(self) -> None:
        """Ask it to, from the next order on."""
        self._rises += 1
        self._asked_at = self._now()

    def advise(self, command: DriveCommand) -> DriveCommand:
        """To stand, while the robot is not there to follow; a stop's reason stays."""
        self.sense()
        if self.ready:
            return command
        reason, why = command.reason or "robot", command.why or f"robot: {self._why()}"
        return replace(command, directive=Directive.STAND, reason=reason, why=why)

    @property
    def ready(self) -> bool:
        """Its newest state is new, and says that it follows."""
        report = self._report
        return report is not None and not self.silent and report.phase in ("following", "holding")

    @property
    def silent(self) -> bool:
        """Nothing has been heard of it."""
        return self._now() - self._seen_at > SILENT

    @property
    def stopped(self) -> str:
        """Why it is limp, though it was asked to rise; "" while the line is silent."""
        report = self._report
        if report is None or report.phase != "limp" or self.silent:
            return ""
        if self._now() - self._asked_at < RISES_WITHIN:
            return ""
        return f"the robot is limp ({report.why})"

    @property
    def told(self) -> Told | None:
        """None before its first state."""
        report = self._report
        if report is None:
            return None
        heard_s = self._now() - self._seen_at
        return Told(phase=report.phase, why=report.why, heard_s=heard_s, refused=self.refused)

    def _why(self) -> str:
        report = self._report
        if report is None or self.silent:
            return f"{self.name} is silent"
        return f"{self.name} is {report.phase}" + (f" ({report.why})" if report.why else "")

    def _hello(self) -> None:
        self._send(self._greeting())

    def _greeting(self) -> bytes:
        return wire.hello(self._head(wire.HELLO), self._secret)

    def _head(self, kind: int, flags: int = 0) -> Head:
        self._sequence += 1
        return Head(kind=kind, session=self._session, sequence=self._sequence, flags=flags)

    def _see(self, datagram: bytes) -> None:
        try:
            head, body = wire.opened(datagram, self._secret)
            report = wire.read_state(head, body)
            if head.session != self._session:
                raise Refused("driver")
            known = self._report
            if known is not None and known.boot == report.boot:
                if head.sequence <= self._state_sequence:
                    raise Refused("old")
            elif known is not None:
                self._rises = 0  # what was asked of it before it was started anew is void
        except Refused:
            self.refused += 1
            return
        self._report, self._state_sequence = report, head.sequence
        self._seen_at = self._now()
