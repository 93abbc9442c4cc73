"""Two processes that train one policy agree on everything but what they saw."""

import json
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.slow
def test_two_processes_agree_on_the_policy_and_see_different_worlds(tmp_path: Path) -> None:
    member = Path(__file__).parent / "distributed_worker.py"
    command = [sys.executable, "-m", "torch.distributed.run", "--standalone"]
    done = subprocess.run(
        [*command, "--nproc-per-node", "2", str(member), str(tmp_path)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    first, second = (json.loads((tmp_path / f"{rank}.json").read_text()) for rank in (0, 1))
    assert first.pop("observations") != second.pop("observations")
    assert first == second
    assert first["level"] > 0
    assert first["samples"] == 2 * (2 * 16 * 24 + 12 * 16 * 12)
