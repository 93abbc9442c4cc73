"""Collecting takes, as a state machine: ready, preview, countdown, record, review, done.

It knows of frames and of what was asked, not of clocks, files or figures: `step` is one control
period and says what to show and whether a take begins or ends; `collecting.Collector` does it.
"""

from dataclasses import dataclass, field
from typing import Literal

from pydantic import Field, StrictBool, StrictInt

from studio.errors import StudioError, unknown_name
from studio.live.command import Body
from studio.live.shown_motion import PlanItem, ShownMotion
from studio.reference.intent import Intent, StateName
from studio.robot.a1 import CONTROL_DT

Phase = Literal["setup", "ready", "preview", "countdown", "record", "review", "done"]
Event = Literal["", "start", "stop", "abort"]
ACTIONS: tuple[str, ...] = ("go", "skip", "keep", "redo", "next", "abort")

COUNTDOWN_S = 3.0
HANDS_FREE_REVIEW_S = 4.0
"""s after which a take is kept by itself, and the next begins, when nobody is near a button."""
HANDS_FREE_READY_S = 1.5


class CollectPlan(Body):
    """What to collect. operator: who acts. notes: about the session. preview: show each motion
    once before it is recorded. hands_free: go on without buttons. seed: of the motions, a new one
    if left out."""

    items: tuple[PlanItem, ...]
    operator: str = Field(default="me", min_length=1, max_length=60)
    notes: str = Field(default="", max_length=4000)
    preview: StrictBool = True
    hands_free: StrictBool = False
    seed: StrictInt | None = Field(default=None, ge=0)


@dataclass(frozen=True, kw_only=True)
class Step:
    """What one control period is.

    frame: of the motion shown; None: its first pose, at rest. intent: what is meant now. event: a
    take starts with this period, ended before it, or is thrown away.
    """

    phase: Phase
    state: StateName
    motion: ShownMotion | None
    frame: int | None
    intent: Intent
    event: Event = ""


@dataclass
class Slot:
    """One take to be made: its item and number, and what became of it. tries: recorded so far."""

    item: PlanItem
    number: int
    motion: ShownMotion
    tries: int = 0
    verdict: Literal["", "kept", "skipped"] = ""


@dataclass
class Collect:
    """Remembers plan, place in it, and phase. One thread only."""

    plan: CollectPlan = field(default_factory=lambda: CollectPlan(items=()))
    slots: list[Slot] = field(default_factory=list)
    at: int = 0
    phase: Phase = "setup"
    frame: int = 0  # control periods since the phase began
    _event: Event = ""

    def begin(self, plan: CollectPlan, slots: list[Slot]) -> None:
        """A new plan, from its first take. Refused while a take is recorded."""
        self._refuse_while_recording("choose another plan")
        self.plan, self.slots, self.at = plan, slots, 0
        self._enter("ready" if slots else "setup")

    def add(self, slots: list[Slot]) -> None:
        """More takes at the end of the plan."""
        self.slots = [*self.slots, *slots]
        if self.phase in ("setup", "done") and slots:
            self.at = next(i for i, slot in enumerate(self.slots) if not slot.verdict)
            self._enter("ready")

    @property
    def slot(self) -> Slot | None:
        """The take being made."""
        return self.slots[self.at] if self.at < len(self.slots) else None

    @property
    def t(self) -> float:
        """s since the phase began."""
        return self.frame * CONTROL_DT

    @property
    def remaining(self) -> float | None:
        """s until the phase ends by itself; None: it waits for somebody."""
        slot = self.slot
        lasts = {"countdown": COUNTDOWN_S}
        if slot is not None:
            lasts |= dict.fromkeys(("preview", "record"), slot.motion.seconds)
        if self.plan.hands_free:
            lasts |= {"review": HANDS_FREE_REVIEW_S, "ready": HANDS_FREE_READY_S}
        total = lasts.get(self.phase)
        return None if total is None else max(0.0, total - self.t)

    # What may be asked --------------------------------------------------------------------------

    def act(self, action: str) -> None:
        """One of ACTIONS. StudioError when it means nothing in this phase.

        go: from ready, start (preview, countdown, record). skip: end the preview. keep, redo, next:
        of a take just recorded; next also leaves a task out. abort: throw the running take away.
        """
        if action not in ACTIONS:
            raise unknown_name("action", action, ACTIONS)
        allowed = {
            "setup": (),
            "ready": ("go", "next"),
            "preview": ("skip", "abort", "next"),
            "countdown": ("abort", "next"),
            "record": ("abort",),
            "review": ("keep", "redo", "next"),
            "done": (),
        }[self.phase]
        if action not in allowed:
            may = f"may be: {', '.join(allowed)}" if allowed else "first make a plan"
            raise StudioError(f"{action} means nothing in phase {self.phase}; {may}")
        if action == "go":
            self._enter("preview" if self._previews else "countdown")
        elif action == "skip":
            self._enter("countdown")
        elif action == "abort":
            self.abort()
        elif action == "redo":
            self._enter("countdown")
        else:
            self._decide("kept" if action == "keep" else "skipped")

    def abort(self) -> None:
        """Back to ready; a running take is thrown away. Does nothing where nothing runs."""
        if self.phase == "record":
            self._event = "abort"
        if self.phase in ("preview", "countdown", "record"):
            self._enter("ready")

    # One control period -------------------------------------------------------------------------

    def step(self) -> Step:
        """Go on by one control period."""
        event, self._event = self._event, ""
        if self.remaining is not None and self.remaining < 0.5 * CONTROL_DT:
            event = self._ended() or event
        slot, phase = self.slot, self.phase
        runs = phase in ("preview", "record")
        frame = self.frame if runs else None
        self.frame += 1
        if slot is None:
            return Step(
                phase=phase, state="stand", motion=None, frame=None, intent=Intent(), event=event
            )
        return Step(
            phase=phase,
            state=slot.motion.state,
            motion=slot.motion,
            frame=frame,
            intent=slot.motion.intent(frame or 0),
            event=event,
        )

    def _ended(self) -> Event:
        """A phase's time is over: what comes next."""
        if self.phase == "countdown":
            assert self.slot is not None
            self.slot.tries += 1
            self._enter("record")
            return "start"
        if self.phase == "record":
            self._enter("review")
            return "stop"
        if self.phase == "preview":
            self._enter("countdown")
        elif self.phase == "ready":
            self._enter("preview" if self._previews else "countdown")
        elif self.phase == "review":
            self._decide("kept")
        return ""

    def _decide(self, verdict: Literal["kept", "skipped"]) -> None:
        assert self.slot is not None
        self.slot.verdict = verdict
        self.at = next(
            (i for i, slot in enumerate(self.slots) if not slot.verdict), len(self.slots)
        )
        self._enter("ready" if self.at < len(self.slots) else "done")

    @property
    def _previews(self) -> bool:
        return self.plan.preview and self.slot is not None and self.slot.tries == 0

    def _enter(self, phase: Phase) -> None:
        self.phase, self.frame = phase, 0

    def _refuse_while_recording(self, wish: str) -> None:
        if self.phase == "record":
            raise StudioError(f"a take is being recorded: let it end, or abort it, then {wish}")
