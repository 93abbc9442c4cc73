"""What every answer carries to keep a page to itself, and how a request is refused."""

import json
from collections.abc import Iterable

from starlette.types import Message, Scope, Send

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
# MediaPipe is WebAssembly, and runs in a worker, whose policy is its own: it may compile what we
# serve, and reach nobody else.
MODEL_CSP = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self'"
MODEL_WORKER = "/assets/js/webcam-worker.js"

# A form and nothing else, for whoever has no token yet; so that it needs no file of ours.
SIGN_IN_CSP = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; form-action 'self'; "
    "base-uri 'none'; frame-ancestors 'none'"
)


def security_headers(path: str) -> list[tuple[bytes, bytes]]:
    """For an answer to `path`."""
    csp = VIEW_CSP if path.startswith("/view/") else PAGE_CSP
    csp = MODEL_CSP if path == MODEL_WORKER else csp
    return [
        (b"content-security-policy", csp.encode()),
        (b"x-content-type-options", b"nosniff"),
        (b"referrer-policy", b"no-referrer"),
        (b"cross-origin-opener-policy", b"same-origin"),
        (b"cross-origin-resource-policy", b"same-origin"),
        (b"cache-control", b"no-store"),
    ]


SIGN_IN_HEADERS = [
    (b"content-type", b"text/html; charset=utf-8"),
    (b"www-authenticate", b"Bearer"),
    (b"content-security-policy", SIGN_IN_CSP.encode()),
    *security_headers("/")[1:],
]


def secured(send: Send, path: str) -> Send:
    """`send`, adding the security headers that an answer does not bring itself."""

    async def wrapped(message: Message) -> None:
        if message["type"] == "http.response.start":
            present = {name.lower() for name, _ in message["headers"]}
            extra = [h for h in security_headers(path) if h[0] not in present]
            message = {**message, "headers": [*message["headers"], *extra]}
        await send(message)

    return wrapped


async def refuse(scope: Scope, send: Send, status: int, why: str) -> None:
    """Answer a request or a WebSocket's handshake with {"error": why}."""
    body = json.dumps({"error": why}).encode()
    headers = [(b"content-type", b"application/json"), *security_headers("/")]
    if status == 401:
        headers.append((b"www-authenticate", b"Bearer"))
    if scope["type"] == "http":
        await send_whole(send, status, headers, body)
    elif "websocket.http.response" in scope.get("extensions", {}):
        await send_whole(send, status, headers, body, prefix="websocket.http")
    else:
        await send({"type": "websocket.close", "code": 1008, "reason": why})


async def send_whole(
    send: Send,
    status: int,
    headers: Iterable[tuple[bytes, bytes]],
    body: bytes,
    prefix: str = "http",
) -> None:
    """An answer of which all is known."""
    headers = [*headers, (b"content-length", str(len(body)).encode())]
    await send({"type": f"{prefix}.response.start", "status": status, "headers": headers})
    await send({"type": f"{prefix}.response.body", "body": body})
