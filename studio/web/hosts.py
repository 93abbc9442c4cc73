"""Names of hosts: those that a header or an option may say, and those of this machine alone."""

import ipaddress
import re
from collections.abc import Iterable

from studio.errors import StudioError

LOOPBACK_HOSTS = frozenset({"127.0.0.1", "localhost", "[::1]"})
EVERYWHERE = frozenset({"0.0.0.0", "::"})
"""What to listen on for every network this machine is in."""
_NAME = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+)*")


def bracketed(host: str) -> str:
    """A host as a URL has it: IPv6 addresses in brackets."""
    return f"[{host}]" if ":" in host and not host.startswith("[") else host


def checked_names(names: Iterable[str]) -> tuple[str, ...]:
    """Names fit for a Host header; StudioError for a URL, a port, a wildcard."""
    for name in names:
        bare = name.removeprefix("[").removesuffix("]")
        if not (_NAME.fullmatch(name) or (":" in bare and _is_address(bare))):
            raise StudioError(
                "--allow-host takes a bare name or address, such as studio.example.org or "
                f"192.168.1.20, not {name!r}"
            )
    return tuple(names)


def _is_address(text: str) -> bool:
    try:
        ipaddress.ip_address(text)
    except ValueError:
        return False
    return True


def split_host(value: str) -> tuple[str, int | None] | None:
    """(name, port or None) of a Host header, or None if it is not one: no user, path or dots."""
    name, colon, port = value.rpartition(":")
    if not colon or value.endswith("]"):
        name, port = value, ""
    elif not port.isascii() or not port.isdigit() or int(port) > 65535:
        return None
    return (name.lower(), int(port) if port else None) if name else None
