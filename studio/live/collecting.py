"""Collect mode in the loop: the state machine's steps become a figure shown and takes on disk."""

import logging
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from studio.errors import StudioError
from studio.human.calibration import Calibration
from studio.live import state_parts
from studio.live.collect_stages import ACTIONS, Collect, CollectPlan, Slot, Step
from studio.live.disk_writer import DiskWriter
from studio.live.shown_motion import QUIET_S, Place, PlanItem, at_rest, draw_motion
from studio.reference.intent import Intent, StateName
from studio.robot.pose import ReferencePose, RobotPose
from studio.takes.edit import edits
from studio.takes.names import take_folder
from studio.takes.record.recorder import Recorder
from studio.takes.sessions import SessionBook, session_name

log = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class Shown:
    """What a person is shown in one control period: the pose, its state, and what is meant."""

    state: StateName
    pose: ReferencePose
    intent: Intent


def draw_slots(items: tuple[PlanItem, ...], seed: int, first: int = 0) -> list[Slot]:
    """The takes of a plan, each with a motion of its own. first: takes that were drawn before.

    Takes some 0.2 s a take: never on the loop's thread.
    """
    slots = []
    for item in items:
        item.checked()
        for number in range(1, item.takes + 1):
            motion = draw_motion(item, (seed, first + len(slots)))
            slots.append(Slot(item=item, number=number, motion=motion))
    return slots


