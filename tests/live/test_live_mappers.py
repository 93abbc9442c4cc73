"""Mappers to compare with, in the live loop: fitted, kept, refused, and left again."""

import threading
import time
from pathlib import Path

import numpy as np
import pytest
from fake_clock import FakeClock
from turning import ask, run

from studio.errors import StudioError
from studio.human.features import FEATURE_DIM
from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.mappers import is_rival, list_rivals, open_chosen, open_given
from studio.live.runtime import Runtime, RuntimeConfig
from studio.retarget.baselines.registry import RIVALS
from studio.retarget.store import style_dir
from studio.training.collected import TakesTraining, run_train_takes

PLUGIN = Path(__file__).parents[2] / "docs" / "mapper_plugin.py"


@pytest.fixture
def loop(tmp_path):
    config = RuntimeConfig(source="operator:walk", sessions=tmp_path / "sessions")
    made = LiveLoop(clock=FakeClock(), runtime=Runtime(config))
    made.runtime.mappers.fitting.seconds = 30.0
    yield made
    made.runtime.close()


def mapped_by(loop) -> dict[str, str]:
    experts = loop.runtime.puppeteer.retargeter.experts
    return {state: type(expert).__name__ for state, expert in experts.mappers.items()}


@pytest.mark.slow
def test_a_rival_is_fitted_drives_leaves_what_it_refuses_to_the_shipped_and_can_be_left(loop):
    run(loop, 1.0)
    assert ask(loop, c.SetMapper(name="kim2020")).ok
    assert mapped_by(loop) == {"stand": "Mapper", "walk": "Kim2020", "sit": "Mapper"}
    ticks = run(loop, 6.0)
    in_use = loop.state_dict()["mapper"]
    assert (in_use["name"], in_use["before"], in_use["fitting"]) == ("kim2020", "shipped", None)
    assert set(in_use["refused"]) == {"stand", "sit"}
    assert "maps cycles alone" in in_use["refused"]["sit"]
    went = np.linalg.norm(ticks[-1].robot.base_pos[:2] - ticks[0].robot.base_pos[:2])
    assert went > 0.3
    assert not any(tick.fallen for tick in ticks)

    assert ask(loop, c.MapperBack()).ok
    assert set(mapped_by(loop).values()) == {"Mapper"}
    assert loop.state_dict()["mapper"]["refused"] == {}
    kept = loop.runtime.mappers.fitting.fitted("kim2020", "march")
    assert ask(loop, c.SetMapper(name="kim2020")).ok
    experts = loop.runtime.puppeteer.retargeter.experts
    assert experts is kept[0], "it was fitted again"


@pytest.mark.slow
def test_whoever_chooses_another_mapper_meanwhile_is_not_overtaken_by_the_rival(loop):
    answers = []
    fitting = loop.runtime.mappers.fitting
    waits = threading.Thread(
        target=lambda: answers.append(loop.submit(c.SetMapper(name="dontcheva2003")))
    )
    waits.start()
    deadline = time.monotonic() + 60.0
    while fitting.name != "dontcheva2003":
        assert time.monotonic() < deadline
        time.sleep(0.01)
    run(loop, 0.1)
    assert loop.state_dict()["mapper"]["fitting"] == "dontcheva2003"
    assert ask(loop, c.SetMapper(name="shipped")).ok
    waits.join(60.0)
    assert not answers[0].ok
    assert "dontcheva2003 was not fitted" in answers[0].why
    assert fitting.name is None
    assert set(mapped_by(loop).values()) == {"Mapper"}


def test_a_mapper_that_is_not_there_is_answered_with_all_that_are(loop):
    why = ask(loop, c.SetMapper(name="merlin")).why
    assert "unknown mapper 'merlin'" in why
    assert all(name in why for name in ("shipped", *RIVALS))
    # Code of somebody's own is named by whoever starts the studio, never by a page.
    assert "no name for a mapper" in ask(loop, c.SetMapper(name=f"{PLUGIN}:Bow")).why


def test_one_s_own_mapper_of_a_rival_s_name_comes_first(tmp_path):
    assert is_rival(tmp_path, "ridge")
    folder = tmp_path / "mappers" / "ridge"
    folder.mkdir(parents=True)
    for file in style_dir("march").iterdir():
        (folder / file.name).write_bytes(file.read_bytes())
    (folder / "mapper.json").write_text("{}")
    assert not is_rival(tmp_path, "ridge")
    assert "ridge" not in [rival["name"] for rival in list_rivals(tmp_path)]


@pytest.mark.parametrize("name", ["shipped", "expert", "kim2020"])
def test_a_new_mapper_may_not_be_called_as_one_that_comes_with_the_studio(tmp_path, name):
    training = TakesTraining(takes=("some",), sessions=tmp_path, name=name)
    with pytest.raises(StudioError, match="comes with the studio"):
        run_train_takes(training)


def test_a_mapper_of_a_file_is_given_at_the_start_and_can_be_chosen_again(loop):
    mappers = loop.runtime.mappers
    name = f"{PLUGIN}:Bow"
    given = open_given(loop.config.sessions, name, "march", mappers)
    assert set(given.refused) == {"walk", "sit"}
    assert open_chosen(loop.config.sessions, name, "march", mappers) is given
    said = given.experts.mappers["stand"](np.zeros((1, 3 * FEATURE_DIM)))
    assert said.joint_pos.shape == (1, 12)


def test_each_rival_says_what_it_is_and_those_of_the_paper_whose_and_their_limits(tmp_path):
    listed = {rival["name"]: rival for rival in list_rivals(tmp_path)}
    assert set(listed) == set(RIVALS)
    for rival in listed.values():
        assert rival["title"]
        assert rival["given"]
        if rival["letter"]:
            assert "20" in rival["source"]
            assert rival["limits"].endswith(".")
