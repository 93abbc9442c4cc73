"""Takes grouped by who made them and when: one small JSON file a session, beside the takes.

`.sessions/OPERATOR-YYYYMMDD.json` in the sessions folder holds the operator's name, notes, the
calibration of the last take and the names of the takes. Takes do not depend on it: losing it loses
the grouping only.
"""

import contextlib
from datetime import date, datetime
from pathlib import Path
from typing import Any

import msgspec

from studio.errors import StudioError
from studio.files import write_whole
from studio.takes.names import check_name, slug
from studio.takes.untrusted import read_json

FOLDER = ".sessions"
MOST_OPERATOR = 60
"""Characters, as of a plan."""


class CollectSession(msgspec.Struct, kw_only=True):
    """One operator's takes of one day. calibration: JSON values, as `as_calibration` gives them."""

    name: str
    operator: str
    day: str
    notes: str = ""
    calibration: dict[str, Any] | None = None
    takes: list[str] = []

    def as_dict(self) -> dict[str, Any]:
        """Plain values."""
        return msgspec.to_builtins(self)


_session = msgspec.json.Decoder(CollectSession)


def session_name(operator: str, day: date) -> str:
    """The session an operator's takes of a day belong to; fit for a file's name."""
    return f"{slug(operator) or 'me'}-{day:%Y%m%d}"


class SessionBook:
    """The sessions of one folder of takes. Each method reads the disk anew; any thread."""

    def __init__(self, root: Path) -> None:
        self.folder = Path(root) / FOLDER

    def list(self) -> "list[CollectSession]":
        """Every session, the newest day first. Damaged files are left out."""
        found = []
        for path in self.folder.glob("*.json"):
            try:
                found.append(self._decode(path))
            except StudioError:
                continue
        return sorted(found, key=lambda s: (s.day, s.name), reverse=True)

    def read(self, name: str) -> CollectSession:
        """One session; StudioError for an unfit, unknown or damaged one."""
        path = self._path(name)
        if not path.is_file():
            known = ", ".join(s.name for s in self.list()[:8]) or "none yet"
            raise StudioError(f"unknown session {name!r}; known: {known}")
        return self._decode(path)

    def note(self, name: str, notes: str) -> CollectSession:
        """Replace a session's notes."""
        session = self.read(name)
        session.notes = notes
        self._write(session)
        return session

    def add(
        self, operator: str, take: str, *, notes: str = "", calibration: dict | None = None
    ) -> CollectSession:
        """Put a take into its operator's session of today, which is begun if there is none."""
        today = datetime.now().astimezone().date()
        name = session_name(operator, today)
        try:
            session = self.read(name)
        except StudioError:
            session = CollectSession(name=name, operator=operator, day=today.isoformat())
        session.notes = notes or session.notes
        session.calibration = calibration or session.calibration
        if take not in session.takes:
            session.takes.append(take)
        self._write(session)
        return session

    def rejoin(self, take: str, about: dict[str, Any], day: str) -> None:
        """Put a take from elsewhere into the session that its meta.json names, if it names one.

        about: what meta.json says the take was recorded as. day: YYYY-MM-DD, of a session that is
        begun for it. Losing this loses the grouping only: what does not fit is left.
        """
        collected = about.get("collect")
        said = collected if isinstance(collected, dict) else {}
        name, operator = str(said.get("session") or ""), str(said.get("operator") or "")
        if not name or len(operator) > MOST_OPERATOR:
            return
        with contextlib.suppress(StudioError):
            if self._path(name).is_file():
                session = self.read(name)
            else:
                session = CollectSession(name=name, operator=operator, day=day)
            if take not in session.takes:
                session.takes.append(take)
                self._write(session)

    def _path(self, name: str) -> Path:
        return self.folder / f"{check_name(name, 'session')}.json"

    def _decode(self, path: Path) -> CollectSession:
        try:
            return read_json(path, _session)
        except (OSError, ValueError) as error:
            raise StudioError(f"session {path.stem} is damaged: remove {path}") from error

    def _write(self, session: CollectSession) -> None:
        path = self._path(session.name)
        try:
            data = msgspec.json.format(msgspec.json.encode(session), indent=1)
            write_whole(path, data, parents=True)
        except OSError as error:
            raise StudioError(f"session {session.name} was not kept: {error.strerror}") from error
