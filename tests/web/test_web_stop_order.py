"""Whatever order things were sent in: after a stop's answer the robot is stopped."""

import contextlib
import itertools
import select
import socket
import struct

import pytest
from fake_clock import FakeClock
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from studio.live import commands as c
from studio.live.loop import LiveLoop, _Request
from studio.live.runtime import Runtime, RuntimeConfig
from studio.web.stop_order import StopOrder

TOKEN = "test-token-0123456789"


@pytest.fixture(scope="module")
def loop(tmp_path_factory):
    config = RuntimeConfig(sessions=tmp_path_factory.mktemp("s") / "sessions")
    return LiveLoop(clock=FakeClock(), runtime=Runtime(config))


class House:
    """A loop and its door, where every step on a command's way is taken when the test says so."""

    def __init__(self, loop):
        self.loop, self.order = loop, StopOrder(lambda: loop.stops)
        self.on_their_way, self.stops, self.held = [], [], False

    def receive(self, command, *, at_once):
        """A request was read. at_once: no pool and no lock keeps it from the loop's queue."""
        request = _Request(command=command, seen=self.order.known())
        if isinstance(command, c.Stop):
            under_way = self.order.under_way()
            self.stops.append((request, under_way, under_way.__enter__()))
        else:
            self.held = False  # received after the answers that left so far: it may undo those
        self.on_their_way.append(request)
        if at_once:
            self.deliver(len(self.on_their_way) - 1)

    def deliver(self, k):
        """Into the loop's queue."""
        if self.on_their_way:
            request = self.on_their_way.pop(k % len(self.on_their_way))
            stop = isinstance(request.command, c.Stop)
            assert (self.loop._stops if stop else self.loop._requests).put(request)

    def answer(self, k):
        """A stop's answer is written, if the loop has applied it."""
        applied = [stop for stop in self.stops if stop[0].done.is_set()]
        if applied:
            stop = applied[k % len(applied)]
            self.stops.remove(stop)
            stop[2]()
            stop[1].__exit__(None, None, None)
            self.held = True

    def check(self):
        safety = self.loop.runtime.safety
        if self.held:
            assert (safety.stopped, safety.needs_reset, safety.armed) == (True, True, False)


WHICH = st.integers(0, 3)
STEP = st.one_of(
    st.tuples(
        st.just("receive"),
        st.sampled_from((c.Stop(), c.Reset(), c.Reset(), c.Arm())),
        st.sampled_from((True, True, False)),
    ),
    st.tuples(st.just("deliver"), WHICH),
    st.tuples(st.just("answer"), WHICH),
    st.sampled_from((("tick",), ("between ticks",))),
)
IN_MID_PERIOD = [
    ("receive", c.Stop(), True),
    ("between ticks",),
    ("receive", c.Reset(), True),
    ("receive", c.Arm(), True),
    ("tick",),
    ("answer", 0),
]
"""Applied, and its answer not yet written, when the others are received."""


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(steps=st.lists(STEP, min_size=6, max_size=30))
@example(steps=IN_MID_PERIOD)
def test_an_answered_stop_holds_against_all_that_was_received_before_its_answer_left(loop, steps):
    house = House(loop)
    for what, *more in steps:
        if what == "receive":
            house.receive(more[0], at_once=more[1])
        elif what in ("deliver", "answer"):
            getattr(house, what)(*more)
        else:
            loop.tick() if what == "tick" else loop._stop_now()
        house.check()
    while house.on_their_way or house.stops:
        house.deliver(0)
        loop.tick()
        house.answer(0)
        house.check()
    # What is received after every answer has left frees the robot.
    for command in (c.Reset(), c.Arm()):
        house.receive(command, at_once=True)
    loop.tick()
    assert not loop.state_dict()["stopped"]


def test_whoever_asked_for_a_stop_and_left_holds_back_no_release():
    order = StopOrder(lambda: 7)
    under_way = order.under_way()
    under_way.__enter__()
    assert len(order._under_way) == 1
    with pytest.raises(ConnectionError):
        under_way.gen.throw(ConnectionError())
    assert order._under_way == []


def test_what_lies_unread_when_an_answer_leaves_had_been_received_before():
    class Connection:
        before = None

        def received_before(self, stops):
            self.before = stops

    order, read, unread = StopOrder(lambda: 7), Connection(), Connection()
    pairs = socket.socketpair(), socket.socketpair()
    with contextlib.ExitStack() as stack:
        for (ours, theirs), connection in zip(pairs, (read, unread), strict=True):
            stack.enter_context(ours)
            stack.enter_context(theirs)
            order.add(ours.fileno(), connection)
        with order.under_way() as leaves:
            order._answered = lambda: 8  # the loop has applied it
            pairs[1][1].sendall(b"POST /api/reset")
            leaves()
        order.remove(pairs[0][0].fileno())
    assert (read.before, unread.before) == (None, 7)
    assert order.known() == 8


