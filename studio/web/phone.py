"""A phone as the camera: who was invited, who is connected, and what of the studio they may use.

A phone has rights of its own, less than the token's: it shows the camera's page, sends the person
and stops. It comes by an invitation that is good once and for ten minutes, and can be sent away.
"""

import asyncio
import hmac
import io
import itertools
import re
import secrets
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import msgspec
import segno
from typing_extensions import TypedDict

from studio.errors import StudioError

PAGE = "/camera"
INVITED_S = 600.0
"""s for which an invitation is good."""
MOST = 8
RATE_OVER_S = 2.0
"""s over which the frames of a phone are counted."""
_KINDS = ("iPhone", "iPad", "Android", "Windows", "Macintosh", "Linux")


class Connected(TypedDict):
    """A phone. name: of its kind, numbered. since_s: since it came. frames_per_s: that it sends."""

    name: str
    since_s: float
    frames_per_s: float


class PhoneState(TypedDict):
    """GET /api/phone. on: whether `serve` was given --phone. url, qr: the invitation, and its
    picture as a data: URL. expires_s: until it is no good any more; a new one is made then."""

    on: bool
    why: str
    url: str
    qr: str
    expires_s: float
    phones: list[Connected]


@dataclass(kw_only=True)
class Phone:
    """token: in its cookie. since: when it came. gone: set once it is sent away."""

    name: str
    token: str
    since: float
    gone: asyncio.Event = field(default_factory=asyncio.Event)
    frames: list[float] = field(default_factory=list)


class Phones:
    """Invitations and phones. The event loop's thread only."""

    def __init__(self, url: str, clock: Callable[[], float] = time.monotonic) -> None:
        """url: of the door, with a slash at its end."""
        self.url, self._clock = url, clock
        self.phones: list[Phone] = []
        self._count = itertools.count(1)
        self.invite()

    def invite(self) -> None:
        """Make a new invitation; the one before is no good any more."""
        self._invitation = secrets.token_urlsafe(16)
        self._until = self._clock() + INVITED_S

    @property
    def invitation(self) -> str:
        """The URL to open on the phone: renewed when its time is over."""
        if self._clock() >= self._until:
            self.invite()
        return f"{self.url}{PAGE[1:]}?invite={self._invitation}"

    def accept(self, invitation: str, agent: str) -> Phone | None:
        """The phone that came with a good invitation, which is used up by it; None for others.

        agent: its browser's User-Agent. Beyond `MOST` phones, the one that came first has to go.
        """
        good = hmac.compare_digest(invitation.encode("utf-8", "replace"), self._invitation.encode())
        if not good or self._clock() >= self._until:
            return None
        self.invite()
        kind = next((kind for kind in _KINDS if kind in agent), "Browser")
        phone = Phone(
            name=f"{kind} {next(self._count)}", token=secrets.token_urlsafe(24), since=self._clock()
        )
        self.phones.append(phone)
        for one in self.phones[:-MOST]:
            self.send_away(one.name)
        return phone

    def known(self, tokens: list[str]) -> Phone | None:
        """Whose cookie is among these; compared in constant time."""
        for phone in self.phones:
            for token in tokens:
                if hmac.compare_digest(token.encode("utf-8", "replace"), phone.token.encode()):
                    return phone
        return None

    def send_away(self, name: str) -> None:
        """Its sockets close, its cookie is no good any more. StudioError if none has the name."""
        for phone in self.phones:
            if phone.name == name:
                self.phones.remove(phone)
                phone.gone.set()
                return
        known = ", ".join(phone.name for phone in self.phones) or "none"
        raise StudioError(f"no phone {name[:60]!r} is connected; connected: {known}")

    def sent(self, phone: Phone) -> None:
        """A frame of the phone's was received."""
        phone.frames.append(self._clock())
        self._forget(phone)

    def state(self) -> PhoneState:
        """For the page."""
        now = self._clock()
        url = self.invitation
        for phone in self.phones:
            self._forget(phone)
        return PhoneState(
            on=True,
            why="",
            url=url,
            qr=segno.make(url, micro=False).svg_data_uri(scale=5, border=3, light="#fff"),
            expires_s=round(self._until - now, 1),
            phones=[
                Connected(
                    name=phone.name,
                    since_s=round(now - phone.since, 1),
                    frames_per_s=round(len(phone.frames) / RATE_OVER_S, 1),
                )
                for phone in self.phones
            ],
        )

    def _forget(self, phone: Phone) -> None:
        over = self._clock() - RATE_OVER_S
        phone.frames = [t for t in phone.frames if t > over]


def off() -> PhoneState:
    """Where `serve` was not given --phone."""
    why = (
        "start the studio with `a1-studio serve --phone auto`: a phone's browser gives its "
        "camera to https alone"
    )
    return PhoneState(on=False, why=why, url="", qr="", expires_s=0.0, phones=[])


def drawn_in_a_terminal(url: str) -> str:
    """The QR code in half blocks."""
    out = io.StringIO()
    segno.make(url, micro=False).terminal(out, border=2, compact=True)
    return out.getvalue()


_PATHS = {
    "GET": {PAGE, "/api/state", "/api/health"},
    "POST": {f"/api/{name}" for name in ("stop", "reset", "source", "calibrate", "arm", "mode")},
}


def may(kind: str, method: str, path: str) -> bool:
    """Whether a phone may ask for this; kind: http or websocket."""
    if kind == "websocket":
        return path == "/api/human"
    if method in ("GET", "HEAD") and re.match(r"/assets/", path):
        return True
    return path in _PATHS.get(method, ())


SOURCES, MODES = ("webcam", "headset"), ("idle", "live")
"""What a phone may choose: to be the camera (a headset: itself), or to rest."""
MAX_BODY = 4096
"""Bytes of a request of a phone's."""


def may_ask(path: str, body: bytes) -> bool:
    """Whether a phone may ask for just this of a path that it may use."""
    key, known = {"/api/source": ("source", SOURCES), "/api/mode": ("mode", MODES)}.get(
        path, ("", ())
    )
    if not key:
        return True
    try:
        said = msgspec.json.decode(body, type=dict[str, str])
    except (msgspec.MsgspecError, RecursionError):
        return False
    return said.keys() == {key} and said[key] in known
