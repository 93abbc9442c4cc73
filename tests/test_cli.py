"""The command line: one object out, exit statuses 0, 1 and 2, one line where it fails."""

import json
import os
import shutil
import subprocess
import sys
from typing import get_args

import numpy as np
import pytest

from studio import cli, options
from studio.cli.output import give
from studio.control.controllers import CONTROLLERS
from studio.errors import StudioError
from studio.evaluation.registry import TABLES
from studio.sources import SOURCES


def run(*argv, capsys):
    """(exit status, stdout, stderr) of a command run in this process."""
    with pytest.raises(SystemExit) as stopped:
        cli.main(list(argv))
    out, err = capsys.readouterr()
    return stopped.value.code, out, err


def test_help_lists_every_command_quickly_without_loading_the_studio():
    code = (
        "import sys; from studio import cli\n"
        "try: cli.main(['--help'])\n"
        "except SystemExit as e: status = e.code\n"
        "heavy = {'torch', 'mujoco', 'viser', 'fastapi', 'scipy'} & set(sys.modules)\n"
        "sys.exit(status or len(heavy))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=os.environ, check=False
    )
    assert done.returncode == 0, done.stderr
    for command in ("serve", "drive", "takes", "train", "evaluate", "bench"):
        assert command in done.stdout


def test_the_options_of_serve_are_listed_without_loading_the_page():
    code = (
        "import sys; from studio import cli\n"
        "try: cli.main(['serve', '--help'])\n"
        "except SystemExit as e: status = e.code\n"
        "heavy = {'torch', 'mujoco', 'viser', 'fastapi', 'scipy'} & set(sys.modules)\n"
        "sys.exit(status or len(heavy))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    for option in ("source", "host", "port", "sessions", "token", "style", "controller"):
        assert f"--{option}" in done.stdout


def test_help_lists_every_source_that_the_command_can_follow(capsys):
    for command, sent in (("serve", True), ("drive", False)):
        status, out, _ = run(command, "--help", capsys=capsys)
        assert status == 0
        said = " ".join(out.split())
        for kind in SOURCES.values():
            assert (f"{kind.usage} ({kind.about})" in said) == (sent or not kind.served), command


def test_the_choices_that_help_lists_are_those_that_there_are():
    assert set(get_args(options.ControllerName)) == set(CONTROLLERS)


@pytest.mark.parametrize(
    "argv",
    [
        [],
        ["fly"],
        ["drive"],
        ["drive", "--source", "operator", "--state", "fly"],
        ["drive", "--source", "operator", "--controller", "magic"],
        ["drive", "--source", "operator", "--seconds", "soon"],
        ["drive", "--source", "operator", "--json"],
        ["train"],
        ["train", "dragons"],
        ["takes"],
        ["takes", "burn"],
        ["evaluate"],
        ["evaluate", "nothing"],
        ["evaluate", "nothing", "--json", "-"],
        ["evaluate", "tilt", "--style", "circles"],
        ["evaluate", "endurance", "--clips", "."],
        ["evaluate", "people"],
        ["evaluate", "all", "--style", "circles"],
        ["export"],
        ["export", "mapper"],
    ],
)
def test_bad_usage_is_exit_status_2_and_says_something(argv, capsys):
    status, out, err = run(*argv, capsys=capsys)
    assert status == 2
    assert err.strip()
    assert not out


@pytest.mark.parametrize(
    "argv",
    [
        ["drive", "--source", "telepathy"],
        ["drive", "--source", "bvh:/nowhere/to.bvh"],
        ["drive", "--source", "take:nothing"],
        ["drive", "--source", "stream"],
        ["drive", "--source", "stream", "--seconds", "1"],
        ["drive", "--source", "operator", "--seconds", "-3"],
        ["takes", "show", "nothing"],
        ["evaluate", "endurance", "--source", "telepathy"],
        ["evaluate", "people", "--clips", "/nowhere"],
        ["export", "policy", "--state", "fly"],
        ["report"],
        ["train", "policy", "--state", "sit", "--device", "cuda:99"],
    ],
)
def test_what_fails_is_exit_status_1_and_one_line(argv, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    status, out, err = run(*argv, capsys=capsys)
    assert status == 1
    assert len(err.strip().splitlines()) == 1
    assert not out


def test_an_option_that_a_table_has_not_is_answered_with_those_it_has(capsys):
    err = run("evaluate", "tilt", "--style", "circles", capsys=capsys)[2]
    assert "evaluate tilt takes --seed, --episodes" in err
    status, out, _ = run("evaluate", "endurance", "--help", capsys=capsys)
    assert status == 0
    for option in ("episodes", "seed", "seconds", "source", "controller", "threads"):
        assert f"--{option}" in out
    assert "--clips" not in out


def test_the_tables_are_listed_with_what_they_tell(capsys):
    status, out, _ = run("evaluate", "--help", capsys=capsys)
    assert status == 0
    assert all(f"  {name} " in out for name in (*TABLES, "all"))


def test_a_policy_is_exported_by_a_command(tmp_path, capsys):
    out = tmp_path / "stand.onnx"
    argv = ("export", "policy", "--state", "stand", "--out", str(out), "--json", "-")
    status, text, _ = run(*argv, capsys=capsys)
    assert (status, json.loads(text)["bytes"]) == (0, out.stat().st_size)


def test_json_to_standard_output_is_one_object_and_nothing_else(capsys):
    status, out, _ = run(
        "drive", "--source", "operator:quiet", "--seconds", "0.5", "--json", "-", capsys=capsys
    )
    assert status == 0
    report = json.loads(out)
    assert report["frames"] == 15
    assert report["survived"] is True


def test_json_to_a_file_makes_its_folder(tmp_path, capsys):
    path = tmp_path / "new" / "report.json"
    status, out, _ = run(
        "drive", "--source", "operator:quiet", "--seconds", "0.5", f"--json={path}", capsys=capsys
    )
    assert status == 0
    assert not out
    assert json.loads(path.read_text())["frames"] == 15


def test_a_file_that_cannot_be_written_is_a_failure_in_one_line(tmp_path, capsys):
    status, _, err = run(
        "drive", "--source", "operator:quiet", "--seconds", "0.2", "--json", str(tmp_path),
        capsys=capsys,
    )  # fmt: skip
    assert status == 1
    assert len(err.strip().splitlines()) == 1


def test_a_recorded_drive_is_listed_shown_labelled_and_verified(tmp_path, capsys):
    where = ["--sessions", str(tmp_path), "--json", "-"]
    status, out, _ = run(
        "drive", "--source", "operator:quiet", "--seconds", "1", "--record", *where, capsys=capsys
    )
    assert status == 0
    name = json.loads(out)["take"]
    assert json.loads(run("takes", "list", *where, capsys=capsys)[1])["takes"][0]["name"] == name
    assert run("takes", "label", name, "my first take", *where, capsys=capsys)[0] == 0
    shown = json.loads(run("takes", "show", name, *where, capsys=capsys)[1])
    assert shown["ticks"] == 30
    for argv in (["takes", "verify"], ["takes", "verify", name]):
        status, out, _ = run(*argv, *where, capsys=capsys)
        assert status == 0
        take = json.loads(out)["takes"][0]
        assert {"name", "ticks", "seconds", "complete", "recovered", "problems"} <= set(take)
    (tmp_path / name / "tape.mcap").write_bytes(b"nothing of a tape")
    status, out, err = run("takes", "verify", *where, capsys=capsys)
    assert status == 1
    assert name in err
    assert json.loads(out)["takes"][0]["problems"]


def test_the_command_is_installed_and_gives_its_version():
    script = os.path.join(os.path.dirname(sys.executable), "a1-studio")
    done = subprocess.run([script, "--version"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.strip()) == (0, "a1-studio 0.1.0")


def test_every_failure_message_fits_a_line(monkeypatch, capsys):
    def fails(_):
        raise StudioError("first\n  second")

    monkeypatch.setitem(cli.COMMANDS, "bench", (fails, ""))
    status, _, err = run("bench", capsys=capsys)
    assert status == 1
    assert err == "first second\n"


def test_json_is_strict_null_stands_for_what_is_not_finite(capsys):
    give({"rows": [{"a": float("nan"), "b": np.float32("inf"), "c": (1.5,)}]}, "-")
    out = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert out == {"rows": [{"a": None, "b": None, "c": [1.5]}]}


def test_a_take_is_recorded_exported_into_a_new_folder_and_imported(tmp_path, capsys):
    sessions = ("--sessions", str(tmp_path / "sessions"), "--json", "-")
    drive = ("drive", "--source", "operator:quiet", "--seconds", "0.2", "--record")
    name = json.loads(run(*drive, *sessions, capsys=capsys)[1])["take"]
    out = tmp_path / "new" / "take.csv"
    status, text, _ = run(
        "takes", "export", name, "--format", "csv", "--out", str(out), *sessions, capsys=capsys
    )
    assert status == 0
    assert json.loads(text)["file"] == str(out)
    assert len(out.read_text().splitlines()) == 1 + 6  # a header, then 0.2 s at 30 Hz
    folder = str(tmp_path / "sessions" / name)
    status, text, err = run("takes", "import", folder, "--name", "copy", *sessions, capsys=capsys)
    assert (status, json.loads(text), err) == (0, {"takes": ["copy"]}, "")


def test_of_a_folder_of_takes_the_good_ones_are_imported_and_the_others_named(tmp_path, capsys):
    there = tmp_path / "there"
    drive = ("drive", "--source", "operator:quiet", "--seconds", "0.2", "--record")
    recorded = run(*drive, "--sessions", str(there), "--json", "-", capsys=capsys)
    name = json.loads(recorded[1])["take"]
    (there / "a-bad-one").mkdir()
    (there / "a-bad-one" / "tape.mcap").write_bytes(b"no tape")
    here = ("--sessions", str(tmp_path / "here"), "--json", "-")
    status, out, err = run("takes", "import", str(there), *here, capsys=capsys)
    answer = json.loads(out)
    assert (status, answer["takes"], set(answer["refused"])) == (1, [name], {"a-bad-one"})
    assert "tape.mcap is no tape" in answer["refused"]["a-bad-one"]
    assert "not imported: a-bad-one" in err
    assert (tmp_path / "here" / name / "tape.mcap").is_file()
    shutil.rmtree(there / "a-bad-one")
    status, out, err = run("takes", "import", str(there), *here, capsys=capsys)
    assert (status, json.loads(out), err) == (0, {"takes": [f"{name}-2"], "refused": {}}, "")
    status, _, err = run("takes", "import", str(there), "--name", "x", *here, capsys=capsys)
    assert (status, "leave the name out" in err) == (1, True)


def test_verify_tells_a_folder_of_the_users_own_from_a_take_that_is_lost(tmp_path, capsys):
    (tmp_path / "holiday").mkdir()
    argv = ("takes", "verify", "--sessions", str(tmp_path), "--json", "-")
    assert run(*argv, capsys=capsys)[:2] == (0, json.dumps({"takes": []}, indent=1) + "\n")
    (tmp_path / "lost").mkdir()
    (tmp_path / "lost" / "tape.mcap").write_bytes(b"no tape at all")
    status, out, err = run(*argv, capsys=capsys)
    assert status == 1
    assert [take["name"] for take in json.loads(out)["takes"]] == ["lost"]
    assert len(err.strip().splitlines()) == 1


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="Linux has a disk that is always full")
@pytest.mark.parametrize(
    "argv",
    [
        ("drive", "--source", "operator", "--seconds", "1", "--trace", "/dev/full"),
        ("drive", "--source", "operator", "--seconds", "1", "--json", "/dev/full"),
        ("takes", "list", "--sessions", "nowhere"),
    ],
)
def test_a_full_disk_is_one_line(argv, tmp_path):
    with open("/dev/full", "wb") as full:
        ended = subprocess.run(
            [sys.executable, "-m", "studio", *argv],
            stdout=full if argv[0] == "takes" else subprocess.PIPE, stderr=subprocess.PIPE,
            text=True, check=False, cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        )  # fmt: skip
    assert ended.returncode == 1
    (line,) = ended.stderr.strip().splitlines()
    assert line.startswith("cannot write")
    assert "No space left on device" in line
