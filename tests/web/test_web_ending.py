"""Ctrl C ends the studio well, whatever somebody was in the midst of saying."""

import socket
import ssl
import time

import httpx
from served import Served

from studio.web.phone_certificate import FILE

BODY = b"Content-Type: application/json\r\nContent-Length: 15\r\n\r\n"


def begun(host: str, port: int, cookie: str, *, tls: bool = False) -> socket.socket:
    """A request of which half the body is said."""
    raw = socket.create_connection((host, port), timeout=20.0)
    if tls:
        context = ssl.create_default_context()
        context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
        raw = context.wrap_socket(raw)
    head = f"POST /api/mode HTTP/1.1\r\nHost: {host}:{port}\r\n{cookie}\r\n"
    raw.sendall(head.encode() + BODY + b'{"mode"')
    return raw


def test_half_a_request_at_either_door_leaves_nothing_to_say_at_the_end(tmp_path):
    served = Served(tmp_path, "--phone", "127.0.0.1", "--phone-port", "0")
    url = httpx.URL(served.client.get("/api/phone").json()["url"])
    trust = ssl.create_default_context(cafile=str(tmp_path / FILE))
    with httpx.Client(verify=trust, trust_env=False, headers={"Accept": "text/html"}) as phone:
        assert phone.get(url).status_code == 303
        cookie = "; ".join(f"{name}={value}" for name, value in phone.cookies.items())
    with (
        begun("127.0.0.1", served.port, f"Authorization: Bearer {served.token}"),
        begun("127.0.0.1", url.port or 443, f"Cookie: {cookie}", tls=True),
        socket.create_connection(("127.0.0.1", url.port or 443)),  # no TLS at all yet
    ):
        time.sleep(0.3)  # until they are read
        status, said = served.close()
    assert status == 0
    assert "Traceback" not in said
    assert "ERROR" not in said
