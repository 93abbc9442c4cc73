"""Whatever was sent before or beside a stop: once the stop is answered, the robot is stopped."""

import threading

import pytest
from fake_clock import FakeClock
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from studio.live import commands as c
from studio.live.loop import LiveLoop, _Request
from studio.live.runtime import Runtime, RuntimeConfig

RELEASES = (c.Reset(), c.Arm())
OTHERS = (c.SetMode(mode="live"), c.SetStateLock(state="stand"), c.Disarm())


@pytest.fixture(scope="module")
def loop(tmp_path_factory):
    config = RuntimeConfig(sessions=tmp_path_factory.mktemp("s") / "sessions")
    return LiveLoop(clock=FakeClock(), runtime=Runtime(config))


class Client:
    """Sends as the gateway does: stamped when it is sent, put into the queue a while later."""

    def __init__(self, loop):
        self.loop, self.late, self.sent = loop, [], []

    def send(self, command, *, late=False):
        request = _Request(command=command, seen=self.loop.stops)
        self.sent.append(request)
        self.late.append(request) if late else self.arrive(request)

    def arrive(self, request):
        queue = self.loop._stops if isinstance(request.command, c.Stop) else self.loop._requests
        assert queue.put(request)

    def arrive_all(self):
        while self.late:
            self.arrive(self.late.pop(0))


STEP = st.one_of(
    st.tuples(st.sampled_from((*RELEASES, *OTHERS, c.Stop())), st.booleans()), st.just("tick")
)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(steps=st.lists(STEP, max_size=12), after=st.permutations(RELEASES * 2))
def test_an_answered_stop_holds_against_all_that_was_sent_before_it(loop, steps, after):
    client = Client(loop)
    for step in steps:
        if step == "tick":
            loop.tick()
        else:
            client.send(step[0], late=step[1])
    client.send(c.Stop())
    for command in after:  # beside it: sent before its answer, some late
        client.send(command, late=command is after[0])
    loop.tick()
    stop = next(r for r in reversed(client.sent) if isinstance(r.command, c.Stop))
    assert stop.done.is_set()
    assert stop.result.ok
    assert stop.result.data["stop"] == loop.runtime.safety.stops
    for _ in range(3):
        client.arrive_all()
        loop.tick()
        state = loop.state_dict()
        assert (state["stopped"], state["needs_reset"], state["armed"]) == (True, True, False)
    refused = [r for r in client.sent if r.done.is_set() and not r.result.ok]
    assert all(r.result.why for r in refused)
    # What is sent after the answer releases it.
    client.send(c.Reset())
    client.send(c.Arm())
    loop.tick()
    assert not loop.state_dict()["stopped"]


def test_reset_arm_and_stop_within_one_period_leave_the_robot_stopped(loop):
    """As three requests on their way together, in every order that they may arrive in."""
    for order in ((0, 1, 2), (0, 2, 1), (2, 0, 1), (2, 1, 0), (1, 2, 0), (1, 0, 2)):
        commands = [(c.Reset(), c.Arm(), c.Stop())[i] for i in order]
        threads = []
        for command in commands:
            waiting = len(loop._requests) + len(loop._stops)
            threads.append(threading.Thread(target=loop.submit, args=(command, 20.0)))
            threads[-1].start()
            while len(loop._requests) + len(loop._stops) == waiting:
                pass
        loop.tick()
        assert loop.state_dict()["stopped"], order
        for thread in threads:
            thread.join()


def test_a_release_sent_before_a_fall_does_not_lift_the_fallen_robot(loop):
    loop.runtime.safety.reset()
    loop.runtime.safety.arm(loop.clock.now())
    client = Client(loop)
    loop.tick()
    client.send(c.Reset(), late=True)
    client.send(c.Arm(), late=True)
    loop.runtime.safety.fall(loop.clock.now(), demo=False)
    loop.tick()
    client.arrive_all()
    loop.tick()
    assert loop.state_dict()["needs_reset"]


def test_a_stopped_robot_that_tips_over_is_no_second_stop_but_a_press_or_a_fault_is(loop):
    safety = loop.runtime.safety
    safety.stop("emergency stop by a test")
    known = safety.stops
    safety.fall(loop.clock.now(), demo=False)
    assert safety.stops == known
    safety.stop("emergency stop by a test")
    assert safety.stops == known + 1
    safety.stop("a fault: of a test", "fault")
    assert safety.stops == known + 2
    safety.reset()
    safety.fall(loop.clock.now(), demo=False)  # what a reset had lifted is down again
    assert safety.stops == known + 3
