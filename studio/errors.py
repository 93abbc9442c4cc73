"""The one exception a user's mistake raises: it says what would work."""

from collections.abc import Iterable


class StudioError(Exception):
    """A mistake the user can mend; the message is one line and says what would work."""


def unknown_name(kind: str, name: object, known: Iterable[str]) -> StudioError:
    """A StudioError for a name that is not in a registry, listing those that are."""
    return StudioError(f"unknown {kind} {name!r}; known: {', '.join(sorted(known))}")
