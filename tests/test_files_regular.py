"""Only regular files of a readable size are opened, and no more is read than they held."""

import os
from pathlib import Path

import pytest

from studio.errors import StudioError
from studio.files import open_regular
from studio.sources import open_source

SOURCES = ("bvh", "frames")


def test_a_regular_file_is_read_whole(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"x" * 100_000)
    with open_regular(path, 100_000) as file:
        assert file.read() == b"x" * 100_000
    path.write_bytes(b"")
    with open_regular(path, 0) as file:
        assert file.read() == b""


def test_a_file_that_grows_ends_where_it_ended(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    with open_regular(path, 100) as file, path.open("ab") as more:
        more.write(b"new")
        more.flush()
        assert file.read() == b"old"


def test_one_beyond_the_budget_is_refused_with_both_sizes(tmp_path):
    path = tmp_path / "a"
    with path.open("wb") as file:
        file.truncate(3 * 2**20)
    with pytest.raises(StudioError, match="3 MB, and at most 2 MB are read"):
        open_regular(path, 2 * 2**20)


@pytest.mark.parametrize("kind", SOURCES)
@pytest.mark.parametrize("path", ["/dev/zero", "/dev/stdin", "/dev/null"])
def test_a_device_is_no_source(kind, path):
    if not os.path.exists(path):
        pytest.skip(f"there is no {path} here")
    if Path(path).is_file():
        pytest.skip(f"{path} is a file here")
    with pytest.raises(StudioError, match="no regular file"):
        open_source(f"{kind}:{path}")


@pytest.mark.parametrize("kind", SOURCES)
@pytest.mark.parametrize("link", [False, True])
def test_a_pipe_that_nobody_writes_to_is_refused_at_once(tmp_path, kind, link):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    if link:
        (tmp_path / "link").symlink_to(path)
        path = tmp_path / "link"
    with pytest.raises(StudioError, match="no regular file"):
        open_source(f"{kind}:{path}")


@pytest.mark.parametrize("kind", SOURCES)
def test_a_folder_is_no_source(tmp_path, kind):
    with pytest.raises(StudioError, match=r"cannot read .*no regular file"):
        open_source(f"{kind}:{tmp_path}")


@pytest.mark.parametrize(("kind", "size"), [("bvh", 2**40), ("frames", 2**40)])
def test_a_huge_file_is_refused_before_it_is_read(tmp_path, kind, size):
    path = tmp_path / "huge"
    with path.open("wb") as file:
        file.truncate(size)  # sparse: it takes no room
    with pytest.raises(StudioError, match="at most"):
        open_source(f"{kind}:{path}")
