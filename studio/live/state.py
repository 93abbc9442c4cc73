"""The loop as the object of GET /api/state: what it does, and why nothing moves if nothing does."""

from collections import deque
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from studio.takes.as_json import part
from studio.takes.tick import Tick

if TYPE_CHECKING:
    from studio.live.session import Session

WINDOW = 300
"""Control periods over which the loop's punctuality is told: 10 s."""


_OF_TICK = ("t", "state", "transition_to", "expert", "votes", "fallen", "why", "counters")


def state_dict(session: "Session", tick: Tick, period_error_ms: deque[float]) -> dict[str, Any]:
    """The keys of contract.md, and what a page shows besides."""
    puppeteer, safety, replay = session.puppeteer, session.safety, session.replay
    extractor = puppeteer.retargeter.extractor
    now = part("tick", tick, "json")
    late = list(islice(reversed(period_error_ms), WINDOW)) or [0.0]
    p50, p95, p99 = np.percentile(late, [50, 95, 99]).tolist()
    return {
        "mode": session.mode,
        **{key: now[key] for key in _OF_TICK},
        "state_lock": puppeteer.lock or "auto",
        "stopped": safety.stopped,
        "stops": safety.stops,
        "needs_reset": safety.needs_reset,
        "armed": safety.armed,
        "source": session.source.name,
        "scene": session.scene,
        "latency_ms": now["timings_ms"],
        "period_error_ms": {"p50": round(p50, 3), "p95": round(p95, 3), "p99": round(p99, 3)},
        "robot": part("robot", tick.robot, "trace"),
        "controller": puppeteer.tracker.name,
        "style": puppeteer.config.style,
        "gains": puppeteer.gains,
        "mirror": puppeteer.config.mirror,
        "calibration": {
            "heading_deg": round(float(np.degrees(extractor.calibrator.heading)), 1),
            "leg_length_m": round(extractor.calibration.leg_length, 3),
            "seconds": round(extractor.calibration.seconds, 1),
        },
        "recording": None
        if session.recorder.recording is None
        else {"name": session.recorder.recording, "ticks": session.recorded},
        "recording_error": session.recording_error,
        "replay": None
        if session.mode != "replay" or replay is None
        else {
            "name": replay.name,
            "t": round(replay.t, 3),
            "seconds": round(replay.seconds, 3),
            "playing": replay.playing,
            "speed": replay.speed,
            "loop": replay.loop,
            "aligned": replay.aligned,
        },
        "collect": session.collector.as_dict(),
        "mapper": session.mappers.as_dict(),
    }
