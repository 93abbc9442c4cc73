"""A disk that fills up in the midst of an export or an import: one line, and nothing is left."""

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest
from acted_takes import acted_take, record
from numpy.random import default_rng

from studio.errors import StudioError
from studio.takes.export import formats
from studio.takes.export.formats import FORMATS
from studio.takes.take import read_take

SCRIPT = """
import resource, signal, sys
from pathlib import Path

from studio.errors import StudioError
from studio.mocap.imports import import_take
from studio.takes.export.formats import export_file
from studio.takes.take import read_take

take, out = read_take(Path(sys.argv[1])), Path(sys.argv[2])
whole = {}
for format in sys.argv[3:]:
    (out / "whole").mkdir(exist_ok=True)
    whole[format] = export_file(take, format, out / "whole")
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (4000, resource.RLIM_INFINITY))
for format in sys.argv[3:]:
    into = out / format
    into.mkdir()
    try:
        export_file(take, format, into)
    except StudioError as error:
        print(format, [str(path) for path in into.rglob("*")], error)
for file in (*whole.values(), take.path):
    if file.suffix in (".zip", ".mcap", ".jsonl", ".bvh", ""):
        try:
            import_take(out / "sessions", file)
        except StudioError as error:
            left = [p for p in (out / "sessions").rglob("*") if p.name != ".recording.lock"]
            print("import", left, error)
"""


@pytest.mark.parametrize("only", [("hdf5",), tuple(f for f in FORMATS if f != "hdf5")], ids=len)
def test_an_export_and_an_import_onto_a_full_disk_end_with_a_line(tmp_path: Path, only):
    """A limit on a file's size stands for it: the kernel says EFBIG in the midst of a write."""
    record(acted_take("tilt", default_rng(1), seconds=3.0), tmp_path / "s", "acted")
    ended = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(tmp_path / "s/acted"), str(tmp_path), *only],
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr[-2000:]
    assert "Traceback" not in ended.stderr
    lines = ended.stdout.splitlines()
    assert [line.split()[0] for line in lines[: len(only)]] == list(only)
    for line in lines:
        assert " [] " in line, line
        assert "File too large" in line, line
    assert len(lines) > len(only)


def test_a_data_set_that_cannot_be_packed_is_told_of_and_leaves_no_zip(tmp_path, monkeypatch):
    record(acted_take("tilt", default_rng(1), seconds=3.0), tmp_path / "s", "acted")

    def full(base: str, *_) -> str:
        Path(f"{base}.zip").write_bytes(b"PK")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(formats.shutil, "make_archive", full)
    with pytest.raises(StudioError, match="No space left"):
        formats.export_file(read_take(tmp_path / "s/acted"), "lerobot", tmp_path)
    assert not list(tmp_path.glob("*.zip"))
