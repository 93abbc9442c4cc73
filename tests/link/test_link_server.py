"""The robot's end believes only who drives, in order and in time; anybody may stop it."""

import numpy as np
import pytest

from studio.control.controllers import ControllerInput, PdPlayback
from studio.link import wire
from studio.link.engine import CROUCH, MotorCommand, MujocoEngine
from studio.link.link import Level, Order
from studio.link.robot_policy import RobotPolicy
from studio.link.robot_server import FREE_AFTER, MAX_AGE, RobotServer
from studio.link.robot_side import TO_CROUCH, TO_STAND, RobotSide
from studio.link.wire import Echo, Head
from studio.reference.motion import with_velocity
from studio.reference.stances import NEUTRAL
from studio.robot import a1
from studio.robot.pose import RobotPose

HERE, THERE = ("127.0.0.1", 1), ("127.0.0.1", 2)
STAND = a1.STAND_JOINT_POS
STANDING = with_velocity(NEUTRAL["stand"], NEUTRAL["stand"])


class Driver:
    """One who drives a server, on a clock turned by hand."""

    def __init__(self, server: RobotServer, session: int, address=HERE, level: Level = "targets"):
        self.server, self.session, self.address = server, session, address
        self.level: Level = level
        self.sequence, self.rise = 0, 0
        self.boot, self.t = 0, 0.0

    def greet(self, now: float) -> wire.Report:
        answer = self.server.hear(
            wire.hello(Head(kind=wire.HELLO, session=self.session, sequence=0), b""),
            self.address, now,
        )  # fmt: skip
        assert answer is not None
        report = wire.read_state(*wire.opened(answer, b""))
        self.boot, self.t = report.boot, report.t
        return report

    def order(self, *, stop=False) -> bytes:
        self.sequence += 1
        kind = wire.TARGETS if self.level == "targets" else wire.REFERENCES
        head = Head(kind=kind, session=self.session, sequence=self.sequence, flags=int(stop))
        robot = self.server.engine.state()
        asked = ControllerInput(reference=STANDING, robot=robot, state="stand")
        given = Order(target=STAND, asked=asked)
        return wire.order(head, Echo(boot=self.boot, t=self.t), self.rise, given, self.level, b"")

    def say(self, now: float, **said) -> None:
        self.server.hear(self.order(**said), self.address, now)


@pytest.fixture
def server() -> RobotServer:
    engine = MujocoEngine()
    return RobotServer(engine, RobotSide(engine.dt, RobotPolicy(PdPlayback())))


def run(server: RobotServer, driver: Driver, seconds: float, now: float) -> float:
    """Orders at 30 Hz, each answering the newest state."""
    for k in range(round(seconds / server.engine.dt)):
        if k % 8 == 0:
            driver.say(now)
        sent = server.step(now)
        assert sent is not None
        assert sent[1] == driver.address
        report = wire.read_state(*wire.opened(sent[0], b""))
        driver.boot, driver.t = report.boot, report.t
        now += server.engine.dt
    return now


@pytest.mark.parametrize("level", ["targets", "references"])
def test_it_rises_and_follows_and_says_so(server: RobotServer, level: Level):
    driver = Driver(server, 1, level=level)
    assert driver.greet(0.0).phase == "limp"
    assert server.step(0.0) is None  # nobody drives yet
    driver.rise = 1
    run(server, driver, TO_CROUCH + TO_STAND + 0.5, 0.01)
    assert server.side.phase == "following"
    assert server.engine.state().base_pos[2] == pytest.approx(a1.STAND_HEIGHT, abs=0.02)


def test_orders_out_of_order_twice_or_late_are_refused_and_counted(server: RobotServer):
    driver = Driver(server, 1)
    driver.greet(0.0)
    first, second = driver.order(), driver.order()
    server.hear(second, HERE, 0.1)
    server.hear(first, HERE, 0.1)
    server.hear(second, HERE, 0.1)
    assert server.counts == {"hello": 1, "heard": 1, "old": 2}
    driver.say(MAX_AGE + 0.05)  # it answers the state of 0 s
    assert server.counts["late"] == 1
    driver.t = 50.0
    driver.say(MAX_AGE + 0.1)  # a state that is yet to come
    assert server.counts["late"] == 2


