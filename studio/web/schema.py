"""The API's schema, with what the sockets send, which OpenAPI has no paths for."""

from typing import Any

from pydantic import TypeAdapter

from studio.live.tick_message import TickMessage
from studio.web.answers import StateMessage

PARTS = "#/components/schemas/"
FOREIGN = ("HTTPValidationError", "ValidationError")
"""FastAPI's own idea of a refusal, which it notes wherever something is asked; ours are declared
with each route (`answers`)."""


def with_messages(schema: dict[str, Any]) -> dict[str, Any]:
    """An OpenAPI schema with the sockets' messages among its components.

    What is sent has every key that has a default, too: only a request may leave one out.
    """
    kinds = [(kind, "serialization", TypeAdapter(kind)) for kind in (TickMessage, StateMessage)]
    _, found = TypeAdapter.json_schemas(
        kinds,  # type: ignore[arg-type]
        ref_template=f"{PARTS}{{model}}",
    )
    parts = schema["components"]["schemas"]
    parts |= found["$defs"]
    routes = [route for path in schema["paths"].values() for route in path.values()]
    for name in FOREIGN:
        parts.pop(name, None)
    for route in routes:
        if FOREIGN[0] in str(route["responses"].get("422")):
            del route["responses"]["422"]
    asked = _named([route.get("requestBody") for route in routes], parts)
    for name in parts.keys() - asked:
        part = parts[name]
        always = [key for key, value in part.get("properties", {}).items() if "default" in value]
        if always:
            part["required"] = list(dict.fromkeys([*part.get("required", ()), *always]))
    return schema


def _named(node: Any, parts: dict[str, Any]) -> set[str]:
    """Names of the parts of a schema that `node` refers to, whatever lies between."""
    if isinstance(node, list):
        return {name for item in node for name in _named(item, parts)}
    if not isinstance(node, dict):
        return set()
    name = str(node.get("$ref", "")).removeprefix(PARTS)
    inner = _named(parts[name], parts) | {name} if name else set()
    return inner | _named(list(node.values()), parts)
