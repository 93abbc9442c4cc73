"""`serve --robot`: a robot of another process, by the API; killed, and started anew."""

from pathlib import Path

import pytest
from robots import end, robot
from served import Served


@pytest.mark.slow
def test_a_robot_waits_for_reset_and_arm_is_missed_when_it_is_gone_and_rises_when_asked(
    tmp_path: Path,
):
    body, port = robot()
    served = Served(tmp_path, "--source", "operator:crouch", "--robot", f"udp:127.0.0.1:{port}")
    try:
        state = served.wait(lambda s: s["stopped"])
        assert state["reason"] == "robot"
        assert "switched on" in state["why"]
        told = state["link"]
        assert (told["name"], told["level"]) == (f"udp:127.0.0.1:{port}", "references")
        assert (told["phase"], told["why"], told["silent"]) == ("limp", "switched on", False)
        assert served.client.post("/api/reset").status_code == 200
        assert served.client.post("/api/arm").status_code == 200
        served.wait(lambda s: s["reason"] == "" and s["robot"]["base_pos"][2] > 0.2)
        end(body)
        state = served.wait(lambda s: "silent" in s["why"])
        assert (state["reason"], state["stopped"]) == ("robot", False)
        assert state["link"]["silent"]
        assert state["link"]["heard_s"] > 0.3
        body, _ = robot(port)
        state = served.wait(lambda s: s["stopped"])
        assert "switched on" in state["why"]
        served.client.post("/api/reset")
        served.client.post("/api/arm")
        served.wait(lambda s: s["reason"] == "" and s["robot"]["base_pos"][2] > 0.2)
        assert served.client.post("/api/stop").status_code == 200
        served.wait(lambda s: s["stopped"] and s["robot"]["base_pos"][2] < 0.17)
    finally:
        served.close()
        end(body)
