"""Who may speak to the studio: Host, Origin and token are checked on every request and socket.

An ASGI middleware, because HTTP middlewares (CORS among them) never see a WebSocket. The order is
Host (421), Origin (403), token (401). Bearer clients pass the first two checks as well: a page
that rebinds its name to 127.0.0.1 can send any header but these.
"""

import hmac
import json
from collections.abc import Iterable
from dataclasses import dataclass
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlsplit

from starlette.types import ASGIApp, Message, Receive, Scope, Send

OPEN_PATHS = frozenset({"/api/health"})
LOOPBACK_HOSTS = frozenset({"127.0.0.1", "localhost", "[::1]"})

PAGE_CSP = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "font-src 'self'; connect-src 'self'; frame-src 'self'; media-src 'self' blob:; "
    "worker-src 'self' blob:; form-action 'self'; base-uri 'none'; frame-ancestors 'self'"
)
# viser's client is one file: an inline loader that unpacks WebAssembly, styles and a module. It
# gets no eval, so a message that carries JavaScript has nothing to run it with, and nowhere to
# connect but here.
VIEW_CSP = (
    "default-src 'none'; script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' blob:; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; "
    "connect-src 'self' data: blob:; worker-src blob:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'self'"
)


@dataclass(frozen=True, kw_only=True)
class AccessConfig:
    """token: the secret of this run. host: what `--host` named. port: the public port."""

    token: str
    host: str
    port: int

    @property
    def cookie(self) -> str:
        """Cookies know no ports: two studios on one machine need two names."""
        return f"a1_studio_{self.port}"

    @property
    def hosts(self) -> frozenset[str]:
        """Host names we answer to, without a port."""
        own = f"[{self.host}]" if ":" in self.host else self.host
        return LOOPBACK_HOSTS | {own.lower()}


def split_host(value: str) -> tuple[str, int | None] | None:
    """(name, port or None) of a Host header, or None if it is not one: no user, path or dots."""
    name, colon, port = value.rpartition(":")
    if not colon or value.endswith("]"):
        name, port = value, ""
    elif not port.isascii() or not port.isdigit() or int(port) > 65535:
        return None
    return (name.lower(), int(port) if port else None) if name else None


def host_allowed(values: list[str], config: AccessConfig) -> bool:
    """Exactly one Host header, and it names us (RFC 9110 7.2; 421 otherwise)."""
    if len(values) != 1:
        return False
    parsed = split_host(values[0])
    return parsed is not None and parsed[0] in config.hosts


def origin_allowed(origins: list[str], host: str, config: AccessConfig) -> bool:
    """No Origin (not a browser), or one whose host is ours on the port that was asked."""
    if not origins:
        return True
    if len(origins) != 1:
        return False
    scheme, _, rest = origins[0].partition("://")
    parsed = split_host(rest)
    if scheme not in ("http", "https") or parsed is None or parsed[0] not in config.hosts:
        return False
    default = 443 if scheme == "https" else 80
    asked = split_host(host)
    ports = {config.port, (asked and asked[1]) or default}
    return (parsed[1] or default) in ports


def token_allowed(headers: dict[str, list[str]], config: AccessConfig) -> bool:
    """A bearer token or our cookie, compared in constant time."""
    offered: list[str] = []
    for value in headers.get("authorization", []):
        scheme, _, token = value.partition(" ")
        if scheme.lower() == "bearer":
            offered.append(token.strip())
    for value in headers.get("cookie", []):
        try:
            morsel = SimpleCookie(value).get(config.cookie)
        except CookieError:
            continue
        if morsel is not None:
            offered.append(morsel.value)
    return any(_same(token, config.token) for token in offered)


def _same(a: str, b: str) -> bool:
    return hmac.compare_digest(a.encode("utf-8", "replace"), b.encode())


