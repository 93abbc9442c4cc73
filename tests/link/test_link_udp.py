"""A robot in a process of its own: driven, killed, started anew; and whoever drives it, killed."""

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from studio.errors import StudioError
from studio.evaluation.behind import stood_up
from studio.evaluation.drive import run_drive
from studio.link.process import run_robot
from studio.link.udp import UdpLink, open_link, read_secret
from studio.options import DriveConfig, RobotConfig
from studio.puppeteer import Puppeteer
from studio.robot import a1

ENVIRONMENT = {**os.environ, "OMP_NUM_THREADS": "1"}


@contextmanager
def robot(*options: str, port: int = 0):
    """`a1-studio robot`, and the port it listens on."""
    process = subprocess.Popen(
        [sys.executable, "-m", "studio", "robot", "--port", str(port), *options],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT,
    )  # fmt: skip
    assert process.stdout is not None
    assert process.stderr is not None
    line = process.stdout.readline()
    assert line, process.stderr.read()
    try:
        yield process, int(line.rsplit(":", 1)[1])
    finally:
        process.kill()
        process.wait()
        process.stdout.close()
        process.stderr.close()


def until(true, seconds=20.0):
    end = time.monotonic() + seconds
    while not (out := true()):
        assert time.monotonic() < end
        time.sleep(0.02)
    return out


def periods(puppeteer: Puppeteer, true, seconds=20.0):
    """Drive until something is so."""
    end = time.monotonic() + seconds
    while not true(tick := puppeteer.step()):
        assert time.monotonic() < end, tick.why
        time.sleep(a1.CONTROL_DT)
    return tick


@pytest.mark.slow
@pytest.mark.parametrize("level", ["targets", "references"])
def test_a_drive_goes_through_a_robot_of_another_process(level):
    with robot() as (_, port):
        config = DriveConfig(
            source="operator:crouch", seconds=4.0, robot=f"udp:127.0.0.1:{port}", robot_level=level
        )
        report = run_drive(config)
    assert report["survived"]
    assert report["frames"] >= 100
    assert report["joint_rmse_deg"] < 15.0
    assert report["base_height_m"][0] < 0.24  # it crouched


@pytest.mark.slow
def test_a_robot_that_is_killed_is_silent_and_one_started_anew_does_not_rise_by_itself():
    with robot() as (process, port):
        link = UdpLink("127.0.0.1", port, "references")
        puppeteer = stood_up(Puppeteer(link=link))
        assert puppeteer.step().why == "nobody seen yet: waiting for the first human pose"
        process.kill()
        process.wait()
        tick = periods(puppeteer, lambda tick: "silent" in tick.why)
        assert puppeteer.reason == "robot"
        assert not tick.fallen
        with robot(port=port):
            tick = periods(puppeteer, lambda tick: "limp" in tick.why)
            assert "switched on" in tick.why
            for _ in range(30):
                assert not puppeteer.link.ready
                puppeteer.step()
                time.sleep(a1.CONTROL_DT)
            assert "switched on" in puppeteer.link.stopped
            stood_up(puppeteer)
            assert puppeteer.link.ready
        link.close()


@pytest.mark.slow
def test_whoever_drives_is_killed_and_the_robot_sits_down_and_lets_another_drive():
    with robot() as (_, port):
        where = f"udp:127.0.0.1:{port}"
        driver = subprocess.Popen(
            [sys.executable, "-m", "studio", "drive", "--source", "operator:quiet", "--seconds",
             "60", "--robot", where, "--robot-level", "targets", "--json", "-"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=ENVIRONMENT,
        )  # fmt: skip
        link = UdpLink("127.0.0.1", port, "targets")

        def report():
            link._hello()
            link.sense()
            assert link._report is not None
            return link._report

        until(lambda: report().phase == "following", 60.0)
        driver.kill()
        driver.wait()
        said = until(lambda: (said := report()).phase == "limp" and said)
        assert said.why == "line silent"
        stood_up(Puppeteer(link=link))
        assert link.ready
        link.close()


def test_the_robot_ends_cleanly_and_says_which_port_is_taken():
    with robot() as (process, port):
        with pytest.raises(StudioError, match=f"cannot listen on UDP 127.0.0.1:{port}"):
            run_robot(RobotConfig(port=port))
        process.send_signal(signal.SIGTERM)
        assert process.wait(10) == 0
        assert process.stderr is not None
        assert process.stderr.read() == ""


@pytest.mark.slow
def test_with_a_secret_only_who_knows_it_is_answered(tmp_path: Path):
    secret, other = tmp_path / "secret", tmp_path / "other"
    secret.write_bytes(b"sixteen bytes, or more\n")
    other.write_bytes(b"sixteen bytes, but others\n")
    with robot("--secret", str(secret)) as (_, port):
        where = f"udp:127.0.0.1:{port}"
        for wrong in (None, other):
            with pytest.raises(StudioError, match="no robot answers"):
                open_link(where, "references", wrong)
        link = open_link(where, "references", secret)
        assert link is not None
        assert link.sense().joint_pos.shape == (12,)
        link.close()


def test_beyond_this_machine_nothing_goes_without_a_secret(tmp_path: Path):
    with pytest.raises(StudioError, match="secret"):
        run_robot(RobotConfig(host="0.0.0.0", port=0))
    with pytest.raises(StudioError, match="secret"):
        open_link("udp:192.0.2.1:8090", "references")
    short = tmp_path / "short"
    short.write_bytes(b"short")
    with pytest.raises(StudioError, match="16 bytes"):
        read_secret(short)
    with pytest.raises(StudioError, match="cannot read"):
        read_secret(tmp_path / "none")


@pytest.mark.parametrize(
    "spec", ["udp", "udp:127.0.0.1", "udp::1", "udp:h:x", "udp:h:0", "tcp:h:1", ""]
)
def test_a_robot_that_is_none_is_one_line(spec: str):
    with pytest.raises(StudioError, match="known: sim, udp:HOST:PORT"):
        open_link(spec, "references")
    assert open_link("sim", "references") is None


def test_nobody_there_is_one_line_after_seconds():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with pytest.raises(StudioError, match=r"no robot answers at udp:127\.0\.0\.1"):
        open_link(f"udp:127.0.0.1:{port}", "references")


@pytest.mark.parametrize(("rate", "says"), [(100, "240 to 500"), (1000, "240 to 500"), (250, "30")])
def test_a_rate_that_does_not_go_is_refused(rate: int, says: str):
    with pytest.raises(StudioError, match=says):
        run_robot(RobotConfig(rate=rate, port=0))
