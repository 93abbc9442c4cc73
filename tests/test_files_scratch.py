"""Temporary folders go with their process, however it ends."""

import os
import signal
import subprocess
import sys
import time

from studio.files import _LOCK, _YOUNG_S, scratch_folder, sweep

HOLD = """
import sys, time
from pathlib import Path
from studio.files import scratch_folder
with scratch_folder("x-", Path(sys.argv[1])) as folder:
    (folder / "deep").mkdir()
    (folder / "deep" / "file").write_text("something")
    print(folder, flush=True)
    time.sleep(120)
"""


def test_a_folder_is_gone_when_it_is_done_with(tmp_path):
    with scratch_folder("x-", tmp_path) as folder:
        (folder / "file").write_text("something")
        assert folder.parent == tmp_path
    assert list(tmp_path.iterdir()) == []


def test_what_a_killed_process_left_is_swept_and_what_another_uses_is_not(tmp_path):
    processes = [
        subprocess.Popen([sys.executable, "-c", HOLD, str(tmp_path)], stdout=subprocess.PIPE)
        for _ in range(2)
    ]
    dead, alive = processes
    pipes = [process.stdout for process in processes if process.stdout]
    names = [os.path.basename(pipe.readline().decode().strip()) for pipe in pipes]
    dead.send_signal(signal.SIGKILL)
    dead.wait(20.0)
    try:
        assert sweep("x-", tmp_path) == [names[0]]
        assert [path.name for path in tmp_path.iterdir()] == [names[1]]
    finally:
        alive.terminate()
        alive.wait(20.0)
        for pipe in pipes:
            pipe.close()


def test_a_folder_without_a_lock_is_swept_once_it_is_old_and_a_link_never(tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / _LOCK).touch()
    old, young, link = (tmp_path / f"x-{name}" for name in ("old", "young", "link"))
    old.mkdir()
    young.mkdir()
    link.symlink_to(elsewhere)
    past = time.time() - _YOUNG_S - 5.0
    os.utime(old, (past, past))
    assert sweep("x-", tmp_path) == ["x-old"]
    assert young.is_dir()
    assert elsewhere.is_dir()
