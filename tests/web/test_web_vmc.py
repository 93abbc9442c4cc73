"""A virtual character's motion, by VMC over UDP, drives the robot of a running studio."""

import re
import time

import pytest
from served import Served
from vmc_sender import Sender, bones_of, packets

from studio.synthetic.operator import OperatorSource

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]
PERIOD = 1 / 30
PATIENCE = 90.0


@pytest.fixture
def served(tmp_path):
    served = Served(tmp_path, "--source", "operator:quiet")
    try:
        yield served
    finally:
        status, errors = served.close()
    assert status == 0, errors


def test_an_avatar_that_marches_makes_the_robot_walk_and_one_that_leaves_makes_it_stand(served):
    answer = served.client.post("/api/source", json={"source": "vmc:0"})
    assert answer.status_code == 200, answer.text
    state = served.wait(lambda s: s["source"] == "vmc:0")
    assert state["mode"] == "idle"  # until armed, as whatever is not synthetic
    heard = re.search(r"UDP 127\.0\.0\.1:(\d+)", " ".join(state["source_report"]["notes"]))
    assert heard, state["source_report"]
    app, person = Sender(int(heard[1])), OperatorSource("march", seed=3)
    armed = walked = False
    t = 0.0
    while not walked:
        assert t < PATIENCE, served.client.get("/api/state").text
        begun = time.monotonic()
        pose = person.read(t)
        assert pose is not None
        app.send(*packets(t, bones_of(pose.joint_pos_w, seed=1), size=7))
        t += PERIOD
        if not armed and t > 1.0:
            armed = served.client.post("/api/arm").status_code == 200
        walked = any(tick["state"] == "walk" for tick in list(served.ticks.values()))
        time.sleep(max(0.0, PERIOD - (time.monotonic() - begun)))
    app.close()
    stood = served.wait(lambda s: s["state"] == "stand" and s["stale_s"] > 0)
    assert not stood["fallen"]
