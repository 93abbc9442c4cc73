"""`a1-studio robot` in a process of its own."""

import os
import subprocess
import sys


def robot(port: int = 0) -> tuple[subprocess.Popen, int]:
    """The process, and the UDP port it listens at."""
    process = subprocess.Popen(
        [sys.executable, "-m", "studio", "robot", "--port", str(port)],
        stdout=subprocess.PIPE, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    assert process.stdout is not None
    return process, int(process.stdout.readline().rsplit(":", 1)[1])


def end(process: subprocess.Popen) -> None:
    """At once, as by a kill."""
    process.kill()
    process.wait()
    assert process.stdout is not None
    process.stdout.close()
