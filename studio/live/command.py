"""What may be asked of the control loop: each command is one declaration, and all follows from it.

Its fields with their limits are the HTTP body, the validation and the schema (`web.commands_api`);
`prepare` does what takes long, on the asker's thread; `apply` does the rest on the loop's.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, TypeVar

from pydantic import (
    AllowInfNan,
    BaseModel,
    ConfigDict,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Strict,
    model_validator,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from studio.errors import StudioError, unknown_name

if TYPE_CHECKING:
    from studio.live.runtime import Runtime

T = TypeVar("T")
Number = Annotated[float, Strict(), AllowInfNan(False)]
"""A finite number of a body, whole or not."""
Made = dict[str, Any]
"""What a command made: a take's name and ticks, say."""


class Body(BaseModel):
    """What a request's body may hold: its fields, and no other key.

    Its fields are `Number`, `StrictInt`, `StrictBool`: else "1" and true would be 1, "no" false.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, asked: Any) -> Any:
        return with_known_keys(asked, cls.model_fields)


class Command(Body, ABC):
    """Frozen: it crosses threads. A subclass in `live/commands/` is all that a new command needs.

    path: POST /api/PATH asks for it; a field in braces is part of the path; "": no path of its own.
    tag: its group in the schema. misfit_status: the answer to a body that does not fit.
    sender: the field, if any, that names the page which asks; never part of the body.
    releases: lets a stopped robot move again, so that it must have been sent after the last stop.
    """

    path: ClassVar[str] = ""
    tag: ClassVar[str] = "studio"
    misfit_status: ClassVar[int] = 409
    sender: ClassVar[str] = ""
    releases: ClassVar[bool] = False

    @property
    def prepares(self) -> bool:
        """There is something to open, read or draw before the loop's thread can apply it."""
        return type(self).prepare is not Command.prepare

    @property
    def waits(self) -> bool:
        """Its `prepare` waits for another process, and keeps nobody from opening a file."""
        return False

    def prepare(self, runtime: "Runtime") -> Any:
        """Open, read or draw what `apply` needs; any thread. StudioError says what is not there."""

    @abstractmethod
    def apply(self, runtime: "Runtime", now: float, prepared: Any) -> Made:
        """Do it, on the loop's thread; StudioError says why not. Returns what it made, if anything.

        now: s on the loop's clock. prepared: what `prepare` returned.
        """

    def answer(self, state: dict[str, Any], made: Made) -> dict[str, Any]:
        """The object that answers its request: the state (GET /api/state) after it, by default."""
        return state


@dataclass(frozen=True)
class OneOf:
    """A field's limit: a name of a registry. Others are refused with those that would work."""

    kind: str
    known: Iterable[str]

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Called by pydantic: `check` after the type."""
        return core_schema.no_info_after_validator_function(self.check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Called by pydantic: the names, for the schema."""
        return {**handler(schema), "enum": list(self.known)}

    def check(self, name: str | None) -> str | None:
        """`name` itself (None where a field may be left out), or pydantic's error saying why."""
        if name is not None and name not in self.known:
            why = str(unknown_name(self.kind, name[:64], self.known))
            raise PydanticCustomError("misfit", "{why}", {"why": why})
        return name


def with_known_keys(asked: Any, known: Iterable[str]) -> Any:
    """`asked`, or pydantic's error on its first key that is none of `known`, naming those."""
    for key in asked if isinstance(asked, dict) else ():
        if key not in known:
            why = str(unknown_name("key", str(key)[:64], known))
            raise PydanticCustomError("misfit", "{why}", {"why": why})
    return asked


def with_why(check: Callable[..., T], *values: Any) -> T:
    """Call `check`; its StudioError becomes pydantic's, which a validator may raise."""
    try:
        return check(*values)
    except StudioError as error:
        raise PydanticCustomError("misfit", "{why}", {"why": str(error)}) from error


def misfit(errors: Iterable[Any], first: int = 0) -> str:
    """One line on pydantic's errors: which field, and what it should be.

    first: how much of where it lies to leave out (FastAPI begins with "body").
    """
    return "; ".join(
        f"{'.'.join(str(part) for part in e['loc'][first:]) or 'body'}: {e['msg']}" for e in errors
    )


@dataclass(frozen=True, kw_only=True)
class Result:
    """The loop's answer, given after the tick in which a command was applied.

    ok: applied. why: one line, if it was refused. state: the object of GET /api/state after that
    tick. data: what the command made.
    """

    ok: bool
    why: str = ""
    state: dict[str, Any] = field(default_factory=dict)
    data: Made = field(default_factory=dict)
