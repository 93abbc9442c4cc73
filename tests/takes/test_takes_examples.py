"""The example takes that a fresh clone has can be listed, verified, reviewed and driven by."""

from pathlib import Path

import pytest

from studio.sources import open_source
from studio.takes.commands import list_takes, verify_takes
from studio.takes.session_library import SessionLibrary

SESSIONS = Path(__file__).parents[2] / "sessions"
EXAMPLES = ("example-cmu-march", "example-tilt-and-reach")


def test_both_examples_are_listed_and_whole():
    listed = {take["name"]: take for take in list_takes(SESSIONS)["takes"]}
    assert set(EXAMPLES) <= set(listed)
    for name in EXAMPLES:
        (verified,) = verify_takes(SESSIONS, name=name)["takes"]
        assert verified["complete"]
        assert not verified["problems"]


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_pairs_a_person_with_a_robot_that_moves(name):
    take = SessionLibrary(SESSIONS).read(name)
    assert take.human is not None
    assert take.arrays.robot["joint_pos"].std(axis=0).max() > 0.05
    source = open_source(f"take:{name}", sessions=SESSIONS)
    assert source.read(1.0) is not None
    source.close()


def test_nothing_else_in_the_folder_is_kept_by_git_by_accident():
    ignored = (SESSIONS.parent / ".gitignore").read_text().splitlines()
    assert "sessions/*" in ignored
