"""Files are written whole or not at all, and a fingerprint changes with what it names only."""

import ast
import os
import shutil
import signal
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from studio import files, options
from studio.evaluation import composite, endurance, tracking
from studio.rl import bank_store
from studio.takes.dataset import datasets
from studio.training import retargeted


def test_a_file_is_replaced_when_the_block_ends_and_not_before(tmp_path: Path):
    path = tmp_path / "a.txt"
    files.write_whole(path, "old")
    with files.whole(path) as scratch:
        scratch.write_text("new")
        assert path.read_text() == "old"
        assert scratch.parent == tmp_path  # the same file system: a rename is one step
    assert path.read_text() == "new"
    assert os.listdir(tmp_path) == ["a.txt"]


@pytest.mark.parametrize("folder", [False, True])
def test_an_error_leaves_what_was_there_and_nothing_else(tmp_path: Path, folder: bool):
    path = tmp_path / "a"
    with files.whole(path) as scratch:
        scratch.mkdir() if folder else scratch.write_text("old")

    def half() -> None:
        with files.whole(path) as scratch:
            if folder:
                scratch.mkdir()
                (scratch / "part").write_text("half")
            else:
                scratch.write_text("half")
            raise RuntimeError("full")

    with pytest.raises(RuntimeError, match="full"):
        half()
    assert os.listdir(tmp_path) == ["a"]
    assert os.listdir(path) == [] if folder else path.read_text() == "old"


def test_a_folder_takes_the_place_of_an_older_one(tmp_path: Path):
    for name in ("one", "two"):
        with files.whole(tmp_path / "set") as scratch:
            scratch.mkdir()
            (scratch / name).write_text(name)
    assert os.listdir(tmp_path / "set") == ["two"]


def test_a_secret_is_its_owners_alone_and_other_files_are_as_the_umask_says(tmp_path: Path):
    before = os.umask(0o022)
    try:
        files.write_whole(tmp_path / "secret", "word", mode=0o600)
        files.write_whole(tmp_path / "page", "words")
    finally:
        os.umask(before)
    assert (tmp_path / "secret").read_text() == "word"
    assert stat.S_IMODE((tmp_path / "secret").stat().st_mode) == 0o600
    assert stat.S_IMODE((tmp_path / "page").stat().st_mode) == 0o644


def test_the_folder_around_is_made_only_where_it_is_asked_for(tmp_path: Path):
    with pytest.raises(FileNotFoundError):
        files.write_whole(tmp_path / "gone" / "a", b"x")
    assert not (tmp_path / "gone").exists()
    files.write_whole(tmp_path / "new" / "a", b"x", parents=True)
    assert (tmp_path / "new" / "a").read_bytes() == b"x"


