"""No client keeps the others waiting: not by sending without pause, nor by saying nothing."""

import asyncio
import contextlib
import json
import resource
import socket
import struct
import threading
import time

import pytest
from fake_clock import FakeClock
from websockets.exceptions import ConnectionClosed, InvalidStatus

from studio.web import client_limits, sockets
from studio.web.client_limits import LimitedHttp, RequestLimiter, TokenBucket

TOKEN = "test-token-0123456789"
BEAT = b'{"type":"beat"}'


def masked(opcode: int, payload: bytes, *, last: bool = True) -> bytes:
    """A client's frame of RFC 6455 with a mask of zeros."""
    assert len(payload) < 126
    return (
        struct.pack("!BB", (0x80 if last else 0) | opcode, 0x80 | len(payload)) + bytes(4) + payload
    )


# What is counted ----------------------------------------------------------------------------------


def test_a_budget_gives_a_burst_at_once_and_then_its_rate():
    clock = FakeClock()
    budget = TokenBucket(10.0, 3.0, clock.now)
    assert [budget.spend(1.0) for _ in range(3)] == [0.0, 0.0, 0.0]
    assert budget.spend(1.0) == pytest.approx(0.1)  # nothing left: the next comes in 1/10 s
    assert budget.spend(1.0) == pytest.approx(0.2)
    clock.advance(0.2)
    assert budget.spend(1.0) == pytest.approx(0.1)
    clock.advance(60.0)
    assert [budget.spend(1.0) for _ in range(3)] == [0.0, 0.0, 0.0]  # no more than the burst
    assert budget.spend(1.0) > 0.0


def test_who_would_wait_too_long_is_told_and_takes_nothing():
    clock = FakeClock()
    budget = TokenBucket(10.0, 1.0, clock.now)
    waits = [budget.spend(1.0, 0.25) for _ in range(100)]
    assert waits[:3] == [0.0, pytest.approx(0.1), pytest.approx(0.2)]
    assert set(waits[3:]) == {float("inf")}
    clock.advance(0.1)
    assert budget.spend(1.0, 0.25) == pytest.approx(0.2)


# Floods -------------------------------------------------------------------------------------------


