"""Collecting in a real browser: takes, a repair, a mapper of them, and the robot that follows."""

import time

import numpy as np
import pytest
from browsing import PATIENCE, click, drawn, until
from rendered import RENDERED, closest, errors
from served import Served

from studio.synthetic.operator import FollowingOperator

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

SEED = 2
"""A person who reacts slowly."""


@pytest.fixture
def served(tmp_path):
    """A server that has to end well."""
    served = Served(tmp_path / "sessions", "--source", "operator:quiet", "--seed", str(SEED))
    yield served
    served.end_well()


@pytest.fixture
def page(browsing, served):
    """The page in Chromium, its view drawn."""
    with browsing.page(served, 1100, 700) as page:
        yield drawn(page)


def test_takes_are_collected_repaired_learnt_from_and_the_new_mapper_drives(page, served):
    client, ticks = served.client, served.ticks
    click(page, '#mode [data-mode="collect"]')
    until(page, "() => document.querySelectorAll('#plan .choice').length === 12")
    for _ in range(3):
        click(page, '.choice[data-task="tilt"] button:last-child')
    page.evaluate(
        """() => { document.querySelector('#collect-seconds').value = 4;
        document.querySelector('#collect-preview').checked = false; }"""
    )
    click(page, "#collect-begin")
    for number in range(3):
        until(page, "() => a1studio.state.collect.phase === 'ready'")
        click(page, '[data-action="go"]')
        until(page, "() => a1studio.state.collect.phase === 'countdown'")
        until(page, "() => a1studio.state.collect.phase === 'review'")
        scored = "/^Score \\d+ of 100/.test(document.querySelector('#coach .quality').innerText)"
        until(page, f"() => {scored}")
        page.keyboard.press("k") if number else click(page, '[data-action="keep"]')
    until(page, "() => a1studio.state.collect.phase === 'done'")
    names = client.get("/api/state").json()["collect"]["kept"]
    assert len(names) == 3
    listed = {take["name"]: take for take in client.get("/api/takes").json()}
    assert all(listed[name]["label"] == "tilt" and listed[name]["kept"] for name in names)

    # Trim one by its handle, and take the lag out that it was acted with.
    row = f'#collected li[data-name="{names[0]}"]'
    click(page, f"{row} button")
    until(page, "() => document.querySelector('#align-accept')?.offsetParent")
    lag = client.get(f"/api/takes/{names[0]}/review").json()["found"]["lag"]
    assert lag == pytest.approx(FollowingOperator(seed=SEED).person.delay_s, abs=2.5 / 30.0)
    box = page.evaluate(
        "() => { const b = document.querySelector('#timeline').getBoundingClientRect();"
        " return [b.left, b.top, b.right]; }"
    )
    page.mouse.move(box[2] - 13, box[1] + 8)
    page.mouse.down()
    page.mouse.move(box[2] - 90, box[1] + 8, steps=3)
    page.mouse.up()
    wait(lambda: client.get(f"/api/takes/{names[0]}").json()["trim"])
    trim = client.get(f"/api/takes/{names[0]}").json()["trim"]
    assert trim[0] == 0.0
    assert trim[1] < listed[names[0]]["seconds"] - 0.2
    until(
        page,
        "() => a1studio.state.replay?.name"
        " && document.querySelector('#bench-undo')?.disabled === false",
    )
    click(page, "#align-accept")
    wait(lambda: client.get(f"/api/takes/{names[0]}").json()["lag"])
    assert client.get(f"/api/takes/{names[0]}").json()["lag"] == pytest.approx(lag, abs=0.05)
    until(page, "() => /Aligned by/.test(document.querySelector('#bench-align')?.textContent)")

    # Even out the tempo: either it is, or the page says why not, for a few seconds.
    page.evaluate(
        """() => new MutationObserver((changes) => {
          const said = changes.flatMap(({ addedNodes }) => [...addedNodes]);
          if (said.some(({ innerText }) => /lag alone/.test(innerText))) window.told = true;
        }).observe(document.querySelector('#toasts'), { childList: true })"""
    )
    click(page, "#align-warp")
    bent = "/and warped/.test(document.querySelector('#bench-align')?.textContent)"
    until(page, f"() => {bent} || window.told")
    assert page.evaluate(f"() => {bent}") == client.get(f"/api/takes/{names[0]}").json()["warped"]

    # Scrub: both figures of that time are in the view's tick.
    client.post("/api/seek", json={"t": 3.0, "playing": False})
    until(page, "() => Math.abs(a1studio.tick.t - 3.0) < 0.02 && a1studio.tick.mode === 'replay'")
    assert page.evaluate("() => a1studio.tick.human !== null")
    click(page, "#bench-close")

    # Learn from the three and use what was learnt.
    until(page, "() => document.querySelectorAll('#collected input:checked').length === 3")
    page.evaluate(
        """() => { for (const s of ['walk', 'sit'])
        document.querySelector(`#train-body input[value="${s}"]`).checked = false;
        document.querySelector('#train-steps').value = 60;
        document.querySelector('#train-name').value = 'ada'; }"""
    )
    click(page, "#train-go")
    until(page, "() => document.querySelector('.scores td.best')", 300.0)
    click(page, '#mappers li[data-mapper="ada"] button')
    wait(lambda: client.get("/api/state").json()["mapper"]["name"] == "ada")
    click(page, '#mode [data-mode="live"]')
    until(page, "() => a1studio.state.mode === 'live'")
    assert client.post("/api/source", json={"source": "operator:tilt"}).status_code == 200

    # The robot follows with it: it moves, near its reference, and is drawn where the ticks say.
    begun = max(list(ticks))  # a copy: another thread goes on listening
    wait(lambda: max(list(ticks)) > begun + 240)
    seen = [tick for index, tick in list(ticks.items()) if index > begun + 60]
    reference = np.array([tick["reference"]["joint_pos"] for tick in seen])
    robot = np.array([tick["robot"]["joint_pos"] for tick in seen])
    assert np.ptp(reference, axis=0).max() > np.radians(8.0)
    assert np.degrees(np.sqrt(np.mean((robot - reference) ** 2))) < 8.0
    assert not any(tick["fallen"] for tick in seen)
    assert client.get("/api/state").json()["mapper"] == {
        "name": "ada", "style": "march", "before": "shipped", "refused": {}, "fitting": None,
    }  # fmt: skip
    for _ in range(5):
        rendered = page.evaluate(RENDERED)
        time.sleep(0.5)
        late = [ticks[i] for i in sorted(ticks)[-240:] if ticks[i]["human"]]
        if (error := errors(rendered, closest(rendered, late))).max() < 0.03:
            break
    assert error.max() < 0.03, error
    click(page, "#ab-swap")
    wait(lambda: client.get("/api/state").json()["mapper"]["name"] == "shipped")


def wait(true, seconds: float = PATIENCE) -> None:
    """Until `true()`."""
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline
        time.sleep(0.2)
