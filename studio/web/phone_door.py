"""The HTTPS that a phone comes in by, beside the studio's own server and on the same event loop."""

import asyncio
import contextlib
import datetime
import ipaddress
import os
import socket
import sys
from pathlib import Path

import uvicorn
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from studio.errors import StudioError
from studio.files import write_whole
from studio.web.access import (
    OPEN_PATHS,
    AccessConfig,
    AccessMiddleware,
    arrived,
    asked,
    cookies,
    opens_page,
)
from studio.web.hosts import EVERYWHERE
from studio.web.http_server import bind, uvicorn_config
from studio.web.hub import Hub
from studio.web.phone import PAGE, Phone, Phones, drawn_in_a_terminal, may
from studio.web.tokens import checked_token

FILE = ".phone.pem"
"""Key and certificate, in the folder of takes: a phone that trusted it once need not again."""
DAYS = 365
AUTO = "auto"
_SORRY = """<!doctype html><html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1"><title>A1 Studio</title><style>
body { font: 18px/1.5 system-ui, sans-serif; margin: 15vh auto; width: min(420px, 86vw);
color-scheme: dark light }</style></head><body><h1>Not invited</h1><p>An invitation is good once,
and for ten minutes: take a new code from the studio’s page, under Your camera.</p></body></html>"""
Headers = dict[str, list[str]]


def address_for(said: str) -> str:
    """The address that a phone can reach: the one given, or for `auto` this machine's in its
    network. StudioError where there is none, or it is no address of one network."""
    if said == AUTO:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as way:
            try:
                way.connect(("192.0.2.1", 9))  # nothing is sent: it only chooses a way out
                return str(way.getsockname()[0])
            except OSError as error:
                raise StudioError(
                    "--phone auto found no network: give this machine's address in it, such as "
                    "--phone 192.168.1.20"
                ) from error
    try:
        ipaddress.ip_address(said)
    except ValueError:
        said = ""
    if not said or said in EVERYWHERE:
        raise StudioError(
            "--phone takes the address of this machine that the phone can reach, such as "
            "192.168.1.20, or auto"
        )
    return said


def certificate(folder: Path, address: str) -> Path:
    """A file with a certificate for the address and its key; made where there is none that is good
    for a day more. StudioError if it cannot be written."""
    file, day = folder / FILE, datetime.timedelta(days=1)
    now, ours = datetime.datetime.now(datetime.UTC), ipaddress.ip_address(address)
    with contextlib.suppress(OSError, ValueError, x509.ExtensionNotFound):
        about, known = file.lstat(), x509.load_pem_x509_certificate(file.read_bytes())
        names = known.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
        private = about.st_uid == os.getuid() and not about.st_mode & 0o077
        fits = ours in names.get_values_for_type(x509.IPAddress)
        if private and fits and now + day < known.not_valid_after_utc:
            return file
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "A1 Studio")])
    made = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - day)
        .not_valid_after(now + DAYS * day)
        .add_extension(x509.SubjectAlternativeName([x509.IPAddress(ours)]), critical=False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(x509.ExtendedKeyUsage([x509.OID_SERVER_AUTH]), critical=False)
        .sign(key, hashes.SHA256())
    )
    plain = serialization.NoEncryption()
    form = serialization.PrivateFormat.PKCS8
    pem = key.private_bytes(serialization.Encoding.PEM, form, plain)
    pem += made.public_bytes(serialization.Encoding.PEM)
    try:
        write_whole(file, pem.decode(), parents=True, mode=0o600)
    except OSError as error:
        raise StudioError(f"no certificate for the phone: {error.strerror} ({folder})") from error
    return file


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
        """Its frames are counted, and its socket ends when it is sent away."""
        phone = self._phone(headers)
        if scope["type"] == "websocket" and phone is not None:
            receive = self._followed(phone, receive)
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


class SecondServer(uvicorn.Server):
    """Serves an application whose lifespan is another server's; `state` is what that one made."""

    def __init__(self, config: uvicorn.Config, listener: socket.socket) -> None:
        """config: without a lifespan and signals of its own."""
        super().__init__(config)
        self.listener, self.state = listener, {}
        self.capture_signals = contextlib.nullcontext  # type: ignore[method-assign, assignment]

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """As uvicorn's, with the other server's state."""
        self.lifespan.state.update(self.state)
        await super().startup(sockets)


class FirstServer(uvicorn.Server):
    """A server beside which a second one runs on the same event loop, and ends before it."""

    def __init__(self, config: uvicorn.Config, second: SecondServer) -> None:
        super().__init__(config)
        self._second = second

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Both."""
        await super().startup(sockets)
        self._second.state = self.lifespan.state
        self._running = asyncio.create_task(self._second.serve([self._second.listener]))

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """The second one first: what answers it is still there."""
        self._second.should_exit = True
        await self._running
        await super().shutdown(sockets)


def second_server(said: str, port: int, hub: Hub, app: ASGIApp) -> SecondServer:
    """What invited phones come in by; the first invitation is drawn in the terminal.

    said: as `address_for`, whose errors it raises, and those of `bind` and `certificate`.
    """
    address = address_for(said)
    listener = bind(address, port)
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
