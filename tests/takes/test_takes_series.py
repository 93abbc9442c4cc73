"""What was asked and done in a take as numbers over time: as the page plots them live, bounded."""

import json
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from make_ticks import make_ticks

from studio import geometry
from studio.metrics import lag_periods
from studio.paths import package_folder
from studio.robot.a1 import CONTROL_DT
from studio.takes.as_json import tick_dict
from studio.takes.columns import columns
from studio.takes.record.recorder import Recorder
from studio.takes.series import LAG_MOST, LAG_OVER, series
from studio.takes.take import read_take

EXAMPLE = "example-tilt-and-reach"
LIVE = """
import { readFileSync } from "node:fs";
import { Signals } from "SIGNALS";
const signals = new Signals();
const out = JSON.parse(readFileSync(0, "utf8")).map((tick) => {
  signals.add({ ...tick, index: tick.index + 1 });
  return signals.samples.at(-1);
});
console.log(JSON.stringify(out));
"""


@pytest.mark.skipif(shutil.which("node") is None, reason="the page's code runs in node")
def test_a_take_s_signals_are_those_that_the_page_plots_live(tmp_path: Path):
    shutil.copytree(package_folder("sessions") / EXAMPLE, tmp_path / EXAMPLE)
    ticks = [tick_dict(tick) for tick in read_take(tmp_path / EXAMPLE).ticks]
    for i, tick in enumerate(ticks):
        tick |= {"index": i, "t": i / 30}
    found = series(columns(tmp_path / EXAMPLE), 4000)
    signals = (package_folder("web_assets") / "js/signals.js").as_uri()
    done = subprocess.run(
        ["node", "--input-type=module", "-e", LIVE.replace("SIGNALS", signals)],
        input=json.dumps(ticks), capture_output=True, text=True, check=True,
    )  # fmt: skip
    live = json.loads(done.stdout)
    assert set(live[0]) == set(found)
    assert len(live) == len(found["t_s"])
    for name, values in found.items():
        theirs = np.array([np.nan if one[name] is None else one[name] for one in live], float)
        every = 6 if name == "joints_late_ms" else 1  # looked for seldom, live
        ours, theirs = values[every - 1 :: every], theirs[every - 1 :: every]
        # Live values are rounded: a tick of lag may be as good as the next.
        allowed = 34.0 if name == "joints_late_ms" else 0.2 if name.startswith("turn") else 0.01
        np.testing.assert_array_equal(np.isnan(ours), np.isnan(theirs), err_msg=name)
        assert np.nanmax(np.abs(ours - theirs)) < allowed, name
    assert np.nanmax(found["joints_late_ms"]) > 0.0


def test_a_lag_over_the_last_seconds_is_the_metric_s_own():
    table = columns(package_folder("sessions") / EXAMPLE)
    late = series(table, len(table))["joints_late_ms"]
    asked, done = table.rows["reference_joint_pos"], table.rows["robot_joint_pos"]
    seen = np.flatnonzero(np.isfinite(late))[::30]
    assert len(seen) > 3
    for at in seen:
        over = slice(at + 1 - LAG_OVER - LAG_MOST, at + 1)
        whole = 1000.0 * CONTROL_DT * lag_periods(done[over], asked[over], LAG_MOST)
        assert late[at] == pytest.approx(whole, abs=34.0)  # of a few ticks less: one may be as good


def test_what_stands_out_for_one_tick_is_seen_among_few_points_and_in_any_block(tmp_path: Path):
    recorder = Recorder(tmp_path)
    recorder.start(name="long")
    tilted = geometry.quat_from_rpy([1.0, 0.0, 0.0])
    for tick in make_ticks(9000):
        falls = tick.index == 8200  # of the second block
        robot = replace(tick.robot, base_quat=tilted) if falls else tick.robot
        recorder.append(replace(tick, robot=robot))
    recorder.close()
    table = columns(tmp_path / "long")
    few = series(table, 100)
    assert {len(values) for values in few.values()} == {100}
    at = int(np.argmax(few["roll_done_deg"]))
    assert few["roll_done_deg"][at] == pytest.approx(np.degrees(1.0), abs=0.01)
    assert few["t_s"][at] == pytest.approx(8200 / 30, abs=2.0)
    assert np.all(np.diff(few["t_s"]) > 0.0)
    whole = series(table, 9000)
    again = series(replace(table, rows=table.rows[8000:8400]), 9000)
    for name in whole.keys() - {"t_s"}:  # a block knows what came before it
        np.testing.assert_allclose(again[name][110:], whole[name][8110:8400], atol=1e-6)
