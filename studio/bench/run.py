"""This machine's figures: the control period by section, the drive, the live loop, the page."""

import json
import logging
import os
import platform
import time
from pathlib import Path
from typing import Any

import numpy as np

from studio import statistics
from studio.errors import StudioError
from studio.evaluation.behind import drive, met
from studio.options import BenchConfig
from studio.robot.a1 import CONTROL_DT
from studio.sources import open_source
from studio.training.machine import machine as processor

log = logging.getLogger(__name__)


def run_bench(config: BenchConfig) -> dict[str, Any]:
    """{machine, sections_ms, drive, live, frames, loop_beside_browser, page, journeys, stop,
    training, mapper, takes}; with `compare`, each figure beside the earlier one, too.
    """
    earlier = _read(config.compare) if config.compare is not None else None
    result: dict[str, Any] = {"machine": machine()}
    result["sections_ms"], result["drive"] = control_period(config.seconds)
    if config.page:
        from studio.bench import live as bench_live
        from studio.bench.frames import frame_latency

        result["live"] = bench_live.live(config.seconds)
        result["frames"] = frame_latency(config.seconds)
        if config.browser:
            from studio.bench.journeys import journeys
            from studio.bench.page import page

            result["loop_beside_browser"] = bench_live.loop_beside_browser(config.seconds)
            result["page"] = page(config.seconds)
            result["journeys"] = journeys()
        if config.floods:
            from studio.bench.stop import stop_latency

            result["stop"] = stop_latency(max(1, round(3.0 * config.seconds)))
    if config.training:
        from studio.bench.training import mapper_growth, training_rates

        result["training"] = training_rates(min(config.seconds, 5.0))
        result["mapper"] = mapper_growth()
    if config.takes:
        from studio.bench.takes import takes_cost

        result["takes"] = takes_cost()
    if earlier is not None:
        result["compared"] = compare(result, earlier)
    return result


def machine() -> dict[str, Any]:
    """What the figures were measured on."""
    return {
        **processor(),
        "load_1min": round(os.getloadavg()[0], 2),
        "python": platform.python_version(),
        "system": platform.system(),
    }


def control_period(seconds: float) -> tuple[dict[str, dict[str, float]], dict[str, float]]:
    """(percentiles, ms, per section; the drive's speed) over a tour of the operator on one core."""
    source = open_source("operator")
    puppeteer = met(source)
    for _ in drive(puppeteer, source, 2.0):
        pass  # caches warm
    source = open_source("operator")
    puppeteer.reset()
    wall, cpu = time.perf_counter(), time.process_time()
    ticks = list(drive(puppeteer, source, seconds))
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    sections = {
        name: percentiles(np.array([t.timings_ms.get(name, 0.0) for t in ticks]))
        for name in ticks[-1].timings_ms
    }
    simulated = len(ticks) * CONTROL_DT
    speed = {
        "seconds": simulated,
        "times_real_time": simulated / wall,
        "times_real_time_cpu": simulated / cpu,
    }
    return sections, speed


def percentiles(values: np.ndarray) -> dict[str, float]:
    """As `statistics.percentiles`, and the max."""
    return {**statistics.percentiles(values), "max": float(np.max(values))}


def _read(path: Path) -> dict[str, Any]:
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise StudioError(f"cannot compare with {path}: {error}") from error


def compare(now: dict[str, Any], earlier: dict[str, Any]) -> dict[str, dict[str, float]]:
    """Every figure both have: {path: {now, earlier, ratio}}."""
    before, out = _flat(earlier), {}
    for path, value in _flat(now).items():
        if path in before and not path.startswith("machine"):
            old = before[path]
            out[path] = {"now": value, "earlier": old, "ratio": value / old if old else 0.0}
    return out


def _flat(value: Any, path: str = "") -> dict[str, float]:
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return {}
    if isinstance(value, int | float):
        return {path: float(value)}
    items = value.items() if isinstance(value, dict) else enumerate(value)
    out: dict[str, float] = {}
    for key, inner in items:
        out.update(_flat(inner, f"{path}.{key}" if path else str(key)))
    return out
