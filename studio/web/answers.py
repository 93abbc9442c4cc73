"""The studio's state as the API answers it: its schema, and so the page's types.

Answers are plain dicts, written out where they are made; nothing here runs when one is given. The
state's keys are those of `live.state.KEYS`; each other type names every key that is sent (a test
compares them), so that the schema hides none.
"""

from typing import Any, Literal

from typing_extensions import TypedDict

from studio.live.state import KEYS
from studio.live.state_parts import Controller, TaskName


class Control(TypedDict):
    """Which page drives, and all of them. free: that page is gone, or none drives. away: it is
    out of sight, behind another tab or minimised. asking: pages that ask for control, in order."""

    holder: str | None
    pages: list[str]
    free: bool
    away: bool
    asking: list[str]


def _says(name: str, says: str, **more: Any) -> Any:
    """The type of an object that holds the state's keys and `more`."""
    made: Any = TypedDict(name, {key: kind for key, (kind, _) in KEYS.items()} | more)  # type: ignore[misc]
    made.__doc__ = says
    return made


_BESIDE: dict[str, Any] = {
    "control": Control, "tasks": list[TaskName], "controllers": list[Controller],
}  # fmt: skip
"""What the gateway adds to the loop's own (`Hub.state`)."""

State = _says(
    "State",
    "GET /api/state: what the studio is doing, and why nothing moves if nothing does.",
    **_BESIDE,
)
StateMessage = _says(
    "StateMessage",
    "The same, as `WS /api/control` sends it to `page` ten times a second.",
    **_BESIDE,
    type=Literal["state"],
    page=str,
)
Judged = _says(
    "Judged",
    "judged: which take an action kept or rejected.",
    **_BESIDE,
    judged=dict[str, Any] | None,
)


class Refused(TypedDict):
    """Any refusal. error: the same as `why`."""

    why: str
    error: str


REFUSED: dict[int, str] = {
    404: "there is none of that name",
    409: "not applied",
    411: "how long the body is was not said",
    413: "too large",
    415: "not a kind of file that is read",
    422: "it does not fit, or cannot be used",
    507: "there is no room to keep it",
}
"""What each status of a refusal means."""


def answers(kind: Any, *refusals: int) -> dict[str, Any]:
    """Options of a route whose answer the schema is to describe as `kind`, without checking it.

    refusals: the statuses, of `REFUSED`, with which it may refuse.
    """
    return {"response_model": None, "responses": {200: {"model": kind}, **refusing(*refusals)}}


def refusing(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """The same for its refusals alone."""
    return {s: {"model": Refused, "description": f"{REFUSED[s]}: see `why`"} for s in statuses}
