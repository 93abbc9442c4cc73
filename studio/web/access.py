"""Who may speak to the studio: Host, Origin and token are checked on every request and socket.

An ASGI middleware, because HTTP middlewares (CORS among them) never see a WebSocket. The order is
Host (421), Origin (403), token (401). Bearer clients pass the first two checks as well: a page
that rebinds its name to 127.0.0.1 can send any header but these.
"""

import hmac
from dataclasses import dataclass
from html import escape
from urllib.parse import parse_qs, urlsplit

from starlette.types import ASGIApp, Receive, Scope, Send

from studio.web.client_limits import RequestLimiter
from studio.web.hosts import EVERYWHERE, LOOPBACK_HOSTS, bracketed, split_host
from studio.web.refusals import (
    SIGN_IN_HEADERS,
    refuse,
    secured,
    security_headers,
    send_whole,
)

OPEN_PATHS = frozenset({"/api/health"})
AT_ONCE = frozenset({"/api/stop"})
"""What never waits for a turn."""
PAGES = frozenset({"/", "/camera"})
"""What a person opens, with the token in the query the first time."""


@dataclass(frozen=True, kw_only=True)
class AccessConfig:
    """token: the secret of this run. host: what `--host` named. port: the public port.

    names: further hosts to answer to (`--allow-host`). secure: we speak TLS ourselves.
    """

    token: str
    host: str
    port: int
    names: tuple[str, ...] = ()
    secure: bool = False

    @property
    def cookie(self) -> str:
        """Cookies know no ports: two studios on one machine need two names."""
        return f"a1_studio_{self.port}"

    @property
    def hosts(self) -> frozenset[str]:
        """Host names we answer to, without a port."""
        return LOOPBACK_HOSTS | {bracketed(name).lower() for name in (self.host, *self.names)}

    @property
    def url(self) -> str:
        """Where a user finds us: the first name that was allowed, or the address listened on."""
        wild = self.host in EVERYWHERE
        name = self.names[0] if self.names else "127.0.0.1" if wild else self.host
        return f"http{'s' if self.secure else ''}://{bracketed(name)}:{self.port}/"


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
    offered += cookies(headers, config.cookie)
    return any(_same(token, config.token) for token in offered)


def _same(a: str, b: str) -> bool:
    return hmac.compare_digest(a.encode("utf-8", "replace"), b.encode())


class AccessMiddleware:
    """Wraps the whole application; refuses before anything of it runs."""

    def __init__(self, app: ASGIApp, config: AccessConfig, sign_in: str = "{why}") -> None:
        """sign_in: a page with a form for the token, and {why} where it says what is wrong."""
        self.app, self.config, self.sign_in = app, config, sign_in
        self._turns, self._strangers = RequestLimiter(), RequestLimiter()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Check, then pass on; answers get the security headers on their way out."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        headers: dict[str, list[str]] = {}
        for name, value in scope["headers"]:
            headers.setdefault(name.decode("latin-1").lower(), []).append(value.decode("latin-1"))
        path = scope["path"]
        refusal = self._stranger(headers)
        arrival = None if refusal else self._arrival(scope, headers)
        refusal = refusal or (None if arrival else self._unknown(scope, headers))
        if refusal is not None:
            await self._turn_away(scope, send, headers, *refusal)
        elif arrival is not None:
            await send_whole(send, *arrival)
        elif path in AT_ONCE or scope["type"] == "websocket" or await self._turns.take():
            await self._enter(scope, receive, secured(send, path), headers)
        else:
            await refuse(scope, send, 429, "too many requests at once: try again in a while")

    def _stranger(self, headers: dict[str, list[str]]) -> tuple[int, str] | None:
        """Status and why, where Host or Origin are not ours."""
        hosts = headers.get("host", [])
        if not host_allowed(hosts, self.config):
            return 421, "this Host is not served here; use the printed URL"
        if not origin_allowed(headers.get("origin", []), hosts[0], self.config):
            return 403, "this Origin may not speak to the studio"
        return None

    def _unknown(self, scope: Scope, headers: dict[str, list[str]]) -> tuple[int, str] | None:
        """Status and why, where the token is missing."""
        open_to_all = scope["type"] == "http" and scope["path"] in OPEN_PATHS
        if open_to_all or token_allowed(headers, self.config):
            return None
        return 401, "the token is missing or wrong; open the printed URL"

    async def _enter(
        self, scope: Scope, receive: Receive, send: Send, headers: dict[str, list[str]]
    ) -> None:
        """Whoever was let in is answered by the application."""
        await self.app(scope, receive, send)

    async def _turn_away(
        self, scope: Scope, send: Send, headers: dict[str, list[str]], status: int, why: str
    ) -> None:
        await self._strangers.take()
        if status == 401 and _is_browser(scope, headers):
            await send_whole(send, *self._ask(scope))
        else:
            await refuse(scope, send, status, why)

    def _arrival(
        self, scope: Scope, headers: dict[str, list[str]]
    ) -> tuple[int, list[tuple[bytes, bytes]], bytes] | None:
        """`GET /?token=…`: set the cookie and get the token out of the address bar."""
        if not opens_page(scope):
            return None
        token = asked(scope, "token")
        if len(token) != 1 or not _same(token[0].strip(), self.config.token):
            return None
        return arrived(scope, self.config.cookie, self.config.token)

    def _ask(self, scope: Scope) -> tuple[int, list[tuple[bytes, bytes]], bytes]:
        """The page to sign in on, for a person who comes without the token."""
        why = "That token is not the one of this studio." if asked(scope, "token") else ""
        page = self.sign_in.replace("{why}", escape(why)).encode()
        return 401, SIGN_IN_HEADERS, page


def arrived(scope: Scope, cookie: str, token: str) -> tuple[int, list[tuple[bytes, bytes]], bytes]:
    """The answer that sets a cookie, and leads to the same page without what is in its query."""
    said = f"{cookie}={token}; HttpOnly; SameSite=Strict; Path=/"
    if scope.get("scheme") == "https":
        said += "; Secure"
    headers = [(b"location", scope["path"].encode()), (b"set-cookie", said.encode())]
    return 303, [*headers, *security_headers("/")], b""


def asked(scope: Scope, name: str) -> list[str]:
    """What the query says under a name."""
    return parse_qs(scope["query_string"].decode("latin-1")).get(name, [])


def cookies(headers: dict[str, list[str]], name: str) -> list[str]:
    """What cookies of a name say. Not by http.cookies, which refuses a whole header for one odd
    cookie of another program."""
    pairs = [pair.partition("=") for said in headers.get("cookie", []) for pair in said.split(";")]
    return [value.strip() for key, _, value in pairs if key.strip() == name]


def _is_browser(scope: Scope, headers: dict[str, list[str]]) -> bool:
    """A person who opens the page, rather than a program or a part of the page."""
    wants = any("text/html" in value for value in headers.get("accept", []))
    return wants and opens_page(scope)


def opens_page(scope: Scope) -> bool:
    return scope["type"] == "http" and scope["method"] == "GET" and scope["path"] in PAGES


def page_url(config: AccessConfig) -> str:
    """The one URL a user opens."""
    url = f"{config.url}?token={config.token}"
    assert urlsplit(url).port == config.port
    return url
