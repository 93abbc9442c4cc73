"""The loop as the object of GET /api/state: what it does, and why nothing moves if nothing does."""

from collections import deque
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from studio.robot.pose import RobotPose
from studio.takes.tick import Tick

if TYPE_CHECKING:
    from studio.live.session import Session

WINDOW = 300
"""Control periods over which the loop's punctuality is told: 10 s."""


def pose_dict(pose: RobotPose) -> dict[str, list[float]]:
    """A robot as in a tick's JSON: base_pos, base_quat, joint_pos, foot_contact."""
    return {
        name: [round(float(v), 5) for v in getattr(pose, name)]
        for name in ("base_pos", "base_quat", "joint_pos", "foot_contact")
    }


def state_dict(session: "Session", tick: Tick, period_error_ms: deque[float]) -> dict[str, Any]:
    """The keys of contract.md, and what a page shows besides."""
    puppeteer, safety, replay = session.puppeteer, session.safety, session.replay
    extractor = puppeteer.retargeter.extractor
    late = list(islice(reversed(period_error_ms), WINDOW)) or [0.0]
    p50, p95, p99 = np.percentile(late, [50, 95, 99]).tolist()
    return {
        "mode": session.mode,
        "state": tick.state,
        "transition_to": tick.transition_to,
        "state_lock": puppeteer.lock or "auto",
        "expert": tick.expert,
        "votes": {name: round(float(share), 3) for name, share in tick.votes.items()},
        "stopped": safety.stopped,
        "stops": safety.stops,
        "needs_reset": safety.needs_reset,
        "armed": safety.armed,
        "fallen": tick.fallen,
        "why": tick.why,
        "source": session.source.name,
        "scene": session.scene,
        "latency_ms": {name: round(ms, 3) for name, ms in tick.timings_ms.items()},
        "period_error_ms": {"p50": round(p50, 3), "p95": round(p95, 3), "p99": round(p99, 3)},
        "counters": tick.counters,
        "robot": pose_dict(tick.robot),
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
            "aligned": getattr(replay, "aligned", None),
        },
        "collect": session.collector.as_dict(),
        "mapper": session.mappers.as_dict(),
        "t": round(tick.t, 4),
    }
