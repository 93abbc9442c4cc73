"""From a human frame being sent to the tick that was made of it: what the studio adds to a sensor.

A sender on this machine says where it is in its sequence by standing that many millimetres aside;
the ticks say it back. What a sensor and its pose model take comes on top.
"""

import threading
import time
from typing import Any

import numpy as np

from studio.bench.run import percentiles
from studio.client import ClientError, Studio
from studio.client.wire import frame_text
from studio.errors import StudioError
from studio.evaluation.served import TOKEN, served
from studio.mocap.gate import FrameGate
from studio.synthetic.operator import OperatorSource
from studio.timing import CONTROL_DT

AROUND = 400
"""Frames after which the sequence begins again: a step back of 0.4 m is none that is refused."""
_MM = 1e-3
_EVERY = 0.035
"""s between frames: no multiple of a control period, so that they meet it at every phase."""


def frame_latency(seconds: float) -> dict[str, Any]:
    """{sent_to_tick_ms, seen_share, arrivals, latency_ms, check_ms} of 29 frames a second.

    sent_to_tick_ms: from sending a frame to having the tick with its reference back.
    seen_share: of the frames, the others being replaced by a newer one before a control period
    came. arrivals, latency_ms: as the state says them. StudioError when the studio does not serve.
    """
    with served("--source", "stream") as server:
        studio = Studio(f"http://127.0.0.1:{server.port}", TOKEN)
        try:
            sent, came, state = _sent_and_seen(studio, seconds)
        except ClientError as error:
            raise StudioError(str(error)) from error
    took = [came[k] - at for k, at in sent.items() if k in came]
    return {
        "sent_to_tick_ms": percentiles(1e3 * np.array(took)),
        "seen_share": len(took) / len(sent),
        "arrivals": state["arrivals"],
        "latency_ms": state["latency_ms"],
        "check_ms": _checks(300),
    }


def _checks(count: int) -> dict[str, float]:
    """Percentiles of what the gate takes for a frame, as JSON."""
    gate, person = FrameGate(live=False), OperatorSource("walk", seed=0)
    took = []
    for k in range(count):
        pose = person.read(k * CONTROL_DT)
        assert pose is not None
        text = frame_text(pose.t, "studio", pose.joint_pos_w.tolist(), None).encode()
        began = time.perf_counter()
        gate.check(text)
        took.append(time.perf_counter() - began)
    return percentiles(1e3 * np.array(took))


def _sent_and_seen(
    studio: Studio, seconds: float
) -> tuple[dict[int, float], dict[int, float], Any]:
    """When each frame was sent, when the first tick with it came (s), and the state at the end."""
    pose = OperatorSource("quiet", seed=0).read(0.0)
    assert pose is not None
    sent: dict[int, float] = {}
    came: dict[int, float] = {}
    here, over = pose.joint_pos_w, threading.Event()
    with studio.ticks() as ticks, studio.frames() as frames:

        def listen() -> None:
            while not over.is_set():
                human = ticks.next(10.0)["human"]
                now = time.perf_counter()
                if human is None or human["positions"][0] is None:
                    continue
                aside = round((human["positions"][0][0] - here[0, 0]) / _MM)
                k = max((k for k in list(sent)[-AROUND:] if k % AROUND == aside), default=None)
                if k is not None:
                    came.setdefault(k, now)

        listener = threading.Thread(target=listen, daemon=True)
        listener.start()
        began = time.perf_counter()
        for k in range(round(seconds / _EVERY)):
            time.sleep(max(0.0, began + k * _EVERY - time.perf_counter()))
            sent[k] = time.perf_counter()
            body = (here + ((k % AROUND) * _MM, 0.0, 0.0)).tolist()
            frames.send(k * _EVERY, "studio", body)
        time.sleep(0.2)
        state = studio.state()
        over.set()
        listener.join(10.0)
    return sent, came, state
