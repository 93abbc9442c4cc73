"""A whole studio on a loopback port: loop, inner viser, gateway, in this process; a browser."""

import shutil
import threading
import time
from dataclasses import dataclass
from pathlib import Path

import axe
import httpx
import pytest
from browsing import PATIENCE, chromium, drawn
from served import Served

from studio.options import ServeConfig
from studio.paths import package_folder
from studio.web.serve import studio

TOKEN = "test-token-0123456789"


@dataclass(frozen=True)
class Running:
    """A served studio: its port, an authorised client, and its parts for looking behind."""

    port: int
    client: httpx.Client
    sessions: Path

    @property
    def base(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def state(self) -> dict:
        return self.client.get("/api/state").json()

    def wait(self, true, seconds: float = PATIENCE) -> dict:
        """The first state for which `true(state)`; fails with the last one seen."""
        deadline = time.monotonic() + seconds
        while True:
            state = self.state()
            if true(state):
                return state
            assert time.monotonic() < deadline, state
            time.sleep(0.05)

    def ws(self, path: str, **options):
        """A WebSocket to the gateway, authorised unless told otherwise."""
        from websockets.sync.client import connect

        headers = options.pop("headers", {"Authorization": f"Bearer {TOKEN}"})
        return connect(
            f"ws://127.0.0.1:{self.port}{path}",
            additional_headers=headers,
            proxy=None,
            max_size=None,
            max_queue=None,  # a reader that pauses would not see the answer to its closing
            **options,
        )


@pytest.fixture(scope="session")
def studio_at(tmp_path_factory):
    """One studio for the whole session; tests leave it live, armed, on the operator."""
    config = ServeConfig(
        source="operator:quiet",
        port=0,
        token=TOKEN,
        sessions=tmp_path_factory.mktemp("sessions"),
    )
    with studio(config) as (server, listener, _):
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        port = listener.getsockname()[1]
        headers = {"Authorization": f"Bearer {TOKEN}"}
        with httpx.Client(
            base_url=f"http://127.0.0.1:{port}", headers=headers, timeout=PATIENCE, trust_env=False
        ) as client:
            running = Running(port=port, client=client, sessions=config.sessions)
            deadline = time.monotonic() + PATIENCE
            while time.monotonic() < deadline:
                try:
                    if client.get("/api/health").status_code == 200:
                        break
                except httpx.TransportError:
                    pass
                time.sleep(0.05)
            yield running
        server.should_exit = True
        thread.join(timeout=10.0)
        assert not thread.is_alive()


@pytest.fixture
def studio_live(studio_at):
    """The same, brought back to live, armed and unlocked, whoever used it before."""
    client = studio_at.client
    state = studio_at.state()
    if state["source"] != "operator:quiet":
        assert client.post("/api/source", json={"source": "operator:quiet"}).status_code == 200
    if state["stopped"]:
        client.post("/api/reset")
    client.post("/api/arm")  # always: whoever arms takes the place of a page that has gone silent
    client.post("/api/mode", json={"mode": "live"})
    client.post("/api/state", json={"state": "auto"})
    return studio_at


@pytest.fixture(scope="module")
def example_sessions(tmp_path_factory):
    """A folder of takes that holds the two examples, for one file's tests to change."""
    sessions = tmp_path_factory.mktemp("root") / "sessions"
    shutil.copytree(package_folder("sessions"), sessions)
    return sessions


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """A server that has to end well, where a file has none of its own."""
    served = Served(tmp_path_factory.mktemp("sessions"), "--source", "operator:quiet")
    yield served
    served.end_well()


@pytest.fixture(scope="module")
def browsing():
    """A Chromium for the tests of one file; `browsing.page` gives a page."""
    with chromium() as browsing:
        yield browsing


@pytest.fixture(scope="module")
def page(browsing, served):
    """The page, of the file's own `served`, of somebody who wants no animation; axe in it."""
    with browsing.page(served, 1300, 800, reduced_motion="reduce") as page:
        axe.put_into(drawn(page))
        yield page


@pytest.fixture(autouse=True)
def no_complaint_of_the_page(request):
    """Every browser test fails on an error in the console, or on a warning of ours."""
    yield
    if "browsing" in request.fixturenames:
        browsing = request.getfixturevalue("browsing")
        problems, browsing.problems[:] = list(browsing.problems), []
        assert problems == []
