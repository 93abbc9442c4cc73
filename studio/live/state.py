"""The loop as the object of GET /api/state: what it does, and why nothing moves if nothing does."""

from collections import deque
from dataclasses import asdict
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from studio.takes.as_json import part
from studio.takes.tick import Tick

if TYPE_CHECKING:
    from studio.live.runtime import Runtime
    from studio.live.safety import Safety

WINDOW = 300
"""Control periods over which the loop's punctuality is told: 10 s."""


_OF_TICK = ("t", "state", "transition_to", "expert", "votes", "fallen", "why", "counters")


def latches(safety: "Safety") -> dict[str, Any]:
    """Whether the robot is stopped, by what, and what would free it. stops: how many there were."""
    return {
        "stopped": safety.stopped,
        "stops": safety.stops,
        "needs_reset": safety.needs_reset,
        "armed": safety.armed,
        "reason": safety.reason,
        "why": safety.stop_line,
    }


def state_dict(
    runtime: "Runtime", tick: Tick, now: float, period_error_ms: deque[float]
) -> dict[str, Any]:
    """The keys of docs/contract.md, and what a page shows besides. now: s on the loop's clock."""
    puppeteer, safety, replay = runtime.puppeteer, runtime.safety, runtime.replay
    extractor = puppeteer.retargeter.extractor
    of_tick, stale = part("tick", tick, "json"), safety.stale_s(now)
    late = list(islice(reversed(period_error_ms), WINDOW)) or [0.0]
    p50, p95, p99 = np.percentile(late, [50, 95, 99]).tolist()
    return {
        "mode": runtime.mode,
        **latches(safety),
        **{key: of_tick[key] for key in _OF_TICK},
        "state_lock": puppeteer.lock or "auto",
        "reason": runtime.reason,
        "stale_s": None if stale is None else round(stale, 3),
        "source": runtime.source.name,
        "source_report": runtime.source.report.and_refused(puppeteer.person.refused).as_dict(),
        "scene": runtime.scene,
        "latency_ms": of_tick["timings_ms"],
        "period_error_ms": {"p50": round(p50, 3), "p95": round(p95, 3), "p99": round(p99, 3)},
        "robot": part("robot", tick.robot, "trace"),
        "controller": puppeteer.controller.name,
        "style": puppeteer.config.style,
        "gains": asdict(puppeteer.retargeter.settings),
        "mirror": puppeteer.config.mirror,
        "travel": {
            "mode": puppeteer.config.travel,
            "found": puppeteer.retargeter.path.found,
            "moving": puppeteer.retargeter.travels,
        },
        "calibration": {
            "heading_deg": round(float(np.degrees(extractor.calibrator.heading)), 1),
            "leg_length_m": round(extractor.calibration.leg_length, 3),
            "seconds": round(extractor.calibration.seconds, 1),
        },
        "recording": None
        if runtime.recorder.recording is None
        else {"name": runtime.recorder.recording, "ticks": runtime.recorder.ticks},
        "recording_error": runtime.recording_error,
        "replay": None
        if runtime.mode != "replay" or replay is None
        else {
            "name": replay.name,
            "t": round(replay.t, 3),
            "seconds": round(replay.seconds, 3),
            "playing": replay.playing,
            "speed": replay.speed,
            "loop": replay.loop,
            "aligned": replay.aligned,
        },
        "collect": runtime.collector.as_dict(),
        "mapper": runtime.mappers.as_dict(),
    }
