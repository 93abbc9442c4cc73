"""This machine's figures: the control period by section, the drive, the live loop, the page."""

import json
import logging
import os
import platform
import socket
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.error import URLError
from urllib.request import Request, urlopen

import numpy as np

from studio.errors import StudioError
from studio.evaluation.drive import drive
from studio.human.calibration import calibrate
from studio.mocap import open_source
from studio.orders import PuppeteerConfig
from studio.puppeteer import Puppeteer
from studio.robot.a1 import CONTROL_DT

log = logging.getLogger(__name__)
CLIENTS = 4
PAGE_LIMIT = 60.0
"""s to wait for the server at most."""


@dataclass(frozen=True, kw_only=True)
class BenchConfig:
    """compare: an earlier result. seconds: length of each part. page: start a server as well.

    training: measure physics, environment and PPO as environments grow.
    """

    compare: Path | None = None
    seconds: float = 20.0
    page: bool = True
    training: bool = True


def run_bench(config: BenchConfig) -> dict[str, Any]:
    """{machine, sections, drive, live}; with `compare`, each figure beside the earlier one."""
    earlier = _read(config.compare) if config.compare is not None else None
    result: dict[str, Any] = {"machine": machine()}
    result["sections_ms"], result["drive"] = control_period(config.seconds)
    if config.page:
        result["live"] = live(config.seconds)
    if config.training:
        from studio.evaluation.bench_training import training_rates

        result["training"] = training_rates(min(config.seconds, 5.0))
    if earlier is not None:
        result["compared"] = compare(result, earlier)
    return result


def machine() -> dict[str, Any]:
    """What the figures were measured on."""
    name = platform.processor() or platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        name = next(line.split(":", 1)[1].strip() for line in lines if "model name" in line)
    except (OSError, StopIteration):
        pass
    return {
        "cpu": name,
        "cores": os.cpu_count(),
        "load_1min": round(os.getloadavg()[0], 2),
        "python": platform.python_version(),
        "system": platform.system(),
    }


def control_period(seconds: float) -> tuple[dict[str, dict[str, float]], dict[str, float]]:
    """(percentiles, ms, per section; the drive's speed) over a tour of the operator on one core."""
    source = open_source("operator")
    puppeteer = Puppeteer(PuppeteerConfig(), calibrate(source.calibration_poses()))
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
    """p50, p95, p99 and max."""
    p50, p95, p99 = np.percentile(values, [50, 95, 99])
    return {
        "p50": float(p50),
        "p95": float(p95),
        "p99": float(p99),
        "max": float(np.max(values)),
    }


def live(seconds: float) -> dict[str, Any]:
    """A server in its own process, four socket clients: when it was ready, how it keeps time."""
    port, token = _free_port(), "bench-token-0123456789"
    began = time.perf_counter()
    server = subprocess.Popen(
        [sys.executable, "-m", "studio", "serve", "--port", str(port), "--token", token],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert server.stdout is not None
        url = server.stdout.readline().strip()
        if not url:
            raise StudioError(f"the server did not start: {_last_line(server)}")
        printed = time.perf_counter() - began
        _get(port, token, "/api/state")
        ready = time.perf_counter() - began
        counts = _listen(port, token, seconds)
        state = json.loads(_get(port, token, "/api/state"))
        usage = _cpu_share(server.pid, 3.0)
    finally:
        server.terminate()
        try:
            server.wait(10.0)
        except subprocess.TimeoutExpired:
            server.kill()
    return {
        "url_printed_s": printed,
        "page_ready_s": ready,
        "clients": CLIENTS,
        "updates_per_second": [count / seconds for count in counts],
        "period_error_ms": state["period_error_ms"],
        "late": state["counters"]["late"],
        "frames": state["counters"]["frames"],
        "cpu_share": usage,
    }


def _listen(port: int, token: str, seconds: float) -> list[int]:
    """Ticks that each of four clients received over `seconds`."""
    from websockets.sync.client import connect

    counts = [0] * CLIENTS

    def client(i: int) -> None:
        headers = {"Authorization": f"Bearer {token}"}
        with connect(f"ws://127.0.0.1:{port}/api/ticks", additional_headers=headers) as ws:
            end = time.perf_counter() + seconds
            while time.perf_counter() < end:
                ws.recv(timeout=5.0)
                counts[i] += 1

    threads = [threading.Thread(target=client, args=(i,)) for i in range(CLIENTS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return counts


def _cpu_share(pid: int, seconds: float) -> float | None:
    """Cores used by a process over some seconds (Linux; None elsewhere)."""

    def used() -> float:
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    try:
        before = used()
        time.sleep(seconds)
        return (used() - before) / seconds
    except (OSError, ValueError):
        return None


def _get(port: int, token: str, path: str) -> str:
    request = Request(
        f"http://127.0.0.1:{port}{path}", headers={"Authorization": f"Bearer {token}"}
    )
    deadline = time.perf_counter() + PAGE_LIMIT
    while True:
        try:
            with urlopen(request, timeout=5.0) as answer:
                return answer.read().decode()
        except (URLError, ConnectionError, TimeoutError) as error:
            if time.perf_counter() > deadline:
                raise StudioError(f"the server did not answer: {error}") from error
            time.sleep(0.05)


def _free_port() -> int:
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return int(s.getsockname()[1])


def _last_line(server: subprocess.Popen[str]) -> str:
    server.wait(5.0)
    lines = (server.stderr.read() if server.stderr else "").strip().splitlines()
    return lines[-1] if lines else "it said nothing"


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