@contextlib.contextmanager
def flooded(studio, path, frame, count):
    """A client that has sent `count` frames, or is held up while it does."""
    with studio.ws(path) as ws:
        gone = threading.Event()

        def send():
            with contextlib.suppress(OSError):
                for _ in range(count // 1000):
                    ws.socket.sendall(frame * 1000)
                    if gone.is_set():
                        return

        sender = threading.Thread(target=send, daemon=True)
        sender.start()
        time.sleep(0.2)  # its queue fills
        try:
            yield ws
        finally:
            gone.set()
            ws.socket.shutdown(socket.SHUT_RDWR)
            sender.join(20.0)


def stop_by_socket(studio, number) -> dict:
    """The acknowledgement of another page's stop."""
    with studio.ws("/api/control") as ws:
        ws.send(json.dumps({"type": "stop", "number": number}))
        while True:
            message = json.loads(ws.recv(timeout=20))
            if message["type"] == "stopped":
                return message


def test_a_stop_is_answered_before_what_a_flood_has_sent(studio_live, monkeypatch):
    """Of the flood's 30,000 messages it waits for hundreds, at their rate, and not for all."""
    handled, page_message = [], sockets.page_message

    def counted(said):
        handled.append(said)
        return page_message(said)

    monkeypatch.setattr(sockets, "page_message", counted)
    with flooded(studio_live, "/api/control", masked(0x1, BEAT), 30_000):
        before = len(handled)
        assert stop_by_socket(studio_live, 7)["number"] == 7
        assert before > 0
        assert len(handled) - before < 2000
        before = len(handled)
        assert studio_live.client.post("/api/stop").json()["stopped"] is True
        assert len(handled) - before < 2000


@pytest.mark.parametrize(
    ("path", "frame"),
    [
        ("/api/human", masked(0x1, b"{")),
        ("/api/human", masked(0x1, b"")),
        ("/api/human", masked(0x2, b"\xff")),
        ("/api/ticks", masked(0x9, b"")),
        ("/api/ticks", masked(0x1, b"x")),
    ],
)
def test_whatever_floods_a_stop_and_the_ticks_arrive(studio_live, path, frame):
    with flooded(studio_live, path, frame, 20_000), studio_live.ws("/api/ticks") as ticks:
        assert stop_by_socket(studio_live, 1)["ok"]
        assert studio_live.client.post("/api/stop").status_code == 200
        first = json.loads(ticks.recv(timeout=20))["index"]
        assert json.loads(ticks.recv(timeout=20))["index"] > first


def test_a_message_in_pieces_without_end_closes_its_socket_and_no_other(studio_live):
    with studio_live.ws("/api/control") as other, studio_live.ws("/api/human") as ws:
        raw = ws.socket
        with contextlib.suppress(OSError):  # closed in the midst of it
            raw.sendall(masked(0x1, b"", last=False))
            for _ in range(50):
                raw.sendall(masked(0x0, b"", last=False) * 100)
        with pytest.raises(ConnectionClosed):
            ws.recv(timeout=30)
        assert json.loads(other.recv(timeout=20))["type"] == "state"


def test_requests_take_turns_and_those_that_would_wait_too_long_are_told():
    async def all_at_once(turns, count):
        return await asyncio.gather(*(turns.take() for _ in range(count)))

    # Two at once, two more within the two seconds of patience.
    taken = asyncio.run(all_at_once(RequestLimiter(rate=1.0, burst=2.0), 8))
    assert taken == [True] * 4 + [False] * 4


def test_a_stop_takes_no_turn(studio_live, monkeypatch):
    async def none_left(_):
        return False

    monkeypatch.setattr(RequestLimiter, "take", none_left)
    assert studio_live.client.get("/api/state").status_code == 429
    assert studio_live.client.post("/api/stop").json()["stopped"] is True


# Connections --------------------------------------------------------------------------------------


def half_open(studio) -> socket.socket:
    """A connection that has begun a request."""
    raw = socket.create_connection(("127.0.0.1", studio.port), timeout=20.0)
    raw.sendall(f"POST /api/stop HTTP/1.1\r\nHost: 127.0.0.1:{studio.port}\r\n".encode())
    return raw


def is_closed(raw: socket.socket) -> bool:
    """The server lets go of it (within the socket's 20 s)."""
    try:
        while raw.recv(4096):
            pass
    except ConnectionResetError:
        return True
    except TimeoutError:
        return False
    return True


def test_half_open_requests_leave_room_for_a_stop(studio_live, monkeypatch):
    monkeypatch.setattr(LimitedHttp, "most", 40)
    with contextlib.ExitStack() as opened, studio_live.ws("/api/control") as page:
        idle = [opened.enter_context(half_open(studio_live)) for _ in range(120)]
        assert studio_live.client.post("/api/stop").json()["stopped"] is True
        assert all(is_closed(raw) for raw in idle[:60])  # the oldest went
        assert json.loads(page.recv(timeout=20))["type"] == "state"  # and no page


def test_a_request_that_is_not_told_in_time_is_dropped(studio_live, monkeypatch):
    monkeypatch.setattr(client_limits, "HEAD_S", 0.2)
    monkeypatch.setattr(client_limits, "CHECK_S", 0.05)
    with half_open(studio_live) as raw:
        assert is_closed(raw)


def test_a_body_that_stops_coming_is_dropped_and_one_that_comes_slowly_is_not(
    studio_live, monkeypatch
):
    monkeypatch.setattr(client_limits, "BODY_S", 1.0)
    monkeypatch.setattr(client_limits, "CHECK_S", 0.05)
    head = (
        f"POST /api/files?name=x.bvh HTTP/1.1\r\nHost: 127.0.0.1:{studio_live.port}\r\n"
        f"Authorization: Bearer {TOKEN}\r\nContent-Length: 8\r\n\r\n"
    ).encode()
    with socket.create_connection(("127.0.0.1", studio_live.port), timeout=20.0) as raw:
        raw.sendall(head + b"HIER")
        assert is_closed(raw)
    with socket.create_connection(("127.0.0.1", studio_live.port), timeout=20.0) as raw:
        raw.sendall(head)
        for letter in b"HIERARCH":
            time.sleep(0.25)  # 2 s in all, and never silent for one
            raw.sendall(bytes([letter]))
        assert raw.recv(4096).startswith(b"HTTP/1.1 422")


def test_sockets_leave_a_third_of_the_connections_to_requests(studio_live, monkeypatch):
    monkeypatch.setattr(LimitedHttp, "most", 30)
    with contextlib.ExitStack() as opened:
        listen = lambda: opened.enter_context(studio_live.ws("/api/ticks"))  # noqa: E731
        with pytest.raises(InvalidStatus) as refused:
            any(listen() is None for _ in range(40))
        assert refused.value.response.status_code == 503
        assert studio_live.client.post("/api/stop").status_code == 200


def test_the_connections_fit_the_systems_limit_on_descriptors(monkeypatch):
    set_to = []
    monkeypatch.setattr(resource, "setrlimit", lambda _, limits: set_to.append(limits))
    for soft, hard, most in ((1024, 1024, 384), (256, 256, 54), (64, 64, 16)):
        monkeypatch.setattr(resource, "getrlimit", lambda _, limits=(soft, hard): limits)
        assert client_limits.room_for_connections() == most
    assert set_to == []
    monkeypatch.setattr(resource, "getrlimit", lambda _: (256, 1_000_000))
    assert client_limits.room_for_connections() == 384
    assert set_to == [(4096, 1_000_000)]
