"""Datagrams are hostile until checked: what is sent arrives as it was, and nothing else does."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.control.controllers import ControllerInput
from studio.link import wire
from studio.link.link import Order
from studio.link.wire import Echo, Head, Refused, Report
from studio.reference.motion import with_velocity
from studio.reference.stances import NEUTRAL
from studio.robot import a1
from studio.sim.world import World

SECRET = b"0123456789abcdef"
STAND = a1.STAND_JOINT_POS
ROBOT = World().state
REFERENCE = replace(
    with_velocity(NEUTRAL["sit"], NEUTRAL["sit"]), base_lin_vel_w=np.array([0.1, -0.2, 0.3])
)
ASKED = ControllerInput(reference=REFERENCE, robot=ROBOT, state="sit", in_transition=True)


def targets(secret=b"", flags=wire.STOP) -> bytes:
    head = Head(kind=wire.TARGETS, session=7, sequence=9, flags=flags)
    given = Order(target=STAND + 0.1, kp=60.0, kd=1.5)
    return wire.order(head, Echo(boot=3, t=1.25), 2, given, "targets", secret)


def references(secret=b"") -> bytes:
    head = Head(kind=wire.REFERENCES, session=7, sequence=9, flags=wire.IN_TRANSITION)
    given = Order(target=STAND, asked=ASKED)
    return wire.order(head, Echo(boot=3, t=1.25), 2, given, "references", secret)


def state(secret=b"") -> bytes:
    head = Head(kind=wire.STATE, session=7, sequence=1, flags=wire.SELF_COLLISION)
    report = Report(boot=5, t=2.5, phase="sitting", why="tilt", target=STAND - 0.1, robot=ROBOT)
    return wire.state(head, report, secret)


def read(datagram: bytes, secret=b"") -> Any:
    head, body = wire.opened(datagram, secret)
    return wire.read_state(head, body) if head.kind == wire.STATE else wire.read_order(head, body)


def why(datagram: bytes, secret=b"") -> str:
    with pytest.raises(Refused) as refused:
        read(datagram, secret)
    return refused.value.why


def with_double(datagram: bytes, from_end: int, value: float) -> bytes:
    """One of the numbers at a datagram's end replaced."""
    at = len(datagram) - 8 * from_end
    return datagram[:at] + np.float64(value).tobytes() + datagram[at + 8 :]


@pytest.mark.parametrize("secret", [b"", SECRET])
def test_targets_arrive_as_they_were_sent(secret):
    echo, heard = read(targets(secret), secret)
    assert (echo.boot, echo.t, heard.rise, heard.stop) == (3, 1.25, 2, True)
    assert (heard.level, heard.kp, heard.kd) == ("targets", 60.0, 1.5)
    np.testing.assert_array_equal(heard.target, STAND + 0.1)


@pytest.mark.parametrize("secret", [b"", SECRET])
def test_references_arrive_as_they_were_sent(secret):
    _, heard = read(references(secret), secret)
    assert (heard.level, heard.state, heard.in_transition, heard.stop) == (
        "references", "sit", True, False,
    )  # fmt: skip
    for name in vars(REFERENCE):
        np.testing.assert_array_equal(getattr(heard.reference, name), getattr(REFERENCE, name))


def test_a_state_arrives_as_it_was_sent():
    report = read(state())
    assert (report.boot, report.t, report.phase, report.why) == (5, 2.5, "sitting", "tilt")
    np.testing.assert_array_equal(report.target, STAND - 0.1)
    for name in vars(ROBOT):
        if name not in ("trunk_contact", "self_collision"):
            np.testing.assert_allclose(
                getattr(report.robot, name), getattr(ROBOT, name), atol=1e-15, err_msg=name
            )
    assert (report.robot.trunk_contact, report.robot.self_collision) == (False, True)


@pytest.mark.parametrize("make", [targets, references, state])
def test_each_check_refuses_what_it_is_for(make: Callable[..., bytes]):
    good = make()
    assert why(good[:-1]) == why(good + b"\0") == why(b"") == why(good * 9) == "size"
    assert why(b"A1RX" + good[4:]) == "magic"
    assert why(good[:4] + bytes([wire.VERSION + 1]) + good[5:]) == "version"
    assert why(good[:5] + b"\x63" + good[6:]) == "kind"
    assert why(with_double(good, 3, np.nan)) == why(with_double(good, 3, np.inf)) == "number"
    assert why(with_double(good, 3, 1e9)) == "range"


def test_a_quaternion_that_is_no_rotation_and_unknown_words_are_out_of_range():
    # 41 numbers: 3 of the place, then the quaternion.
    assert why(with_double(references(), 41 - 3, 5.0)) == "range"
    expert_at = wire._HEAD.size + wire._ECHO.size - 4
    bad = references()
    assert why(bad[:expert_at] + b"\x09" + bad[expert_at + 1 :]) == "range"
    phase_at = wire._HEAD.size + 16
    bad = state()
    assert why(bad[:phase_at] + b"\x63" + bad[phase_at + 1 :]) == "range"


def test_with_a_secret_a_changed_bit_anywhere_is_refused():
    good = targets(SECRET)
    assert read(good, SECRET)
    for at in range(wire._HEAD.size, len(good)):
        assert why(good[:at] + bytes([good[at] ^ 1]) + good[at + 1 :], SECRET) == "tag"
    assert why(good, b"another secret, 24 bytes") == "tag"
    assert why(targets(), SECRET) == "size"  # none at all
    assert why(good) == "size"


def test_a_state_is_no_order_and_an_order_no_state():
    head, body = wire.opened(state(), b"")
    with pytest.raises(Refused, match="kind"):
        wire.read_order(head, body)
    head, body = wire.opened(targets(), b"")
    with pytest.raises(Refused, match="kind"):
        wire.read_state(head, body)


@settings(max_examples=300, deadline=None)
@given(st.sampled_from([targets(), references(), state()]), st.data())
def test_nothing_but_refused_comes_of_any_bytes(good: bytes, data: st.DataObject):
    at = data.draw(st.integers(0, len(good)))
    noise = data.draw(st.binary(max_size=700))
    with suppress(Refused):
        read(good[:at] + noise)
