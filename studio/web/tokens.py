"""The secret that a studio's URL carries: given, or kept beside its takes from start to start.

Kept, so that a page left open finds its way back after the studio was started anew.
"""

import logging
import os
import secrets
from pathlib import Path

from studio.errors import StudioError
from studio.files import write_whole

log = logging.getLogger(__name__)
FILE = ".token"
"""In the folder of takes; nobody else may read it. Delete it for a new token at the next start."""


def checked_token(token: str | None) -> str:
    """A token fit for a URL and a cookie, a new one for None; StudioError otherwise."""
    if token is None:
        return secrets.token_urlsafe(24)
    if not fit(token):
        raise StudioError("--token needs 1 to 200 letters, digits, or any of -_.~")
    if len(token) < 8:
        log.warning("the token is short enough to be guessed: leave --token out for a safe one")
    return token


def fit(token: str) -> bool:
    """1 to 200 characters that mean nothing in a URL or a cookie."""
    return 1 <= len(token) <= 200 and all(
        c.isascii() and (c.isalnum() or c in "-_.~") for c in token
    )


def kept_token(sessions: Path) -> str:
    """The token of a folder of takes; made at the first start, or where others could read it."""
    file = Path(sessions) / FILE
    try:
        with open(os.open(file, os.O_RDONLY | os.O_NOFOLLOW), "rb") as kept:
            about, token = os.fstat(kept.fileno()), kept.read(200).decode("ascii", "replace")
        if about.st_uid == os.getuid() and not about.st_mode & 0o077 and len(token) >= 32:
            return checked_token(token)
    except (OSError, StudioError):
        pass  # none yet, or one that is of no use
    token = checked_token(None)
    try:
        write_whole(file, token, parents=True, mode=0o600)
    except OSError as error:
        log.warning("the token is for this run only: %s (%s)", error.strerror, sessions)
    return token
