"""Pages in a real Chromium whose every complaint is kept, and how a busy page is waited for."""

import shutil
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import pytest
from served import Served

FLAGS = [
    "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-gpu-compositing", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]  # fmt: skip
PATIENCE = 180.0
"""s: software WebGL on a busy machine draws a frame a second."""


class Browsing:
    """A Chromium (Debian's, or Playwright's own), and what its pages had to complain of.

    `problems`: each error of any page and frame, each warning of our own code, each request to
    anybody but the studio. Warnings of viser, in the framed view, and of MediaPipe are not
    ours to mend.
    """

    def __init__(self, browser: Any) -> None:
        self.browser = browser
        self.problems: list[str] = []

    @contextmanager
    def page(
        self,
        served: Served,
        width: int,
        height: int,
        path: str = "/",
        script: str = "",
        **more: Any,
    ) -> Iterator[Any]:
        """A page of `served` in a context of its own, `width` by `height` pixels, being opened.

        script: runs in each of its frames before anything of theirs. more: what the context is
        told besides, as `reduced_motion`.
        """
        context = self.browser.new_context(
            viewport={"width": width, "height": height}, color_scheme="dark", **more
        )
        if script:
            context.add_init_script(script)
        page = context.new_page()
        ours = (served.base, f"ws://127.0.0.1:{served.port}", "data:", "blob:")
        page.on("pageerror", lambda error: self.problems.append(str(error)))
        page.on("console", lambda message: self._on_console(message, served.base))
        page.on(
            "request",
            lambda r: None if r.url.startswith(ours) else self.problems.append(f"asked {r.url}"),
        )
        page.set_default_timeout(1000 * PATIENCE)
        try:
            page.goto(f"{served.base}{path}?token={served.token}")
            yield page
        finally:  # before its server goes, which it would complain of; else it keeps control
            context.close()

    def _on_console(self, message: Any, base: str) -> None:
        url = message.location.get("url", "")
        theirs = (f"{base}/view", f"{base}/assets/vendor")
        ours = url.startswith(base) and not url.startswith(theirs)
        if "TensorFlow Lite XNNPACK" in message.text:  # its logs are errors to a browser
            return
        if "GPU stall due to ReadPixels" in message.text:  # of a browser that draws in software
            return
        if message.type == "error" or (message.type == "warning" and ours):
            self.problems.append(f"{message.type}: {message.text} ({url})")

    @contextmanager
    def anything_goes(self) -> Iterator[None]:
        """What is done here makes a browser complain of whatever it likes, as of a server gone."""
        before = len(self.problems)
        yield
        del self.problems[before:]

    @contextmanager
    def expecting(self, words: str) -> Iterator[None]:
        """What is done here makes a browser complain, with these words, as it should."""
        before = len(self.problems)
        yield
        new = self.problems[before:]
        assert any(words in problem for problem in new), new
        self.problems[before:] = [problem for problem in new if words not in problem]


@contextmanager
def chromium(*flags: str, without: Sequence[str] = ()) -> Iterator[Browsing]:
    """A Chromium for as long as it lasts, with more flags, and without some it else would get."""
    sync_api = pytest.importorskip("playwright.sync_api")
    with (
        sync_api.sync_playwright() as playwright,
        launched(playwright.chromium, *flags, without=without) as browsing,
    ):
        yield browsing


@contextmanager
def launched(kind: Any, *flags: str, without: Sequence[str] = ()) -> Iterator[Browsing]:
    """The same of a Playwright that runs already; kind: its `chromium`."""
    path = shutil.which("chromium") or shutil.which("google-chrome")
    args = [flag for flag in FLAGS if flag not in without] + list(flags)
    browser = kind.launch(executable_path=path, args=args)
    yield Browsing(browser)
    browser.close()


def drawn(page: Any) -> Any:
    """The page, once its 3-D view shows the figures."""
    until(page, "() => document.querySelector('#veil')?.classList.contains('gone')")
    return page


def until(page: Any, true: str, seconds: float = PATIENCE) -> Any:
    """The first value of a function of the page that is true; a page this busy is asked seldom."""
    deadline = time.monotonic() + seconds
    while not (value := page.evaluate(true)):
        assert time.monotonic() < deadline, true
        time.sleep(0.25)
    return value


def click(page: Any, selector: str) -> None:
    """Press a button that can be pressed, without waiting for it to stop moving on the screen."""
    able = """(s) => {
      const b = document.querySelector(s);
      return b && !b.disabled && b.offsetParent !== null;
    }"""
    deadline = time.monotonic() + PATIENCE
    while not page.evaluate(able, selector):
        assert time.monotonic() < deadline, selector
        time.sleep(0.25)
    page.evaluate("(s) => document.querySelector(s).click()", selector)
