"""A training ends with the studio that began it, and not with a terminal that has none."""

import os
import subprocess
import sys

import pytest

from studio.training import parent_watch

RUN = (
    "from studio.training import parent_watch; "
    "parent_watch.exit_with_parent(); print('held', flush=True); "
)


@pytest.mark.parametrize("held", [True, False])
def test_a_process_begun_by_another_ends_when_its_standard_input_closes(held):
    environment = {**os.environ, **({parent_watch.VARIABLE: "1"} if held else {})}
    wait = "import time; time.sleep(60)" if held else "import time; time.sleep(0.5)"
    process = subprocess.Popen(
        [sys.executable, "-c", RUN + wait],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=environment,
    )
    assert process.stdin is not None
    assert process.stdout is not None
    assert process.stdout.readline() == b"held\n"
    assert process.poll() is None
    process.stdin.close()
    assert process.wait(20.0) == (1 if held else 0)
    process.stdout.close()
