"""A control period as the sockets send it, for the schema: its types are read off `tick.FIELDS`."""

from typing import Annotated, Any

from typing_extensions import TypedDict

from studio.live.command import OneOf
from studio.live.commands import MODES
from studio.takes.tick import Field, fields_in

Mode = Annotated[str, OneOf("mode", MODES)]


def _type_of(field: Field) -> Any:
    """What JSON holds of a field."""
    if (field.stream, field.attr) == ("tick", "mode"):
        return Mode
    kind: Any = field.type if field.shape is None else float
    for _ in field.shape or ():
        kind = list[kind]
    return kind


def _message(name: str, says: str, stream: str, form: str = "json", **more: Any) -> Any:
    """The type of what `as_json.part` makes of a stream, with further keys."""
    kinds = {field.name: _type_of(field) for field in fields_in(form, stream)}
    made: Any = TypedDict(name, kinds | more)  # type: ignore[misc]
    made.__doc__ = says
    return made


Pose = _message(
    "Pose",
    "A robot: base_pos (3,) m, base_quat (4,) wxyz, joint_pos (12,) rad, foot_contact (4,).",
    "robot",
    "trace",
)
MovingPose = _message("MovingPose", "Also base_lin_vel_w (3,) m/s.", "reference")
SimulatedPose = _message(
    "SimulatedPose",
    "Also foot_pos_w (4, 3) m, and whether the trunk touches the floor.",
    "robot",
)
Echo: Any = TypedDict("Echo", {"sent": float, "waited_ms": float})
Echo.__doc__ = "Of a live frame: its own `t` (s), and ms from its arrival until it was read."
Human = _message(
    "Human",
    "A human frame: positions (19, 3) m and confidence (19,) of the skeleton `studio`.",
    "human",
    skeleton=str,
    echo=Echo | None,
)
TickMessage = _message(
    "TickMessage",
    "One control period, as `WS /api/ticks` sends it. target: (12,) rad.",
    "tick",
    human=Human | None,
    reference=MovingPose,
    robot=SimulatedPose,
)
