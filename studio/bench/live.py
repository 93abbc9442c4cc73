"""How the live loop keeps time: with four socket clients, and beside a Chromium that draws."""

import os
import threading
import time
from pathlib import Path
from typing import Any

from studio.errors import StudioError
from studio.evaluation.browser import MISSING, browser, found
from studio.evaluation.served import PAGE_LIMIT, TOKEN, VIEW, page_socket, served

CLIENTS = 4
WARM_UP = 5.0
"""s that the browser draws before anything is counted: it compiles and fetches meshes first."""
_COUNT_FRAMES = """new Promise(done => {
  const view = document.querySelector('#view').contentWindow, began = performance.now();
  let count = 0;
  const step = () => {
    const lasted = performance.now() - began;
    lasted < MS ? view.requestAnimationFrame(step) : done(1000 * count / lasted);
    count += 1;
  };
  view.requestAnimationFrame(step);
})"""


def live(seconds: float) -> dict[str, Any]:
    """A server and four pages' sockets: when it was ready, how it keeps time, what that costs.

    cpu_share: cores used by the whole server while the clients listen; cpu_share_alone: before.
    """
    with served() as server:
        alone = _cpu_share(server.pid, 3.0)
        counts, views, usage = _listen(server.port, server.pid, seconds)
        state = server.state()
    return {
        "url_printed_s": server.printed,
        "page_ready_s": server.ready,
        "clients": CLIENTS,
        "updates_per_second": [count / seconds for count in counts],
        "view_updates_per_second": [count / seconds for count in views],
        "period_error_ms": state["period_error_ms"],
        "late": state["counters"]["late"],
        "frames": state["counters"]["frames"],
        "cpu_share": usage,
        "cpu_share_alone": alone,
    }


def loop_beside_browser(seconds: float) -> dict[str, Any]:
    """The loop's period error while a Chromium draws the page on the same cores.

    {"skipped": why} where there is none. The window of the figures is the last 10 s.
    """
    path = found()
    if path is None:
        return {"skipped": MISSING}
    with served() as server, browser(server.url) as page:
        _wait(lambda: server.state()["control"]["pages"], "the page did not open its socket")
        time.sleep(WARM_UP)
        before = server.state()["counters"]
        asked = _COUNT_FRAMES.replace("MS", str(round(1e3 * seconds)))
        drawn = float(page.evaluate(asked, seconds + PAGE_LIMIT))
        state = server.state()
    after = state["counters"]
    return {
        "browser": Path(path).name,
        "frames_drawn_per_second": drawn,
        "period_error_ms": state["period_error_ms"],
        "late": after["late"] - before["late"],
        "frames": after["frames"] - before["frames"],
    }


def _listen(port: int, pid: int, seconds: float) -> tuple[list[int], list[int], float | None]:
    """Ticks and messages of the 3-D view that each of four pages' sockets received over `seconds`,
    and the cores that the server used meanwhile."""
    counts, views = [0] * CLIENTS, [0] * CLIENTS
    end = time.perf_counter() + seconds

    def client(path: str, i: int, received: list[int]) -> None:
        with page_socket(port, TOKEN, path) as ws:
            while time.perf_counter() < end:
                ws.recv(timeout=5.0)
                received[i] += 1

    threads = [
        threading.Thread(target=client, args=(path, i, received))
        for i in range(CLIENTS)
        for path, received in (("/api/ticks", counts), (VIEW, views))
    ]
    for thread in threads:
        thread.start()
    usage = _cpu_share(pid, max(0.5, seconds - 1.0))
    for thread in threads:
        thread.join()
    return counts, views, usage


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


def _wait(true: Any, otherwise: str) -> None:
    deadline = time.perf_counter() + PAGE_LIMIT
    while not true():
        if time.perf_counter() > deadline:
            raise StudioError(f"{otherwise} within {PAGE_LIMIT:.0f} s")
        time.sleep(0.2)