class Collector:
    """Remembers the plan, the place of the figure and the take. Only the loop's thread calls it."""

    def __init__(self, root: Path, recorder: Recorder) -> None:
        self.root, self.recorder = Path(root), recorder
        self.machine = Collect()
        self.disk = DiskWriter()
        self.take: str | None = None  # the one being recorded, or to be judged
        self.kept: list[str] = []
        self.rejected: list[str] = []
        self.why = ""
        self._place = Place()
        self._book = SessionBook(root)
        self._own = False

    # What is asked ------------------------------------------------------------------------------

    def begin(self, plan: CollectPlan, slots: list[Slot]) -> None:
        """Start on a plan. StudioError while a take is recorded."""
        self.machine.begin(plan, slots)
        self.take, self.why = None, ""

    def act(self, action: str) -> dict[str, Any]:
        """One of collect.ACTIONS; what became of which take."""
        machine = self.machine
        if action == "go":
            self.refuse_while_recording()
        judges = machine.phase == "review" and action in ("keep", "redo", "next")
        machine.act(action)
        self.why = ""
        if not judges or self.take is None:
            return {}
        return self._judge(action)

    def refuse_while_recording(self) -> None:
        """StudioError while a take is recorded."""
        if self.recorder.recording is not None:
            raise StudioError(f"take {self.recorder.recording} is being recorded: stop it first")

    def abort(self, why: str) -> None:
        """Something else needs the robot: a running take is thrown away."""
        if self.machine.phase in ("preview", "countdown", "record"):
            self.why = why
            self.machine.abort()
            if self._own:
                self._throw_away()

    def nobody_acts(self, why: str) -> None:
        """The source has ended: a running take is thrown away, and the next one waits."""
        self.abort(why)
        self.why = why
        if self.machine.phase == "ready":
            self.machine.frame = 0

    # One control period -------------------------------------------------------------------------

    def step(self, pose: RobotPose, facing: float, resting: bool) -> tuple[Shown, Step]:
        """Go on. pose, facing (rad): of the robot's reference; resting: it follows nobody, so that
        what is shown goes on from there."""
        step = self.machine.step()
        # Never while a motion runs: what is shown must not jump because the robot had to hold.
        if step.frame == 0 or (step.frame is None and resting and step.phase != "review"):
            self._place.stand_at(pose, facing)
        shown = step.motion.poses[step.frame] if step.motion and step.frame is not None else None
        if step.phase == "review" and step.motion is not None:
            shown = step.motion.poses[-1]  # until somebody decides, it stays where it ended
        at = self._place.of(shown or at_rest(step.state))
        return Shown(state=step.state, pose=at, intent=step.intent), step

    def write(self, step: Step, about: dict[str, Any], calibration: Calibration) -> None:
        """Begin or end the take as the step says."""
        if step.event == "start":
            self._start(step, about, calibration)
        elif step.event == "stop" and self._own:
            self._own = False
            if self.recorder.recording is not None:
                self.take = self.recorder.stop()["name"]
            else:  # what was recorded is kept
                self.why = self.recorder.problem or "the recording was cut short"
        elif step.event == "abort" and self._own:
            self._throw_away()
        if step.event == "" and step.phase in ("ready", "done") and self.take is not None:
            self._judge("keep")  # hands free: the review's time was over

    def _start(self, step: Step, about: dict[str, Any], calibration: Calibration) -> None:
        slot, plan = self.machine.slot, self.machine.plan
        assert slot is not None
        collected = {
            "task": slot.item.task,
            "state": slot.motion.state,
            "operator": plan.operator,
            "session": session_name(plan.operator, datetime.now().astimezone().date()),
            "number": slot.number,
            "try": slot.tries,
            "difficulty": slot.item.difficulty,
            "quiet_s": QUIET_S,
        }
        try:
            name = self.recorder.start(
                slot.item.task,
                about={**about, "collect": collected, "calibration": as_calibration(calibration)},
            )
        except StudioError as error:
            self.why = str(error)
            self.machine.abort()
            return
        self.take, self._own = name, True
        self.disk.do(
            lambda: self._book.add(
                plan.operator, name, notes=plan.notes, calibration=as_calibration(calibration)
            )
        )

    def _throw_away(self) -> None:
        self._own = False
        if self.recorder.recording is not None:
            self.take = self.recorder.stop()["name"]
            self._judge("redo", "aborted")

    def _judge(self, action: str, note: str | None = None) -> dict[str, Any]:
        name, self.take = self.take, None
        assert name is not None
        if action == "next":
            return {"take": name, "keep": None}
        keep = action == "keep"
        (self.kept if keep else self.rejected).append(name)
        changes: dict[str, Any] = {"keep": keep} | ({"note": note} if note else {})
        folder = take_folder(self.root, name)
        self.disk.do(lambda: edits.edit(folder, **changes))
        return {"take": name, "keep": keep}

    def close(self) -> None:
        """End the disk work."""
        self.disk.close()

    # For the page -------------------------------------------------------------------------------

    def as_dict(self) -> state_parts.Collect:
        """The key `collect` of GET /api/state."""
        machine = self.machine
        slot, remaining = machine.slot, machine.remaining
        out: state_parts.Collect = {
            "phase": machine.phase,
            "t": round(machine.t, 3),
            "remaining": None if remaining is None else round(remaining, 3),
            "operator": machine.plan.operator,
            "notes": machine.plan.notes,
            "hands_free": machine.plan.hands_free,
            "actions": list(ACTIONS),
            "done": sum(bool(s.verdict) for s in machine.slots),
            "total": len(machine.slots),
            "take": self.take,
            "kept": self.kept[-200:],
            "rejected": self.rejected[-200:],
            "why": self.why or self.disk.problem,
            "plan": _plan(machine.slots),
        }
        if slot is None:
            return out
        return {
            **out,
            "task": slot.item.task,
            "state": slot.motion.state,
            "number": slot.number,
            "takes": slot.item.takes,
            "try": slot.tries,
            "prompt": slot.motion.prompt,
            "seconds": round(slot.motion.seconds, 3),
            "quiet_s": QUIET_S,
            "beats": list(slot.motion.beats),
        }


def _plan(slots: list[Slot]) -> list[state_parts.PlanRow]:
    """Runs of the same item: task, takes, how many are kept or skipped."""
    rows: list[state_parts.PlanRow] = []
    last: PlanItem | None = None
    for slot in slots:
        if slot.item is not last:
            row = state_parts.PlanRow(
                task=slot.item.task, seconds=slot.item.seconds, takes=0, kept=0, skipped=0
            )
            rows.append(row)
            last = slot.item
        rows[-1]["takes"] += 1
        if slot.verdict:
            rows[-1][slot.verdict] += 1
    return rows


def as_calibration(calibration: Calibration) -> dict[str, Any]:
    """A calibration as JSON values: heading rad, bone_length (18,) m, seconds."""
    return {
        "heading": round(float(calibration.heading), 5),
        "bone_length": np.round(calibration.bone_length, 4).tolist(),
        "leg_length": round(float(calibration.leg_length), 4),
        "seconds": round(float(calibration.seconds), 2),
    }
