"""How the live loop keeps time: with four socket clients, and beside a Chromium that draws."""

import json
import os
import shutil
import subprocess
import tempfile
import threading
import time
from pathlib import Path
from typing import Any
from urllib.request import urlopen

from studio.bench.served import PAGE_LIMIT, TOKEN, VIEW, end, page_socket, served
from studio.errors import StudioError

CLIENTS = 4
WARM_UP = 5.0
"""s that the browser draws before anything is counted: it compiles and fetches meshes first."""
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist", "--disable-quic", "--no-first-run", "--disable-component-update",
    "--disable-background-networking", "--disable-sync", "--remote-debugging-port=0",
    "--window-size=1280,800",
)  # fmt: skip
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
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        return {"skipped": f"no browser found ({', '.join(BROWSERS)}): install chromium"}
    # A browser that is told to go may still write into its profile while that is removed.
    with (
        served() as server,
        tempfile.TemporaryDirectory(prefix="a1-browser-", ignore_cleanup_errors=True) as profile,
    ):
        page = subprocess.Popen(
            [browser, *FLAGS, f"--user-data-dir={profile}", server.url],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            _wait(lambda: server.state()["control"]["pages"], "the page did not open its socket")
            time.sleep(WARM_UP)
            before = server.state()["counters"]
            drawn = _frame_rate(Path(profile), seconds)
            state = server.state()
        finally:
            end(page)
    after = state["counters"]
    return {
        "browser": Path(browser).name,
        "frames_drawn_per_second": drawn,
        "period_error_ms": state["period_error_ms"],
        "late": after["late"] - before["late"],
        "frames": after["frames"] - before["frames"],
    }


def _frame_rate(profile: Path, seconds: float) -> float:
    """Frames a second that the 3-D view draws over `seconds`: asked of it by a DevTools socket."""
    from websockets.sync.client import connect

    port = int((profile / "DevToolsActivePort").read_text().split()[0])
    with urlopen(f"http://127.0.0.1:{port}/json", timeout=5.0) as answer:
        pages = [page for page in json.load(answer) if page["type"] == "page"]
    asked = {
        "expression": _COUNT_FRAMES.replace("MS", str(round(1e3 * seconds))),
        "awaitPromise": True,
        "returnByValue": True,
    }
    with connect(pages[0]["webSocketDebuggerUrl"], proxy=None, max_size=None) as devtools:
        devtools.send(json.dumps({"id": 1, "method": "Runtime.evaluate", "params": asked}))
        while True:
            said = json.loads(devtools.recv(timeout=seconds + PAGE_LIMIT))
            if said.get("id") == 1:
                return float(said["result"]["result"]["value"])


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
