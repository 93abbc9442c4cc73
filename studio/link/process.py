"""`a1-studio robot`: a simulated A1 behind the robot's side of the link, by the wall clock."""

import signal
import socket
import sys
import time
from collections.abc import Callable
from contextlib import suppress

from studio.control.controllers import PolicyController
from studio.errors import StudioError
from studio.link import wire
from studio.link.engine import RATES, Engine, MujocoEngine
from studio.link.pybullet_engine import PybulletEngine
from studio.link.robot_policy import RobotPolicy
from studio.link.robot_server import RobotServer
from studio.link.robot_side import RobotSide
from studio.link.udp import checked_exposure, read_secret
from studio.options import RobotConfig

A_STEP = 64
"""Datagrams that are read in a step: more wait, and a flood of them does not stop the motors."""
BEHIND = 0.1
"""s behind its clock from which a robot gives up to catch up."""


def run_robot(config: RobotConfig, announce: Callable[[str], None] | None = None) -> None:
    """Until SIGINT or SIGTERM. announce: given the line that says how to drive it.

    StudioError for an address that cannot be had, or is beyond this machine without a secret, an
    engine that is not installed, or a rate it does not take.
    """
    secret = read_secret(config.secret)
    checked_exposure(config.host, secret)
    engine = open_engine(config.engine, config.rate)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
        try:
            line.bind((config.host, config.port))
        except OSError as error:
            where = f"{config.host}:{config.port}"
            raise StudioError(f"cannot listen on UDP {where}: {error.strerror}") from error
        line.setblocking(False)
        side = RobotSide(engine.dt, RobotPolicy(PolicyController()))
        server = RobotServer(engine, side, secret)
        ends: list[int] = []
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda got, _: ends.append(got))
        host, port = line.getsockname()
        (announce or _say)(
            f"robot ({config.engine}, {1.0 / engine.dt:.0f}/s): --robot udp:{host}:{port}"
        )
        _run(server, line, ends)


def open_engine(name: str, rate: int) -> Engine:
    """StudioError for a rate that it does not take, or where it is not installed."""
    low, high = RATES
    if not low <= rate <= high:
        raise StudioError(f"--rate must be {low} to {high} steps a second, not {rate}")
    if name == "mujoco":
        if rate % 30:
            raise StudioError(f"mujoco takes multiples of 30 steps a second, not {rate}: 240, 480")
        return MujocoEngine(rate=rate)
    return PybulletEngine(rate)


def _run(server: RobotServer, line: socket.socket, ends: list[int]) -> None:
    due = time.monotonic()
    while not ends:
        now = time.monotonic()
        if now < due:
            time.sleep(due - now)
        elif now - due > BEHIND:
            due = now
        due += server.engine.dt
        now = time.monotonic()
        for _ in range(A_STEP):
            try:
                datagram, address = line.recvfrom(wire.LARGEST + 1)
            except OSError:  # none is there, or one that was sent came back
                break
            if answer := server.hear(datagram, address, now):
                _send(line, answer, address)
        if sent := server.step(now):
            _send(line, *sent)


def _send(line: socket.socket, datagram: bytes, address: tuple[str, int]) -> None:
    with suppress(OSError):  # whoever drove is gone: silence is for the watchdog
        line.sendto(datagram, address)


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()
