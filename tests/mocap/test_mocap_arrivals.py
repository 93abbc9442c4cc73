"""How frames of a live source come: rate, jitter, lateness and the wait for the control loop."""

import json

import numpy as np
import pytest

from studio.mocap.arrivals import ArrivalLog
from studio.mocap.stream import StreamSource
from studio.synthetic.impaired import Impaired, Impairment
from studio.synthetic.operator import OperatorSource


def test_an_even_stream_has_its_rate_and_neither_jitter_nor_lateness():
    log = ArrivalLog()
    for k in range(60):
        log.came(100.0 + k / 50, 7.0 + k / 50)
        log.read(100.0 + k / 50 + 0.005, 100.0 + k / 50)
    found = log.summary(101.2)
    assert found is not None
    assert found.rate_hz == pytest.approx(50.0, abs=0.1)
    assert found.jitter_ms == pytest.approx(0.0, abs=0.01)
    assert found.late_ms["p99"] == pytest.approx(0.0, abs=0.01)
    assert found.wait_ms["p50"] == pytest.approx(5.0, abs=0.01)


def test_a_frame_in_two_that_is_late_is_jitter_and_lateness():
    log = ArrivalLog()
    for k in range(60):
        log.came(k / 30 + 0.020 * (k % 2), k / 30)
        log.read(k / 30 + 0.020 * (k % 2), k / 30 + 0.020 * (k % 2))
    found = log.summary(2.0)
    assert found is not None
    assert found.jitter_ms == pytest.approx(20.0, abs=0.1)
    assert found.late_ms["p95"] == pytest.approx(20.0, abs=0.1)
    assert found.rate_hz == pytest.approx(30.0, abs=0.5)


def test_only_the_last_seconds_count_and_a_new_sender_has_a_clock_of_its_own():
    log = ArrivalLog()
    for k in range(300):
        log.came(k / 100, 0.0 if k < 50 else k / 100)
        log.read(k / 100, k / 100)
    found = log.summary(3.0)
    assert found is not None
    assert found.late_ms["p99"] == pytest.approx(0.0, abs=0.01)
    assert log.summary(60.0) is None
    for k in range(5):
        log.came(k / 30, k / 30)
        log.read(k / 30, k / 30)
    log.anew()
    assert log.summary(0.2) is None


def test_a_stream_tells_how_its_frames_come_and_a_file_does_not():
    now = [50.0]
    source = StreamSource(clock=lambda: now[0])
    person = OperatorSource("quiet", seed=2)
    assert source.arrivals is None
    for k in range(30):
        pose = person.read(k / 30)
        assert pose is not None
        frame = {
            "t": k / 30, "skeleton": "studio", "positions": pose.joint_pos_w.tolist(),
        }  # fmt: skip
        now[0] = 50.0 + k / 30
        source.push(json.dumps(frame))
        now[0] += 0.010
        assert source.read(0.0) is not None
    for found in (source.arrivals, Impaired(source, Impairment()).arrivals):
        assert found is not None
        assert found.rate_hz == pytest.approx(30.0, abs=0.1)
        assert np.isclose(found.wait_ms["p95"], 10.0, atol=0.01)
    assert person.arrivals is None


def sends(source: StreamSource, k: int = 0) -> None:
    pose = OperatorSource("quiet", seed=2).read(0.0)
    assert pose is not None
    positions = pose.joint_pos_w.tolist()
    source.push(json.dumps({"t": k / 30, "skeleton": "studio", "positions": positions}))


def test_a_frame_that_is_read_says_when_it_was_sent_and_how_long_it_waited():
    now = [50.0]
    source = StreamSource(clock=lambda: now[0])
    sends(source, k=90)
    now[0] += 0.012
    pose = source.read(0.0)
    assert pose is not None
    assert pose.echo is not None
    assert pose.echo.sent == 3.0
    assert pose.echo.waited_ms == pytest.approx(12.0)


def test_a_frame_that_waited_for_seconds_is_read_though_somebody_looked_meanwhile():
    now = [50.0]
    source = StreamSource(clock=lambda: now[0])
    sends(source)
    now[0] = 60.0
    assert source.arrivals is None  # nothing came of late
    assert source.read(0.0) is not None


def test_a_frame_is_read_though_another_sender_has_come_meanwhile():
    source = StreamSource(clock=lambda: 50.0)
    sends(source)
    source.new_sender()
    assert source.read(0.0) is not None
    assert source.arrivals is None
