"""The HTTPS that a phone comes in by, beside the studio's own server and on the same event loop."""

import asyncio
import socket
import sys

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from studio.errors import StudioError
from studio.web.access import (
    OPEN_PATHS,
    AccessConfig,
    AccessMiddleware,
    arrived,
    asked,
    cookies,
    opens_page,
)
from studio.web.http_server import bind, uvicorn_config
from studio.web.hub import Hub
from studio.web.phone import (
    MAX_BODY,
    PAGE,
    Phone,
    Phones,
    drawn_in_a_terminal,
    may,
    may_ask,
)
from studio.web.phone_certificate import address_for, certificate
from studio.web.refusals import refuse
from studio.web.second_server import FewAtOnce, SecondServer
from studio.web.tokens import checked_token

_SORRY = """<!doctype html><html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1"><title>A1 Studio</title><style>
body { font: 18px/1.5 system-ui, sans-serif; margin: 15vh auto; width: min(420px, 86vw);
color-scheme: dark light }</style></head><body><h1>Not invited</h1><p>An invitation is good once,
and for ten minutes: take a new code from the studio’s page, under Your camera.</p></body></html>"""
Headers = dict[str, list[str]]


class PhoneGate(AccessMiddleware):
    """Lets phones that were invited have what a phone may have of the same application."""

    def __init__(self, app: ASGIApp, config: AccessConfig, phones: Phones) -> None:
        """config: of this door; its token is of no use here."""
        super().__init__(app, config, _SORRY)
        self.phones = phones

    def _arrival(
        self, scope: Scope, headers: Headers
    ) -> tuple[int, list[tuple[bytes, bytes]], bytes] | None:
        """`GET /camera?invite=…`: the phone gets a cookie of its own."""
        invitations = asked(scope, "invite")
        if not opens_page(scope) or scope["path"] != PAGE or len(invitations) != 1:
            return None
        if self._phone(headers) is not None:  # opened again
            return 303, [(b"location", PAGE.encode())], b""
        phone = self.phones.accept(invitations[0], " ".join(headers.get("user-agent", [])))
        return None if phone is None else arrived(scope, self.config.cookie, phone.token)

    def _unknown(self, scope: Scope, headers: Headers) -> tuple[int, str] | None:
        if scope["type"] == "http" and scope["path"] in OPEN_PATHS:
            return None
        if self._phone(headers) is None:
            return 401, "this phone was not invited, or was sent away"
        if not may(scope["type"], scope.get("method", ""), scope["path"]):
            return 403, "a phone may only be the camera"
        return None

    async def _enter(self, scope: Scope, receive: Receive, send: Send, headers: Headers) -> None:
        """Its frames are counted, and its socket ends when it is sent away.

        What it asks for is read whole before anything is done: by then it may have been sent away.
        """
        phone = self._phone(headers)
        if scope["type"] == "websocket" and phone is not None:
            receive = self._followed(phone, receive)
        elif scope["method"] == "POST":
            body = await _whole(receive)
            if body is None or not may_ask(scope["path"], body):
                await refuse(scope, send, 403, "a phone may only be the camera")
                return
            if self._phone(headers) is None:
                await refuse(scope, send, 401, "this phone was sent away")
                return
            receive = _again(body, receive)
        await self.app(scope, receive, send)

    def _phone(self, headers: Headers) -> Phone | None:
        return self.phones.known(cookies(headers, self.config.cookie))

    def _followed(self, phone: Phone, receive: Receive) -> Receive:
        async def next_message() -> Message:
            gone = asyncio.ensure_future(phone.gone.wait())
            came = asyncio.ensure_future(receive())
            try:
                await asyncio.wait((gone, came), return_when=asyncio.FIRST_COMPLETED)
                if phone.gone.is_set():
                    return {"type": "websocket.disconnect", "code": 1008}
                message = came.result()
            finally:
                gone.cancel()
                came.cancel()
            if message["type"] == "websocket.receive":
                self.phones.sent(phone)
            return message

        return next_message


async def _whole(receive: Receive) -> bytes | None:
    """A request's body; None if its sender left, or says too much."""
    body, more = b"", True
    while more:
        message = await receive()
        body += message.get("body", b"")
        more = message.get("more_body", False)
        if message["type"] == "http.disconnect" or len(body) > MAX_BODY:
            return None
    return body


def _again(body: bytes, receive: Receive) -> Receive:
    """`receive` of a body that was read already."""
    left: list[Message] = [{"type": "http.request", "body": body, "more_body": False}]

    async def next_message() -> Message:
        return left.pop() if left else await receive()

    return next_message


def _bound(address: str, port: int) -> socket.socket:
    try:
        return bind(address, port)
    except StudioError as error:
        said = str(error).replace("--host", "--phone").replace("--port", "--phone-port")
        raise StudioError(said) from error


def second_server(said: str, port: int, hub: Hub, app: ASGIApp) -> SecondServer:
    """What invited phones come in by; the first invitation is drawn in the terminal.

    said: as `address_for`, whose errors it raises, and those of `bind` and `certificate`.
    """
    address = address_for(said)
    listener = FewAtOnce(_bound(address, port))
    access = AccessConfig(
        token=checked_token(None), host=address, port=listener.getsockname()[1], secure=True
    )
    hub.phones = Phones(access.url)
    pem = str(certificate(hub.sessions, address))
    tls = {"ssl_certfile": pem, "ssl_keyfile": pem, "lifespan": "off"}
    invitation = hub.phones.invitation
    sys.stderr.write(
        f"A phone's camera: scan this, or open {invitation}\n{drawn_in_a_terminal(invitation)}"
        "Its browser will warn that nobody vouches for the certificate: this machine made it.\n"
    )
    return SecondServer(uvicorn_config(PhoneGate(app, access, hub.phones), tls), listener)
