"""By which mapper the person is mapped, and in which style they walk."""

from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import Field

from studio.errors import StudioError
from studio.live.command import Command, Made, OneOf
from studio.live.mappers import SHIPPED, OpenedMapper, open_chosen
from studio.options import STYLES
from studio.retarget.baselines.registry import RIVALS
from studio.retarget.store import load_experts

if TYPE_CHECKING:
    from studio.live.runtime import Runtime


class SetStyle(Command):
    """Which human motion means walking, from the next period on: the shipped experts of that style
    take over, and the built-in operator walks in it too."""

    path: ClassVar[str] = "style"
    style: Annotated[str, OneOf("style", STYLES)]

    def prepare(self, runtime: "Runtime") -> OpenedMapper:
        """Read the style's experts."""
        runtime.mappers.fitting.cancel()
        return OpenedMapper(name=None, experts=load_experts(self.style))

    def apply(self, runtime: "Runtime", now: float, prepared: OpenedMapper) -> Made:
        """Swap them in."""
        return map_by(runtime, prepared)


class SetMapper(Command):
    """Map the person by the experts trained under this name, by those "shipped", or by a rival of
    `GET /api/rivals`, from the next period on. A rival is fitted first, which takes some ten
    seconds, once; what it refuses to map stays with the shipped experts."""

    path: ClassVar[str] = "mapper"
    tag: ClassVar[str] = "train"
    misfit_status: ClassVar[int] = 422
    name: str = Field(max_length=120)

    @property
    def waits(self) -> bool:
        """For a rival to be fitted."""
        return self.name in RIVALS

    def prepare(self, runtime: "Runtime") -> OpenedMapper:
        """Read the experts, or fit the rival; one that is being fitted for nobody now is ended."""
        runtime.mappers.fitting.cancel()
        config = runtime.config
        return open_chosen(config.sessions, self.name, config.puppeteer.style, runtime.mappers)

    def apply(self, runtime: "Runtime", now: float, prepared: OpenedMapper) -> Made:
        """Swap them in."""
        return map_by(runtime, prepared)


class MapperBack(Command):
    """Map by whichever experts were in use before: A/B, and the way back."""

    path: ClassVar[str] = "mapper/back"
    tag: ClassVar[str] = "train"

    def prepare(self, runtime: "Runtime") -> None:
        """A rival that is being fitted is not waited for any more."""
        runtime.mappers.fitting.cancel()

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Swap them in. StudioError if none was swapped in yet."""
        if runtime.mappers.before is None:
            raise StudioError("there is no mapper to go back to: none was swapped in yet")
        return map_by(runtime, runtime.mappers.before)


def map_by(runtime: "Runtime", mapper: OpenedMapper) -> Made:
    """Map the person by other experts, and walk in their style. StudioError for another style
    while a take is recorded; a take of a plan is thrown away then."""
    style = mapper.experts.style
    if style != runtime.puppeteer.config.style:
        recording = runtime.recorder.recording
        if recording is not None and runtime.mode != "collect":
            raise StudioError(f"take {recording} is being recorded: stop it first")
        runtime.collector.abort("the style was changed: the take was thrown away")
    runtime.mappers.swap(mapper)
    runtime.puppeteer.set_experts(mapper.experts)
    runtime.walk_in(style)
    return {"name": mapper.name or SHIPPED}
