import assert from "node:assert/strict";
import test from "node:test";

import { HISTORY } from "../js/history.js";
import { Signals, csv } from "../js/signals.js";

const yawed = (yaw) => [Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2)];
const pose = (more) => ({
  base_pos: [0, 0, 0.3],
  base_quat: [1, 0, 0, 0],
  base_lin_vel_w: [0, 0, 0],
  joint_pos: Array(12).fill(0),
  foot_pos_w: [
    [0, 0, 0.05],
    [0, 0, 0],
    [0, 0, 0],
    [0, 0, 0],
  ],
  ...more,
});

test("speed is along the heading, turns are per second, the rest in degrees and cm", () => {
  const signals = new Signals();
  for (let i = 0; i < 20; i += 1) {
    const yaw = 3 + (0.6 * i) / 30; // past half a turn
    signals.add({
      index: i + 1,
      t: i / 30,
      reference: pose({ base_quat: yawed(yaw) }),
      robot: pose({
        base_quat: [Math.cos(0.1), Math.sin(0.1), 0, 0],
        base_lin_vel_w: [0.4, 9, 0],
        joint_pos: Array(12).fill(0.1),
      }),
    });
  }
  const last = signals.samples.at(-1);
  const near = (name, value) => assert.ok(Math.abs(last[name] - value) < 1e-6, name);
  near("turn_asked_deg_s", (0.6 * 180) / Math.PI);
  near("turn_done_deg_s", 0);
  near("roll_done_deg", (0.2 * 180) / Math.PI);
  near("speed_done_m_s", 0.4);
  near("height_asked_cm", 30);
  near("paw_right_cm", 5);
  near("joint_error_deg", (0.1 * 180) / Math.PI);
  const lines = csv(signals.times, signals.of).split("\n");
  assert.match(lines[0], /^t_s,speed_asked_m_s,.*,joints_late_ms$/);
  assert.match(lines[1], /^0\.0000,.*,$/); // no lag yet: nothing stands there
  assert.equal(lines.length, 22);
});

test("the lag is by how much the joints are late, and none where nothing moves", () => {
  const signals = new Signals();
  const at = (i, size) => Array(12).fill(size * Math.sin(i / 7));
  const run = (late, size) => {
    signals.clear();
    for (let i = 0; i < HISTORY + 50; i += 1)
      signals.add({
        index: i + 1,
        t: i / 30,
        reference: pose({ joint_pos: at(i, size) }),
        robot: pose({ joint_pos: at(i - late, size) }),
      });
    return signals.lag;
  };
  assert.equal(run(3, 0.3), 100);
  assert.equal(run(0, 0.3), 0);
  assert.equal(run(3, 1e-4), null);
  assert.equal(signals.samples.length, HISTORY);
});

test("ticks counted anew begin anew, and times that repeat do not", () => {
  const signals = new Signals();
  const add = (index, t) => signals.add({ index, t, reference: pose(), robot: pose() });
  for (let i = 1; i < 30; i += 1) add(i, Math.floor(i / 20));
  assert.equal(signals.samples.length, 29);
  assert.ok(signals.samples.every((sample) => Number.isFinite(sample.turn_done_deg_s)));
  add(1, 0);
  assert.equal(signals.samples.length, 1);
});