def test_an_order_for_a_process_that_is_gone_is_refused(server: RobotServer):
    driver = Driver(server, 1)
    driver.greet(0.0)
    driver.boot += 1
    driver.say(0.1)
    assert server.counts["late"] == 1


def test_one_drives_at_a_time_and_another_may_once_the_line_is_silent(server: RobotServer):
    one, other = Driver(server, 1), Driver(server, 2, THERE)
    one.greet(0.0)
    other.greet(0.05)
    one.say(0.1)
    other.say(0.2)
    assert server.counts["driver"] == 1
    one.say(0.3)
    other.greet(0.3)
    other.say(0.3 + FREE_AFTER)
    assert server.counts["driver"] == 2
    other.greet(0.4 + FREE_AFTER)
    other.say(0.4 + FREE_AFTER)
    assert server.counts["heard"] == 3
    one.greet(0.5 + FREE_AFTER)
    one.say(0.6 + FREE_AFTER)
    assert server.counts["driver"] == 3


def test_anybody_may_stop_it_however_late(server: RobotServer):
    driver, other = Driver(server, 1), Driver(server, 2, THERE)
    driver.greet(0.0)
    driver.rise = 1
    now = run(server, driver, TO_CROUCH + TO_STAND + 0.5, 0.0)
    assert server.side.phase == "following"
    other.say(now, stop=True)
    assert (server.side.phase, server.side.why) == ("limp", "asked to")
    run(server, driver, 0.5, now)
    assert server.side.phase == "limp"


def test_a_stop_that_was_overtaken_by_a_later_order_is_void(server: RobotServer):
    driver = Driver(server, 1)
    driver.greet(0.0)
    stop = driver.order(stop=True)
    driver.rise = 1
    now = run(server, driver, 0.5, 0.0)
    assert server.side.phase == "rising"
    server.hear(stop, HERE, now)
    assert server.side.phase == "rising"


def test_who_takes_over_has_asked_for_nothing(server: RobotServer):
    one, other = Driver(server, 1), Driver(server, 2, THERE)
    one.greet(0.0)
    one.rise = 3
    now = run(server, one, 0.1, 0.0)
    server.side.stop("asked to")
    other.greet(now + 2.0)
    run(server, other, 0.5, now + 2.0)
    assert server.side.phase == "limp"
    other.rise = 1
    run(server, other, 0.5, now + 2.5)
    assert server.side.phase == "rising"


def test_hellos_are_not_answered_by_a_flood(server: RobotServer):
    hello = wire.hello(Head(kind=wire.HELLO, session=1, sequence=0), b"")
    answers = [server.hear(hello, THERE, 1e-4 * k) for k in range(1000)]
    assert sum(answer is not None for answer in answers) <= 6


def test_noise_is_counted_and_moves_nothing(server: RobotServer):
    rng = np.random.default_rng(0)
    for size in (0, 1, 20, 36, 168, 700):
        assert server.hear(rng.bytes(size), THERE, 0.0) is None
    server.step(0.0)
    assert sum(server.counts.values()) == 6
    assert server.side.phase == "limp"


def test_a_robot_on_its_side_is_set_onto_its_belly_when_it_is_asked_to_rise(server: RobotServer):
    server.engine.place(RobotPose(base_pos=np.zeros(3), base_quat=np.array([0.7071, 0.7071, 0, 0]),
                                  joint_pos=CROUCH, foot_contact=np.ones(4)))  # fmt: skip
    for _ in range(240):
        server.engine.step(MotorCommand(target=CROUCH, kp=0.0, kd=4.0))
    driver = Driver(server, 1)
    driver.greet(0.0)
    driver.rise = 1
    run(server, driver, TO_CROUCH + TO_STAND + 0.5, 0.0)
    assert server.side.phase == "following"
