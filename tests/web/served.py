"""`a1-studio serve` in a process of its own."""

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import httpx


class Served:
    """`a1-studio serve` in a process of its own, and every tick it sent."""

    def __init__(self, sessions: Path, *options: str, port: int = 0) -> None:
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        self.begun, self.sessions = time.monotonic(), sessions
        self.process = subprocess.Popen(
            [sys.executable, "-m", "studio", "serve", "--port", str(port),
             "--sessions", str(sessions), *options],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment,
        )  # fmt: skip
        assert self.process.stdout is not None
        self.url = self.process.stdout.readline().strip()
        assert self.url, self.process.stderr.read() if self.process.stderr else ""
        found = re.fullmatch(r"(http://127\.0\.0\.1:(\d+))/\?token=(.+)", self.url)
        assert found, self.url
        self.base, self.port, self.token = found[1], int(found[2]), found[3]
        headers = {"Authorization": f"Bearer {self.token}"}
        self.client = httpx.Client(
            base_url=self.base, headers=headers, timeout=30.0, trust_env=False
        )
        self.ticks: dict[int, dict] = {}
        self._listening = True
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def _listen(self) -> None:
        from websockets.exceptions import ConnectionClosed
        from websockets.sync.client import connect

        headers = {"Authorization": f"Bearer {self.token}"}
        url = f"ws://127.0.0.1:{self.port}/api/ticks"
        with connect(url, additional_headers=headers, proxy=None, max_queue=None) as ws:
            while self._listening:
                try:
                    tick = json.loads(ws.recv(timeout=0.5))
                except TimeoutError:
                    continue
                except ConnectionClosed:
                    return
                self.ticks[tick["index"]] = tick

    def wait(self, true, seconds: float = 60.0) -> dict:
        """The first state for which `true(state)`."""
        deadline = time.monotonic() + seconds
        while True:
            state = self.client.get("/api/state").json()
            if true(state):
                return state
            assert time.monotonic() < deadline, state
            time.sleep(0.1)

    def end_well(self) -> None:
        """Closed, it has no error to tell of."""
        status, errors = self.close()
        assert status == 0, errors
        assert "Traceback" not in errors, errors

    def close(self) -> tuple[int, str]:
        """SIGINT; (exit status, standard error)."""
        self._listening = False
        self._thread.join(timeout=5.0)
        self.client.close()
        self.process.send_signal(signal.SIGINT)
        try:
            _, errors = self.process.communicate(timeout=20.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            _, errors = self.process.communicate()
        return self.process.returncode, errors