class AccessMiddleware:
    """Wraps the whole application; refuses before anything of it runs."""

    def __init__(self, app: ASGIApp, config: AccessConfig) -> None:
        self.app, self.config = app, config

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Check, then pass on; answers get the security headers on their way out."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        headers: dict[str, list[str]] = {}
        for name, value in scope["headers"]:
            headers.setdefault(name.decode("latin-1").lower(), []).append(value.decode("latin-1"))
        hosts = headers.get("host", [])
        path = scope["path"]
        if not host_allowed(hosts, self.config):
            await _refuse(scope, send, 421, "this Host is not served here; use the printed URL")
        elif not origin_allowed(headers.get("origin", []), hosts[0], self.config):
            await _refuse(scope, send, 403, "this Origin may not speak to the studio")
        elif path in OPEN_PATHS and scope["type"] == "http":
            await self.app(scope, receive, _secured(send, path))
        elif (arrival := self._arrival(scope)) is not None:
            await _send(send, *arrival)
        elif not token_allowed(headers, self.config):
            await _refuse(scope, send, 401, "the token is missing or wrong; open the printed URL")
        else:
            await self.app(scope, receive, _secured(send, path))

    def _arrival(self, scope: Scope) -> tuple[int, list[tuple[bytes, bytes]], bytes] | None:
        """`GET /?token=…`: set the cookie and get the token out of the address bar."""
        if scope["type"] != "http" or scope["path"] != "/" or scope["method"] != "GET":
            return None
        token = parse_qs(scope["query_string"].decode("latin-1")).get("token", [])
        if len(token) != 1 or not _same(token[0], self.config.token):
            return None
        cookie = f"{self.config.cookie}={self.config.token}; HttpOnly; SameSite=Strict; Path=/"
        headers = [(b"location", b"/"), (b"set-cookie", cookie.encode())]
        return 303, [*headers, *_security_headers("/")], b""


def _security_headers(path: str) -> list[tuple[bytes, bytes]]:
    csp = VIEW_CSP if path.startswith("/view/") else PAGE_CSP
    return [
        (b"content-security-policy", csp.encode()),
        (b"x-content-type-options", b"nosniff"),
        (b"referrer-policy", b"no-referrer"),
        (b"cross-origin-opener-policy", b"same-origin"),
        (b"cross-origin-resource-policy", b"same-origin"),
        (b"cache-control", b"no-store"),
    ]


def _secured(send: Send, path: str) -> Send:
    async def wrapped(message: Message) -> None:
        if message["type"] == "http.response.start":
            present = {name.lower() for name, _ in message["headers"]}
            extra = [h for h in _security_headers(path) if h[0] not in present]
            message = {**message, "headers": [*message["headers"], *extra]}
        await send(message)

    return wrapped


async def _refuse(scope: Scope, send: Send, status: int, why: str) -> None:
    body = json.dumps({"error": why}).encode()
    headers = [(b"content-type", b"application/json"), *_security_headers("/")]
    if status == 401:
        headers.append((b"www-authenticate", b"Bearer"))
    if scope["type"] == "http":
        await _send(send, status, headers, body)
    elif "websocket.http.response" in scope.get("extensions", {}):
        await _send(send, status, headers, body, prefix="websocket.http")
    else:
        await send({"type": "websocket.close", "code": 1008, "reason": why})


async def _send(
    send: Send,
    status: int,
    headers: Iterable[tuple[bytes, bytes]],
    body: bytes,
    prefix: str = "http",
) -> None:
    headers = [*headers, (b"content-length", str(len(body)).encode())]
    await send({"type": f"{prefix}.response.start", "status": status, "headers": headers})
    await send({"type": f"{prefix}.response.body", "body": body})


def page_url(config: AccessConfig) -> str:
    """The one URL a user opens."""
    wild = config.host in ("0.0.0.0", "::")
    host = "127.0.0.1" if wild else config.host
    host = f"[{host}]" if ":" in host else host
    url = f"http://{host}:{config.port}/?token={config.token}"
    assert urlsplit(url).port == config.port
    return url
