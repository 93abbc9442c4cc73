"""Every block of code of README, guide and models' pages: Python runs, commands are such as the
command line takes, and where a block says `sh` those that are done in seconds run.

A comment behind a command says where it takes long, or needs what a test has not: `# a minute` is
run by `make test-long`; `# minutes`, `# hours`, `# needs …` and `# until Ctrl C` by nobody, as are
names in capitals. A page's blocks run in their order, in one folder with the example takes in it.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial, wraps
from pathlib import Path
from unittest.mock import patch

import pytest
import tyro
from markdown_it import MarkdownIt

from studio import __version__, cli
from studio.reference.library import TASKS
from studio.sources import SOURCES
from studio.takes.commands import export_take

REPO = Path(__file__).resolve().parents[1]
PAGES = ["README.md", *sorted(
    path.relative_to(REPO).as_posix()
    for glob in ("docs/**/*.md", "models/**/*.md", "sessions/*.md", "CONTRIBUTING.md")
    for path in REPO.glob(glob)
)]  # fmt: skip
TESTED_WITH_STAND_INS = {
    "docs/client.md": "tests/web/test_web_client.py",
    "docs/bridges.md": "tests/web/test_web_bridges.py",
}
"""Pages whose programs want a server or a sensor, and what runs them."""
LONG, NEVER = re.compile(r"#.*\ba minute\b"), re.compile(r"#.*\b(minutes|hours|needs|Ctrl C)\b")
STAND_IN = re.compile(r"\b[A-Z]{3,}\b")
NOT_OURS = {"ssh", "git", "cd", "torchrun"}
"""What a reader runs elsewhere."""


@dataclass(frozen=True)
class Block:
    """language: "" where the page names none."""

    page: str
    line: int
    language: str
    text: str


def blocks(page: str) -> list[Block]:
    tokens = MarkdownIt().parse((REPO / page).read_text("utf-8"))
    code = [token for token in tokens if token.type in ("fence", "code_block")]
    return [Block(page, (token.map or [0])[0] + 1, token.info, token.content) for token in code]


def lines(block: Block) -> list[str]:
    """The lines that are typed, those joined that go on in the next."""
    return block.text.replace("\\\n", " ").splitlines()


def commands(line: str) -> Iterator[list[str]]:
    """The commands of a line, one by one, as words."""
    words: list[str] = []
    for word in [*shlex.split(line, comments=True), ";"]:
        if word not in (";", "&", "&&", "|"):
            words.append(word)
        elif words:
            yield words
            words = []


class Parsed(BaseException):
    """The command line has taken a command; it is not run."""


def only_parsed(wanted, **how):
    """In place of tyro.cli."""
    if isinstance(wanted, partial):  # tyro would call it

        @wraps(wanted.func)
        def called(*_, **__):
            raise Parsed

        wanted = partial(called, *wanted.args, **wanted.keywords)
    REAL(wanted, **how)
    raise Parsed


REAL = tyro.cli


def taken(argv: list[str], monkeypatch: pytest.MonkeyPatch) -> str | int | None:
    """The exit status of a command that is parsed, and not run."""
    with monkeypatch.context() as patched:
        patched.setattr(tyro, "cli", only_parsed)
        try:
            cli.main(argv)
        except Parsed:
            return 0
        except SystemExit as refused:
            return refused.code


def check(line: str, words: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """A command that the reader is told to type is one that there is."""
    tool, rest = words[0], words[1:]
    if tool == "a1-studio":
        good = (0, 1) if NEVER.search(line) else (0,)  # 1: this machine has not what it needs
        assert taken(rest, monkeypatch) in good
    elif tool == "make":
        targets = re.findall(r"^([\w-]+):", (REPO / "Makefile").read_text(), re.MULTILINE)
        assert set(rest) <= set(targets)
    elif tool == "pip":
        project = tomllib.loads((REPO / "pyproject.toml").read_text())["project"]
        named = re.findall(r"\[(\w+)\]", " ".join(rest))
        assert set(named) <= set(project["optional-dependencies"])
    else:
        assert tool in NOT_OURS, f"{tool}: of which program?"


def in_shell(page: str) -> list[Block]:
    """Blocks of commands; of those without a language the ones that begin with a command."""
    starts = ("a1-studio ", "make ")
    return [
        block for block in blocks(page)
        if block.language == "sh" or (not block.language and block.text.startswith(starts))
    ]  # fmt: skip


def runs(page: str) -> bool:
    """It has programs or commands that are run here."""
    here = page not in TESTED_WITH_STAND_INS
    return here and any(block.language in ("python", "sh") for block in blocks(page))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where a reader is: with the example takes, a clip, and the repository's own examples."""
    kept = shutil.ignore_patterns(".token", ".bin")
    shutil.copytree(REPO / "sessions", tmp_path / "sessions", ignore=kept)
    for name in ("docs/mapper_plugin.py", "models/policy/onnx_runner.py"):
        (tmp_path / name).parent.mkdir(parents=True)
        shutil.copy(REPO / name, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    export_take(Path("sessions"), "example-cmu-march", "bvh", Path("clip.bvh"))
    return tmp_path


def test_a_block_says_what_it_is_in():
    known = {"", "python", "sh", "json"}
    odd = [f"{b.page}:{b.line}" for page in PAGES for b in blocks(page) if b.language not in known]
    assert odd == []


@pytest.mark.parametrize("page", [page for page in PAGES if in_shell(page)])
def test_every_command_of_a_page_is_one_that_there_is(page, monkeypatch):
    for line in (line for block in in_shell(page) for line in lines(block)):
        for words in commands(line):
            check(line, words, monkeypatch)


@pytest.mark.parametrize("page", [page for page in PAGES if runs(page)])
def test_a_pages_programs_and_quick_commands_run(page, folder, capsys):
    run_page(page, capsys, long=False)


@pytest.mark.long
@pytest.mark.timeout(600)
@pytest.mark.parametrize("page", [p for p in PAGES if any(LONG.search(b.text) for b in blocks(p))])
def test_a_pages_commands_of_a_minute_run(page, folder, capsys):
    run_page(page, capsys, long=True)


def run_page(page: str, capsys, *, long: bool) -> None:
    names: dict[str, object] = {"__name__": "page"}
    with patch.dict(SOURCES), patch.dict(TASKS):  # a page may add to them
        for block in blocks(page):
            if block.language == "python" and (long or not LONG.search(block.text)):
                exec(compile(block.text, f"{page}:{block.line}", "exec"), names)
            elif block.language == "sh":
                for line in lines(block):
                    run_line(line, capsys, long=long)


def run_line(line: str, capsys, *, long: bool) -> None:
    if NEVER.search(line) or STAND_IN.search(line.partition("#")[0]):
        return
    if LONG.search(line) and not long:
        return
    for words in commands(line):
        if words[0] == "a1-studio":
            with pytest.raises(SystemExit) as ended:
                cli.main(words[1:])
            assert ended.value.code == 0, (line, capsys.readouterr().err)


def test_pages_that_others_run_are_run_by_them():
    for page, test in TESTED_WITH_STAND_INS.items():
        assert Path(page).name in (REPO / test).read_text("utf-8")


def test_the_citation_is_of_this_version():
    cited = re.findall(r"^version: (.+)$", (REPO / "CITATION.cff").read_text(), re.MULTILINE)
    assert cited == [__version__]


@pytest.mark.slow
def test_the_site_is_built_strictly_and_asks_no_other_server(tmp_path):
    env = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    argv = [sys.executable, "-m", "mkdocs", "build", "--quiet", "--strict", "--site-dir", tmp_path]
    subprocess.run([*argv, "--config-file", REPO / "docs/mkdocs.yml"], check=True, env=env)
    for page in ("index.html", "docs/guide/api.html", "models/policy/index.html"):
        html = (tmp_path / page).read_text("utf-8")
        assert not re.findall(
            r"<(?:script|link|img|iframe)[^>]+(?:src|href)=\"?(?:https?:)?//", html
        )
        assert "<script" in html