def test_what_a_killed_process_left_goes_with_the_next_write(tmp_path: Path):
    path = tmp_path / "a"
    script = (
        "import os, signal, sys; from pathlib import Path; from studio.files import whole\n"
        "with whole(Path(sys.argv[1])) as scratch:\n"
        "    scratch.write_text('half'); os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run([sys.executable, "-c", script, str(path)])
    assert done.returncode == -signal.SIGKILL
    (left,) = os.listdir(tmp_path)
    assert left != "a"
    with files.whole(path) as scratch:
        scratch.write_text("whole")
        with files.whole(tmp_path / "b") as other:  # of this process, and alive: left alone
            other.write_text("b")
            assert scratch.exists()
    assert sorted(os.listdir(tmp_path)) == ["a", "b"]


def test_a_fingerprint_changes_with_each_of_its_parts_and_with_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    for file in ("room/a.py", "room/deep/b.py", "other/c.py", "web/page.py", "d.bin"):
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_text("x")
    monkeypatch.setattr(files, "STUDIO", tmp_path)

    def now() -> str:
        return files.fingerprint("room", "other/c", tmp_path / "d.bin")

    seen = [now()]
    for file in ("room/a.py", "room/deep/b.py", "other/c.py", "d.bin"):
        (tmp_path / file).write_text("y")
        seen.append(now())
    assert len(set(seen)) == 5
    (tmp_path / "web/page.py").write_text("y")
    assert now() == seen[-1]
    (tmp_path / "room/a.py").rename(tmp_path / "room/e.py")  # a name is part of it
    assert now() != seen[-1]
    with pytest.raises(FileNotFoundError):
        files.fingerprint("room/gone")


def test_an_edit_of_the_page_draws_no_people_anew_and_one_of_the_mapper_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    copy = tmp_path / "studio"
    shutil.copytree(files.STUDIO, copy, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(files, "STUDIO", copy)
    before = files.fingerprint(*retargeted.CODE)
    for file, same in (
        ("web/serve.py", True),
        ("takes/take.py", True),
        ("retarget/mapper.py", False),
    ):
        with (copy / file).open("a") as out:
            out.write("\n# edited\n")
        assert (files.fingerprint(*retargeted.CODE) == before) is same, file


def imported(*files_: Path) -> set[Path]:
    """These files of ours and all that they import, however far down and wherever in the file."""
    seen: set[Path] = set()
    todo = list(files_)
    while todo:
        file = todo.pop()
        if file in seen:
            continue
        seen.add(file)
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom):
                names = [f"{node.module}", *(f"{node.module}.{a.name}" for a in node.names)]
            elif isinstance(node, ast.Import):
                names = [a.name for a in node.names]
            else:
                continue
            for name in (n for n in names if n.split(".")[0] == "studio"):
                path = files.STUDIO.joinpath(*name.split(".")[1:])
                either = (path.with_suffix(".py"), path / "__init__.py")
                todo += [each for each in either if each.is_file()]
    return seen


NOT_DECIDING = (
    "errors.py", "files.py", "options.py", "paths.py", "statistics.py", "takes/untrusted.py",
)  # fmt: skip
"""What is imported from everywhere and changes no figure: refusals, folders, names of options (a
test below: no number), how a file is checked, how values are summed up."""
OF_TICK = ("metrics.py", "takes/tick.py")
"""How a tick is written down and judged, not what comes of it."""
SCENE_OPERATOR = (
    "evaluation/scene_operator", "evaluation/scene_plays", "evaluation/scene_views",
    "evaluation/scene_ways",
)  # fmt: skip


@pytest.mark.parametrize(
    ("parts", "begins", "besides"),
    [
        (bank_store.DRAWN_BY, ("rl/bank", "rl/transitions"), ()),
        (endurance._FLOW, ("evaluation/long_drive",), OF_TICK),
        (
            composite._FLOW,
            ("puppeteer", "synthetic/operator", "takes/record/codec", *SCENE_OPERATOR),
            (),
        ),
        (tracking._CODE, ("rl/rollouts", "evaluation/disturbed"), ()),
        (retargeted.CODE, ("puppeteer", "synthetic/impaired"), OF_TICK),
        (datasets._CODE, ("reference/labels", "takes/take", "takes/columns"), ("takes/names.py",)),
    ],
)
def test_a_fingerprint_misses_no_file_that_its_code_imports(parts, begins, besides):
    covered = {file for part in parts for file in files._code(part)}
    needed = imported(*(files.STUDIO / f"{name}.py" for name in begins))
    names = {f.relative_to(files.STUDIO).as_posix() for f in needed - covered}
    assert {n for n in names if not n.endswith("__init__.py")} <= {*NOT_DECIDING, *besides}


def test_of_options_nothing_but_names_is_imported_by_what_is_kept():
    """`options.py` is in no list of code: no figure may come from there."""
    for file in imported(*(files.STUDIO / f"{name}.py" for name in ("evaluation/composite",))):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module == "studio.options":
                for name in node.names:
                    figure = getattr(options, name.name)
                    assert not isinstance(figure, int | float), (file, name.name)
