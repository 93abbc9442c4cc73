"""The source as the robot follows it: after a jump in its timeline, from a stand."""

from studio.control.drive_command import Reason
from studio.human.pose import HumanPose
from studio.live.safety import Safety
from studio.live.source_reader import SourceReader
from studio.puppeteer import Puppeteer
from studio.robot.a1 import CONTROL_DT


class SeekGuard:
    """Remembers whether a robot that walked comes to a stand, for which the person waits: who
    goes on in another phase of their stride fells it. Only the loop's thread calls it."""

    def __init__(self, reader: SourceReader, puppeteer: Puppeteer, safety: Safety) -> None:
        self._reader, self._puppeteer, self._safety = reader, puppeteer, safety
        self.halting = False

    @property
    def keep(self) -> tuple[Reason, str]:
        """Why the robot walks nowhere just now, or two ""."""
        line = self._reader.timeline
        if self._reader.paused:
            return "paused", "paused: play to go on"
        if self.halting:
            return "paused", "it goes on elsewhere: the robot stands first"
        if line is not None and line.runs and line.speed > 1.0:
            # At twice the speed 4 of 5 walkers fell within a minute.
            why = f"hurried: played at {line.speed:g} times its speed, the robot does not walk"
            return "hurried", why
        return "", ""

    def read(self, now: float, *, recording: bool) -> HumanPose | None:
        """What is new of the person at `now`, s on the loop's clock.

        recording: a take is; its person begins nothing anew by themselves.
        """
        machine, reader = self._puppeteer.state_machine, self._reader
        self.halting = self.halting and (machine.state == "walk" or machine.busy)
        asked = reader.jumped()
        self.halting |= asked and machine.state == "walk"
        human = reader.read(now, held=self._safety.stopped, waits=self.halting, loops=not recording)
        if reader.jumped() or asked:
            self.halting |= machine.state == "walk"
            self._look_back()
        return human

    def _look_back(self) -> None:
        """Forget what was seen, and see what they did just before: what they do is known at once,
        by its velocities, too."""
        self._puppeteer.forget_person()
        self._safety.forget_person()
        for pose in self._reader.before():
            self._puppeteer.retargeter.step(pose, CONTROL_DT, watch=True)
