"""Collecting: make a plan, add to it, and go through it."""

import secrets
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import AfterValidator, Field

from studio.errors import StudioError
from studio.live.collect_stages import ACTIONS, CollectPlan, Slot
from studio.live.collecting import draw_slots
from studio.live.command import Command, Made, OneOf
from studio.live.shown_motion import PlanItem

if TYPE_CHECKING:
    from studio.live.runtime import Runtime

MAX_PLAN = 200
"""Takes in one plan: each is drawn ahead, some 0.2 s of work."""


def _few_enough(items: tuple[PlanItem, ...]) -> tuple[PlanItem, ...]:
    if sum(item.takes for item in items) > MAX_PLAN:
        raise ValueError(f"a plan holds at most {MAX_PLAN} takes: collect in several rounds")
    return items


Items = Annotated[
    tuple[PlanItem, ...], Field(min_length=1, max_length=40), AfterValidator(_few_enough)
]


class SetPlan(Command, CollectPlan):
    """Choose what to collect, and from whom; mode collect follows it."""

    path: ClassVar[str] = "collect/plan"
    tag: ClassVar[str] = "collect"
    misfit_status: ClassVar[int] = 422
    items: Items

    def prepare(self, runtime: "Runtime") -> tuple[CollectPlan, list[Slot]]:
        """The plan with its seed, and the motions drawn for it."""
        seed = secrets.randbelow(2**31) if self.seed is None else self.seed
        return self.model_copy(update={"seed": seed}), draw_slots(self.items, seed)

    def apply(
        self, runtime: "Runtime", now: float, prepared: tuple[CollectPlan, list[Slot]]
    ) -> Made:
        """Start on it."""
        runtime.collector.begin(*prepared)
        return {}


class AddToPlan(Command):
    """More to collect, after what is planned."""

    path: ClassVar[str] = "collect/add"
    tag: ClassVar[str] = "collect"
    misfit_status: ClassVar[int] = 422
    items: Items

    def prepare(self, runtime: "Runtime") -> list[Slot]:
        """The motions drawn for it."""
        machine = runtime.collector.machine
        return draw_slots(self.items, machine.plan.seed or 0, len(machine.slots))

    def apply(self, runtime: "Runtime", now: float, prepared: list[Slot]) -> Made:
        """Put them at the end."""
        runtime.collector.machine.add(prepared)
        return {}


class CollectAction(Command):
    """Go, skip the preview, keep, redo, next, abort. Answers the state and, under `judged`, which
    take was kept or rejected."""

    path: ClassVar[str] = "collect/action"
    tag: ClassVar[str] = "collect"
    action: Annotated[str, OneOf("action", ACTIONS)]

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Tell the plan's state machine. StudioError in another mode, or where it cannot act."""
        if runtime.mode != "collect":
            raise StudioError("nothing is collected: choose mode collect first")
        if self.action in ("go", "skip", "redo"):
            runtime.reader.refuse_ended("collect again (mode live first)")
        return runtime.collector.act(self.action)

    def answer(self, state: dict[str, Any], made: Made) -> dict[str, Any]:
        """The state, and what was judged."""
        return {**state, "judged": made or None}
