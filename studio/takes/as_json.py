"""Ticks as JSON's values, for pages, scripts and traces: the fields of `tick.FIELDS`, rounded."""

from typing import Any

import msgspec
import numpy as np

from studio.human.pose import HumanPose
from studio.robot.pose import RobotPose
from studio.takes.tick import STREAMS, Field, Tick, fields_in

_SHARE = 3
"""Digits of votes."""


def numbers(x: Any, digits: int) -> Any:
    """Nested lists of rounded floats; a value that is not finite becomes null (JSON has none)."""
    rounded = np.round(np.asarray(x, dtype=np.float64), digits)
    if np.isfinite(rounded).all():
        return rounded.tolist()
    return [numbers(row, digits) if np.ndim(row) else _finite(row) for row in rounded]


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def plain(value: Any, digits: int = 5) -> Any:
    """Nested dicts and lists with numpy's numbers as Python's, and null for what is not finite.

    digits: of arrays; 10 µm and 0.0006°, finer than anything the view or a script can use.
    """
    if isinstance(value, dict):
        return {str(key): plain(item, digits) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item, digits) for item in value]
    if isinstance(value, np.ndarray):
        return numbers(value, digits)
    if isinstance(value, np.generic):
        value = value.item()
    return _finite(value) if isinstance(value, float) else value


def _json_value(field: Field, value: Any, digits: int) -> Any:
    if field.shape is not None:
        return numbers(value, digits)
    if isinstance(value, float):
        return _finite(round(value, digits))
    if isinstance(value, dict):
        share = _SHARE if field.keys else digits
        return {
            str(k): round(float(v), share) if isinstance(v, float) else plain(v)
            for k, v in value.items()
        }
    return plain(value)


def part(
    stream: str, value: HumanPose | RobotPose | Tick, form: str, digits: int = 5
) -> dict[str, Any]:
    """The fields of one stream that a form ("json", "trace") holds."""
    return {f.name: _json_value(f, getattr(value, f.attr), digits) for f in fields_in(form, stream)}


def tick_dict(tick: Tick, form: str = "json", digits: int = 5) -> dict[str, Any]:
    """One control period, as `WS /api/ticks` sends it (json) or a trace keeps it (trace)."""
    out = part("tick", tick, form, digits)
    for stream in STREAMS[:-1]:
        value = getattr(tick, stream)
        if fields_in(form, stream):
            out[stream] = None if value is None else part(stream, value, form, digits)
    if out.get("human") is not None:
        out["human"]["skeleton"] = "studio"
        echo = tick.human and tick.human.echo
        out["human"]["echo"] = echo and {"sent": echo.sent, "waited_ms": round(echo.waited_ms, 3)}
    return out


def tick_json(tick: Tick, **more: Any) -> bytes:
    """UTF-8 JSON of `tick_dict` with further keys: what the sockets send."""
    return msgspec.json.encode({**tick_dict(tick), **more})