# Through a server ---------------------------------------------------------------------------------


class Line:
    """A connection with nothing between us and the system's buffers."""

    def __init__(self, port):
        self.port, self.got = port, b""
        self.raw = socket.create_connection(("127.0.0.1", port), timeout=30.0)
        self.raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def request(self, method, path, more=""):
        self.got = b""
        self.raw.sendall(
            f"{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n"
            f"Authorization: Bearer {TOKEN}\r\n{more}\r\n".encode()
        )

    def command(self, name):
        self.request("POST", f"/api/{name}", "Content-Length: 0\r\n")

    def read_until(self, end):
        while end not in self.got:
            assert select.select([self.raw], [], [], 30.0)[0], self.got
            self.got += self.raw.recv(65_536)

    def answer(self):
        """A status; what follows that answer is kept."""
        self.read_until(b"\r\n\r\n")
        head, _, self.got = self.got.partition(b"\r\n\r\n")
        length = int(head.lower().split(b"content-length:")[1].split()[0])
        while len(self.got) < length:
            self.got += self.raw.recv(65_536)
        self.got = self.got[length:]
        return int(head.split(b" ", 2)[1])

    def arrived(self, what):
        """Whether `what` lies here already."""
        while select.select([self.raw], [], [], 0)[0]:
            self.got += self.raw.recv(65_536)
        return what in self.got


class StopByRequest(Line):
    answered = b"HTTP/1.1 200"

    def stop(self):
        self.command("stop")

    def stopped(self):
        assert self.answer() == 200


class StopBySocket(Line):
    answered = b'"stopped", "number"'

    def __init__(self, port):
        super().__init__(port)
        self.request(
            "GET", "/api/control",
            "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n",
        )  # fmt: skip
        self.read_until(b"101 Switching Protocols")

    def stopped(self):
        self.read_until(self.answered)

    def stop(self):
        self.got = b""
        said = b'{"type": "stop"}'
        self.raw.sendall(struct.pack("!BB", 0x81, 0x80 | len(said)) + bytes(4) + said)


@pytest.mark.parametrize("way", [StopByRequest, StopBySocket])
@pytest.mark.parametrize("fresh", [False, True], ids=["kept connections", "new connections"])
def test_stop_reset_and_arm_by_three_connections_end_stopped(studio_live, way, fresh):
    """Those tries count in which the stop's answer was not there yet when all had been sent."""
    orders = itertools.cycle(itertools.permutations(("stop", "reset", "arm")))
    lines, counted = {}, 0
    for order in itertools.islice(orders, 200):
        if fresh or not lines:
            for line in lines.values():
                line.raw.close()
            make = {"stop": way, "reset": Line, "arm": Line}
            lines = {name: make[name](studio_live.port) for name in order}
        for name in order:
            lines[name].stop() if name == "stop" else lines[name].command(name)
        counts = not lines["stop"].arrived(way.answered)
        lines["stop"].stopped()
        answers = {name: lines[name].answer() for name in ("reset", "arm")}
        if counts:
            counted += 1
            state = studio_live.state()
            latched = (state["stopped"], state["needs_reset"], state["armed"])
            assert latched == (True, True, False), (order, answers)
        if counted == 18:
            break
    assert counted >= 12
    for line in lines.values():
        line.raw.close()
    assert studio_live.client.post("/api/reset").status_code == 200
    assert studio_live.client.post("/api/arm").json()["stopped"] is False


def test_a_release_is_refused_with_what_to_do(studio_live, monkeypatch):
    monkeypatch.setattr(StopOrder, "known", lambda self: 0)
    assert studio_live.client.post("/api/stop").status_code == 200
    answer = studio_live.client.post("/api/reset")
    assert answer.status_code == 409
    assert "send it again" in answer.json()["why"]


def test_what_is_pipelined_behind_a_stop_was_sent_before_its_answer(studio_live):
    line = Line(studio_live.port)
    head = f"Host: 127.0.0.1:{studio_live.port}\r\nAuthorization: Bearer {TOKEN}\r\n"
    line.raw.sendall(
        b"".join(
            f"POST /api/{name} HTTP/1.1\r\n{head}Content-Length: 0\r\n\r\n".encode()
            for name in ("stop", "reset", "arm")
        )
    )
    assert [line.answer() for _ in range(3)] == [200, 409, 409]
    assert studio_live.state()["needs_reset"] is True
    line.command("reset")  # and on the same connection afterwards it is free again
    assert line.answer() == 200
    line.raw.close()
