"""Importing in a real browser: folders, zips, motions become takes; what cannot says why."""

import json
import shutil
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from acted_takes import acted_take, record
from browsing import click, drawn, until
from served import Served

from studio.takes.export.bvh import write_bvh

pytestmark = [pytest.mark.browser, pytest.mark.timeout(600)]


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> Path:
    """Recorded elsewhere: a folder of two takes, zips, motions, and what is none of them."""
    root = tmp_path_factory.mktemp("elsewhere")
    acted = acted_take("manipulate_left", np.random.default_rng(0), lag=0.3, seconds=3.0)
    for name in ("day/reach one", "day/two"):
        record(acted, root, "t", keep=True)
        shutil.rmtree(root / name, ignore_errors=True)
        (root / "day").mkdir(exist_ok=True)
        (root / "t").rename(root / name)
    shutil.rmtree(root / ".cache", ignore_errors=True)
    (root / "day" / "notes.txt").write_text("no take")
    newer = json.loads((root / "day/two/meta.json").read_text()) | {
        "format_version": 2, "studio_version": "3.1",
    }  # fmt: skip
    with zipfile.ZipFile(root / "both.zip", "w") as archive:
        for file in (root / "day/two").iterdir():
            archive.write(file, f"../../../outside/{file.name}")
        archive.write(root / "day/two/tape.mcap", "tomorrow/tape.mcap")
        archive.writestr("tomorrow/meta.json", json.dumps(newer))
    with zipfile.ZipFile(root / "tomorrow.zip", "w") as archive:
        archive.write(root / "day/two/tape.mcap", "tomorrow/tape.mcap")
        archive.writestr("tomorrow/meta.json", json.dumps(newer))
    t = np.arange(len(acted.human_pos)) / 30.0
    write_bvh(root / "waving.bvh", acted.human_pos, 1.0 / 30.0)
    rows = [
        {"t": float(at), "skeleton": "studio", "positions": pose.tolist()}
        for at, pose in zip(t, acted.human_pos, strict=True)
    ]
    (root / "kinect.jsonl").write_text("\n".join(map(json.dumps, rows)))
    (root / "torn.zip").write_bytes((root / "both.zip").read_bytes()[:400])
    (root / "broken.bvh").write_text("HIERARCHY\nROOT Hips\n{\n")
    (root / "photo.png").write_bytes(b"\x89PNG")
    return root


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    served = Served(tmp_path_factory.mktemp("root") / "sessions", "--source", "operator:quiet")
    yield served
    served.end_well()


@pytest.fixture(scope="module")
def page(browsing, served):
    with browsing.page(served, 1300, 900) as page:
        drawn(page)
        click(page, '#mode [data-mode="collect"]')
        until(page, "() => document.body.dataset.work === 'collect'")
        yield page


def settled(page, count: int) -> list[tuple[str, str, str]]:
    """(name, what became of it, words) of each import, once `count` of them have ended."""
    until(
        page,
        f"() => document.querySelectorAll('#imports .done, #imports .failed').length === {count}",
    )
    rows = page.evaluate(
        """() => [...document.querySelectorAll('#imports li')].map((li) =>
        [li.querySelector('b').textContent, li.className, li.querySelector('span').textContent])"""
    )
    page.evaluate("() => document.querySelectorAll('#imports .away').forEach((b) => b.click())")
    return [tuple(row) for row in rows]


def takes(served) -> dict[str, dict]:
    return {take["name"]: take for take in served.client.get("/api/takes").json()}


def test_folders_zips_and_motions_become_takes_that_can_be_reviewed(page, served, files):
    page.set_input_files("#import-dir", str(files / "day"))
    rows = settled(page, 2)
    assert {row[1] for row in rows} == {"import done"}
    found = takes(served)
    assert set(found) == {"reach-one", "two"}
    assert found["two"]["kept"] is True
    assert found["two"]["label"] == "manipulate_left"
    until(page, """() => document.querySelector('#collected li[data-name="reach-one"]')""")

    # A motion file beside the robot of a take is a take of both; alone, its robot stands by.
    page.focus("#import-robot")
    until(page, """() => document.querySelector('#import-robot option[value="two"]')""")
    page.select_option("#import-robot", "two")
    page.set_input_files("#import-files", str(files / "waving.bvh"))
    ((name, kind, said),) = settled(page, 1)
    assert (name, kind) == ("waving.bvh", "import done")
    beside = said.removeprefix("is take ")
    assert takes(served)[beside]["label"] == "manipulate_left"
    page.select_option("#import-robot", "")
    page.set_input_files("#import-files", [str(files / "kinect.jsonl"), str(files / "both.zip")])
    rows = settled(page, 3)
    assert [row[1] for row in rows] == ["import done", "import done", "import failed"]
    assert "recorded with (3.1), export the person there" in rows[2][2]
    found = takes(served)
    assert "outside" in found
    assert len(found) == 5
    sessions = served.sessions
    assert {p.name for p in sessions.parent.iterdir()} == {sessions.name}

    # And they are reviewed as any other.
    click(page, '#collected li[data-name="outside"] button')
    until(page, "() => document.querySelector('#align-accept')?.offsetParent")
    until(page, "() => a1studio.state.replay?.name === 'outside'")
    click(page, "#bench-close")


