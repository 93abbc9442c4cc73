"""A Chromium on the studio's page, asked and traced by its DevTools sockets."""

import contextlib
import json
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.error import URLError
from urllib.request import urlopen

from studio.errors import StudioError
from studio.evaluation.served import PAGE_LIMIT, end

if TYPE_CHECKING:
    from websockets.sync.connection import Connection

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist", "--disable-quic", "--no-first-run", "--disable-component-update",
    "--disable-background-networking", "--disable-sync", "--remote-debugging-port=0",
    "--window-size=1280,800",
)  # fmt: skip
MISSING = f"no browser found ({', '.join(BROWSERS)}): install chromium"
_MAIN = "CrRendererMain"


def found() -> str | None:
    """The first browser that is installed."""
    return next(filter(None, map(shutil.which, BROWSERS)), None)


def fake_camera(video: Path) -> tuple[str, ...]:
    """Flags of a browser whose camera is allowed and shows an MJPEG video, again and again."""
    return (
        "--disable-gpu",  # what draws nothing leaves the processor to the pose model
        "--use-fake-ui-for-media-stream",
        "--use-fake-device-for-media-stream",
        f"--use-file-for-fake-video-capture={video}",
    )


class Browser:
    """A page and the browser around it, each by a socket. One thread only."""

    def __init__(self, page: "Connection", around: "Connection") -> None:
        self._page, self._around, self._asked = page, around, 0

    def evaluate(self, expression: str, seconds: float = PAGE_LIMIT) -> Any:
        """What it comes to in the page; a promise is waited for."""
        asked = {"expression": expression, "awaitPromise": True, "returnByValue": True}
        answer = self._ask(self._page, "Runtime.evaluate", seconds, **asked)
        if "exceptionDetails" in answer:
            raise StudioError(f"the page refused: {answer['exceptionDetails'].get('text')}")
        return answer["result"].get("value")

    def open(self, url: str) -> None:
        """Go there, until its scripts may be asked."""
        self._ask(self._page, "Page.navigate", url=url)
        deadline = time.perf_counter() + PAGE_LIMIT
        while True:
            try:
                if self.evaluate("document.readyState") != "loading":
                    return
            except StudioError:  # between two documents there is nobody to ask
                if time.perf_counter() > deadline:
                    raise
            time.sleep(0.02)

    def tasks_ms(self, seconds: float) -> list[float]:
        """How long each task of the page's main thread took, traced over `seconds`."""
        traced = {"includedCategories": ["toplevel", "__metadata"]}
        self._ask(self._around, "Tracing.start", traceConfig=traced)
        time.sleep(seconds)
        events: list[dict[str, Any]] = []
        self._ask(self._around, "Tracing.end", events=events)
        while True:
            said = json.loads(self._around.recv(timeout=PAGE_LIMIT))
            events += _events(said)
            if said.get("method") == "Tracing.tracingComplete":
                return main_thread_ms(events)

    def ask(self, method: str, **params: Any) -> dict[str, Any]:
        """A DevTools method of the page's, as Input.dispatchMouseEvent; its result."""
        return self._ask(self._page, method, **params)

    def _ask(
        self,
        socket: "Connection",
        method: str,
        seconds: float = PAGE_LIMIT,
        events: list[dict[str, Any]] | None = None,
        **params: Any,
    ) -> dict[str, Any]:
        self._asked += 1
        socket.send(json.dumps({"id": self._asked, "method": method, "params": params}))
        while True:
            try:
                said = json.loads(socket.recv(timeout=seconds))
            except TimeoutError as error:
                raise StudioError(f"the page did not answer within {seconds:.0f} s") from error
            if events is not None:
                events += _events(said)
            if said.get("id") == self._asked:
                if "error" in said:
                    raise StudioError(f"the browser refused {method}: {said['error']['message']}")
                return said["result"]


def _events(said: dict[str, Any]) -> list[dict[str, Any]]:
    return said["params"]["value"] if said.get("method") == "Tracing.dataCollected" else []


def main_thread_ms(events: list[dict[str, Any]]) -> list[float]:
    """Of a trace's events, ms of each whole task of pages' main threads."""
    mains = {
        (event["pid"], event["tid"])
        for event in events
        if event["name"] == "thread_name" and event["args"]["name"] == _MAIN
    }
    return [
        event.get("dur", 0) / 1e3
        for event in events
        if event["name"].endswith("RunTask") and (event["pid"], event["tid"]) in mains
    ]


@contextlib.contextmanager
def browser(url: str, *flags: str) -> Iterator[Browser]:
    """A Chromium, with more flags, that shows `url`, ended afterwards. StudioError where there is
    none."""
    from websockets.sync.client import connect

    path = found()
    if path is None:
        raise StudioError(MISSING)
    # A browser that is told to go may still write into its profile while that is removed.
    with tempfile.TemporaryDirectory(prefix="a1-browser-", ignore_cleanup_errors=True) as profile:
        process = subprocess.Popen(
            [path, *FLAGS, *flags, f"--user-data-dir={profile}", "about:blank"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            page, around = _sockets(Path(profile))
            options: dict[str, Any] = {"proxy": None, "max_size": None}
            with connect(page, **options) as one, connect(around, **options) as other:
                shown = Browser(one, other)
                shown.open(url)
                yield shown
        finally:
            end(process)


def _sockets(profile: Path) -> tuple[str, str]:
    """Addresses of the page's DevTools socket and of the browser's."""
    deadline = time.perf_counter() + PAGE_LIMIT
    while True:
        try:
            port = int((profile / "DevToolsActivePort").read_text().split()[0])
            base = f"http://127.0.0.1:{port}/json"
            with urlopen(base, timeout=5.0) as answer:
                pages = [one for one in json.load(answer) if one["type"] == "page"]
            with urlopen(f"{base}/version", timeout=5.0) as answer:
                around = json.load(answer)["webSocketDebuggerUrl"]
            return pages[0]["webSocketDebuggerUrl"], around
        except (OSError, URLError, ValueError, IndexError) as error:
            if time.perf_counter() > deadline:
                raise StudioError(f"the browser does not answer: {error}") from error
            time.sleep(0.1)
