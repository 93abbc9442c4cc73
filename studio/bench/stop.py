"""How long an emergency stop takes to be answered while one client floods the studio.

Beside the flood there are four pages (control, ticks and 3-D view each), a training, and eight
imports at once. Every client is a process of its own: what is measured is the server.
"""

import contextlib
import json
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from studio.bench.flood import KINDS
from studio.bench.live import CLIENTS
from studio.bench.run import percentiles
from studio.bench.takes import performed
from studio.evaluation.served import TOKEN, end, page_socket, served
from studio.robot.a1 import CONTROL_DT
from studio.synthetic.operator import OperatorSource
from studio.takes.export.bvh import write_bvh
from studio.takes.record.recorder import Recorder

IMPORTS = 8
CLIP_S = 60.0
TRAINING_S = 20.0
MORE = ("nothing", "pages", "pages, training, imports")
"""What is measured without a flood, to see what each adds."""


def stop_latency(stops: int, floods: tuple[str, ...] = KINDS) -> dict[str, Any]:
    """{case: {"socket_ms", "post_ms"}}: percentiles over `stops` stops by each way."""
    out: dict[str, Any] = {}
    with tempfile.TemporaryDirectory(prefix="a1-bench-") as folder:
        sessions = Path(folder) / "sessions"
        recorder = Recorder(sessions)
        take = recorder.start("tour")
        for tick in performed(TRAINING_S):
            recorder.append(tick)
        recorder.close()
        clip = Path(folder) / "walk.bvh"
        write_bvh(clip, walked(CLIP_S), CONTROL_DT)
        with served("--sessions", str(sessions)) as server, contextlib.ExitStack() as beside:
            out[MORE[0]] = measured(server.port, stops)
            beside.enter_context(client("pages", server.port, str(CLIENTS)))
            time.sleep(1.0)
            out[MORE[1]] = measured(server.port, stops)
            training = {"takes": [take], "steps": 100_000}
            _post(server.port, "/api/train", training)
            beside.enter_context(client("imports", server.port, str(IMPORTS), str(clip)))
            time.sleep(2.0)
            out[MORE[2]] = measured(server.port, stops)
            for kind in floods:
                with client(kind, server.port):
                    time.sleep(1.0)
                    out[kind] = measured(server.port, stops)
    return out


def walked(seconds: float) -> np.ndarray:
    """(T, 19, 3) m: the synthetic operator, walking."""
    source = OperatorSource("walk", seed=1)
    poses = [source.read(k * CONTROL_DT) for k in range(round(seconds / CONTROL_DT))]
    return np.array([pose.joint_pos_w for pose in poses if pose is not None])


def measured(port: int, stops: int) -> dict[str, dict[str, float]]:
    """ms from sending a stop to its answer, by a page's socket and by POST on a new connection."""
    by_socket, by_post = [], []
    with page_socket(port, TOKEN, "/api/control", open_timeout=60.0) as ws:
        for k in range(stops):
            time.sleep(0.05 + 0.033 * (k % 7) / 7)  # at any instant of the loop's period
            begun = time.perf_counter()
            ws.send(json.dumps({"type": "stop", "number": k}))
            while json.loads(ws.recv(timeout=60.0))["type"] != "stopped":
                pass
            by_socket.append(1e3 * (time.perf_counter() - begun))
            begun = time.perf_counter()
            _post(port, "/api/stop")
            by_post.append(1e3 * (time.perf_counter() - begun))
    return {
        "socket_ms": percentiles(np.array(by_socket)),
        "post_ms": percentiles(np.array(by_post)),
    }


@contextlib.contextmanager
def client(kind: str, port: int, *more: str) -> Iterator[None]:
    """Another process that floods."""
    process = subprocess.Popen(
        [sys.executable, "-m", "studio.bench.flood", kind, str(port), TOKEN, *more]
    )
    try:
        yield
    finally:
        end(process)


def _post(port: int, path: str, body: Any = None) -> Any:
    content = b"" if body is None else json.dumps(body).encode()
    with socket.create_connection(("127.0.0.1", port), timeout=60.0) as raw:
        raw.sendall(
            f"POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nAuthorization: Bearer {TOKEN}\r\n"
            f"Content-Type: application/json\r\nContent-Length: {len(content)}\r\n"
            "Connection: close\r\n\r\n".encode()
            + content
        )
        answer = b""
        while more := raw.recv(65_536):
            answer += more
    head, _, content = answer.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 200"), answer[:500]
    return json.loads(content)
