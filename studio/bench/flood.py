"""A client that sends as fast as it can, in a process of its own: what `bench.stop` measures under.

python -m studio.bench.flood KIND PORT TOKEN
"""

import json
import socket
import struct
import sys
import threading
import time
import urllib.request
from collections.abc import Callable
from pathlib import Path

import msgspec

from studio.evaluation.served import VIEW, page_socket

TEXT, BINARY, PING = 0x1, 0x2, 0x9
REQUESTS = 8
"""Connections that ask for the state at once."""


def masked(opcode: int, payload: bytes) -> bytes:
    """One frame of a client (RFC 6455 5.2), masked by zeros, which leave the payload as it is."""
    size = len(payload)
    if size < 126:
        head = struct.pack("!BB", 0x80 | opcode, 0x80 | size)
    else:
        head = struct.pack("!BBH", 0x80 | opcode, 0x80 | 126, size)
    return head + bytes(4) + payload


def camera() -> bytes:
    """A camera as viser's client tells it."""
    return msgspec.msgpack.encode(
        {
            "type": "ViewerCameraMessage", "wxyz": [1.0, 0, 0, 0], "position": [1.0, 2, 3],
            "fov": 0.5, "near": 0.01, "far": 100.0, "image_height": 400, "image_width": 600,
            "look_at": [0.0, 0, 0], "up_direction": [0.0, 0, 1],
        }
    )  # fmt: skip


SOCKETS: dict[str, tuple[str, bytes]] = {
    "bad frames": ("/api/human", masked(TEXT, b"{")),
    "empty frames": ("/api/human", masked(TEXT, b"")),
    "beats": ("/api/control", masked(TEXT, json.dumps({"type": "beat", "sent": 1.0}).encode())),
    "cameras": (VIEW, masked(BINARY, camera())),
    "pings": ("/api/ticks", masked(PING, b"")),
}
"""Floods of one socket: its path, and the frame that is sent again and again."""
KINDS = (*SOCKETS, "requests", "stops", "half-open")


def flood(kind: str, port: int, token: str) -> None:
    """Until killed."""
    if kind in SOCKETS:
        flood_socket(port, token, *SOCKETS[kind])
    elif kind == "half-open":
        half_open(port)
    else:
        path, method = ("/api/stop", "POST") if kind == "stops" else ("/api/state", "GET")
        in_threads([lambda: ask_forever(port, token, path, method)] * REQUESTS)


def flood_socket(port: int, token: str, path: str, frame: bytes) -> None:
    """One WebSocket; what is answered is read and forgotten."""
    with page_socket(port, token, path, max_queue=None) as ws:
        threading.Thread(target=lambda: [None for _ in ws], daemon=True).start()
        many = frame * max(1, 65_536 // len(frame))
        while True:
            ws.socket.sendall(many)


def ask_forever(port: int, token: str, path: str, method: str) -> None:
    """One request after another on one connection."""
    request = (
        f"{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nAuthorization: Bearer {token}\r\n"
        "Content-Length: 0\r\n\r\n"
    ).encode()
    while True:
        with socket.create_connection(("127.0.0.1", port)) as raw:
            while True:
                raw.sendall(request)
                if not raw.recv(65_536):
                    break


def half_open(port: int, count: int = 500) -> None:
    """Connections that begin a request and never end it, made anew when they are closed."""
    open_: list[socket.socket] = []
    while True:
        try:
            raw = socket.create_connection(("127.0.0.1", port), timeout=5.0)
            raw.sendall(b"POST /api/stop HTTP/1.1\r\nHost: 127.0.0.1\r\n")
            open_.append(raw)
        except OSError:
            pass
        if len(open_) >= count:
            time.sleep(0.01)
            open_.pop(0).close()


def in_threads(works: list[Callable[[], None]]) -> None:
    """Each in a thread of its own, until all have ended."""
    threads = [threading.Thread(target=work) for work in works]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def pages(port: int, token: str, count: int) -> None:
    """The sockets of `count` pages, read as a page reads them."""

    def listen(path: str) -> None:
        with page_socket(port, token, path) as ws:
            for _ in ws:
                if path == "/api/control":
                    ws.send('{"type": "beat", "sent": 0}')

    paths = ("/api/control", "/api/ticks", VIEW)
    in_threads([lambda path=path: listen(path) for path in paths for _ in range(count)])


def import_forever(port: int, token: str, file: Path) -> None:
    """Send a motion file to be made a take, again and again."""
    body = (
        b'--x\r\nContent-Disposition: form-data; name="files"; filename="%d.bvh"\r\n\r\n'
        % threading.get_ident()
        + file.read_bytes()
        + b"\r\n--x--\r\n"
    )
    headers = {
        "Authorization": f"Bearer {token}",
        "Content-Type": "multipart/form-data; boundary=x",
    }
    url = f"http://127.0.0.1:{port}/api/takes/import"
    while True:
        request = urllib.request.Request(url, data=body, headers=headers, method="POST")
        with urllib.request.urlopen(request, timeout=600.0) as answer:
            answer.read()


if __name__ == "__main__":
    what, at, proof = sys.argv[1], int(sys.argv[2]), sys.argv[3]
    if what == "pages":
        pages(at, proof, int(sys.argv[4]))
    elif what == "imports":
        in_threads([lambda: import_forever(at, proof, Path(sys.argv[5]))] * int(sys.argv[4]))
    else:
        flood(what, at, proof)
