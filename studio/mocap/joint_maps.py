"""Which joint is which, as a person said it: read from JSON, remembered for each set of names."""

import hashlib
import logging
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import msgspec

from studio.errors import StudioError
from studio.files import open_regular, write_whole
from studio.human.joint_names import MAPPABLE

log = logging.getLogger(__name__)

JointMap = dict[str, list[str]]
"""Canonical joint → the file's joints whose middle it is; none: it is not there."""
FOLDER = ".joint-maps"
"""Beside the takes; no take's name begins with a dot."""
MAX_BYTES = 1_000_000
_EXAMPLE = '{"l_hip": "NAME", "head": ["NAME", "NAME"], "l_toe": null, …}'


class _Kept(msgspec.Struct):
    joints: list[str]
    map: dict[str, list[str]]


def joint_map_of(said: object) -> JointMap:
    """A map as JSON gives it, checked: names, lists of names or null by canonical joint.

    Raises StudioError for another form, and for a joint that we do not know.
    """
    try:
        raw = msgspec.convert(said, dict[str, str | list[str] | None])
    except msgspec.ValidationError as error:
        raise StudioError(f"a joint map is {_EXAMPLE}: {error}") from None
    unknown = [joint for joint in raw if joint not in MAPPABLE]
    if unknown:
        raise StudioError(f"joint map: no joint {unknown[0][:40]!r}; known: {', '.join(MAPPABLE)}")
    return {
        joint: [names] if isinstance(names, str) else list(names or ())
        for joint, names in raw.items()
    }


def read_joint_map(path: str | Path) -> JointMap:
    """The map in a JSON file. StudioError for what is none."""
    with open_regular(path, MAX_BYTES) as file:
        try:
            said = msgspec.json.decode(file.read())
        except (msgspec.DecodeError, RecursionError) as error:
            raise StudioError(f"{Path(path).name}: {error}; a joint map is {_EXAMPLE}") from None
    return joint_map_of(said)


class JointMaps:
    """The maps remembered beside the takes, one for each set of joint names. Any thread."""

    def __init__(self, sessions: str | Path) -> None:
        self._folder = Path(sessions) / FOLDER

    def of(self, names: Sequence[str]) -> JointMap | None:
        """The map for a skeleton of these joints; None where there is none that can be read.

        What it says of end sites that this one lacks is left out.
        """
        path = self._path(names)
        try:
            kept = msgspec.json.decode(path.read_bytes(), type=_Kept).map
            return {joint: own for joint, own in kept.items() if set(own) <= set(names)}
        except FileNotFoundError:
            return None
        except (OSError, msgspec.DecodeError) as error:
            log.warning("the joint map %s is left out: %s", path, error)
            return None

    def remember(self, names: Sequence[str], joint_map: Mapping[str, Sequence[str]]) -> None:
        """Keep a map for these joints, in place of the one before; an empty one forgets it.

        Raises StudioError if it cannot be written.
        """
        path = self._path(names)
        kept = _Kept(joints=list(names), map={j: list(own) for j, own in joint_map.items()})
        try:
            if not joint_map:
                path.unlink(missing_ok=True)
                return
            write_whole(path, msgspec.json.format(msgspec.json.encode(kept)), parents=True)
        except OSError as error:
            raise StudioError(f"the joint map was not kept: {error.strerror or error}") from error

    def _path(self, names: Iterable[str]) -> Path:
        own = "\n".join(sorted({name for name in names if not name.endswith("/end")}))
        return self._folder / f"{hashlib.sha256(own.encode()).hexdigest()[:16]}.json"