def test_takes_are_found_by_words_and_stay_ticked_out_of_sight(page, served):
    until(page, "() => document.querySelectorAll('#collected li[data-name]').length === 5")
    ticked = page.inner_text("#train-takes")
    page.fill("#collected-find", "manipulate left TWO")
    assert page.evaluate(
        "() => [...document.querySelectorAll('#collected li')].map((li) => li.dataset.name)"
    ) == ["two"]
    assert page.inner_text("#collected-shown") == "Showing 1 of 1 found among 5"
    assert page.inner_text("#train-takes") == ticked
    page.fill("#collected-find", "")
    assert page.locator("#collected li").count() == 5
    assert page.inner_text("#collected-shown") == ""


def test_one_flaw_is_cut_out_by_its_button_and_undone(page, served, tmp_path):
    acted = acted_take(
        "tilt", np.random.default_rng(4), lag=0.3, idle_gestures=False, sensor="mocap"
    )
    pos = acted.human_pos.copy()
    pos[60:90], pos[150:180] = pos[60], pos[150]
    record(replace(acted, human_pos=pos), tmp_path, "flawed")
    page.set_input_files("#import-dir", str(tmp_path))
    assert settled(page, 1)[0][1] == "import done"
    click(page, '#collected li[data-name="flawed"] button')
    until(page, "() => document.querySelectorAll('#bench-found .one').length > 1")
    count = page.locator("#bench-found .one").count()
    click(page, "#bench-found .one")
    until(page, f"() => document.querySelectorAll('#bench-found button').length < {count + 1}")
    assert takes(served)["flawed"]["undoable"] == 1
    click(page, "#bench-undo")
    until(page, f"() => document.querySelectorAll('#bench-found .one').length === {count}")
    click(page, "#bench-close")


def test_what_cannot_be_imported_says_why_and_leaves_nothing(page, served, browsing, files):
    before = takes(served)
    named = ("tomorrow.zip", "torn.zip", "broken.bvh")
    with browsing.expecting("status of 422"):
        page.set_input_files("#import-files", [str(files / name) for name in named])
        rows = {name: (kind, said) for name, kind, said in settled(page, 3)}
    assert {kind for kind, _ in rows.values()} == {"import failed"}
    assert "has format 2, this studio reads 1" in rows["tomorrow.zip"][1]
    assert "s no zip that can be read" in rows["torn.zip"][1]
    assert rows["broken.bvh"][1].startswith("Line 3: the file ends here")
    page.set_input_files("#import-files", str(files / "photo.png"))
    ((_, kind, said),) = settled(page, 1)
    assert kind == "import failed"
    assert "Cannot be imported: give folders of takes" in said
    assert takes(served) == before
    assert not list(served.sessions.glob(".import-*"))


def test_what_is_dropped_on_the_page_is_imported(page, served, files):
    before, source = set(takes(served)), served.client.get("/api/state").json()["source"]
    page.evaluate(
        """(rows) => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([rows], 'dropped.jsonl'));
        for (const kind of ['dragenter', 'dragover', 'drop'])
          window.dispatchEvent(new DragEvent(kind, { dataTransfer: transfer, cancelable: true }));
        }""",
        (files / "kinect.jsonl").read_text(),
    )
    ((name, kind, said),) = settled(page, 1)
    assert (name, kind) == ("dropped.jsonl", "import done")
    assert set(takes(served)) - before == {said.removeprefix("is take ")}
    assert page.is_hidden("#drop")
    assert served.client.get("/api/state").json()["source"] == source
