// Where an A1's feet are: its legs' geometry, as `studio/robot/legs.py` has it.

import { turned } from "./motion.js";

/** @import { Pose } from "../types/page.js" */

/** m: from the trunk's middle to a hip, from its axis to the leg's plane, and both bones. */
const [AHEAD, ASIDE] = [0.1805, 0.047];
const OUT = 0.0838;
const BONE = 0.2;
/** FR, FL, RR, RL. */
const LEGS = [
  [1, -1],
  [1, 1],
  [-1, -1],
  [-1, 1],
];

/** (4, 3) m, in the world. @param {Pick<Pose, "base_pos" | "base_quat" | "joint_pos">} pose */
export const feetOf = ({ base_pos, base_quat, joint_pos }) =>
  LEGS.map(([front, left], i) => {
    const [hip, thigh, calf] = joint_pos.slice(3 * i, 3 * i + 3);
    const y = left * OUT;
    const z = -BONE * (Math.cos(thigh) + Math.cos(thigh + calf));
    const foot = turned(base_quat, [
      front * AHEAD - BONE * (Math.sin(thigh) + Math.sin(thigh + calf)),
      left * ASIDE + y * Math.cos(hip) - z * Math.sin(hip),
      y * Math.sin(hip) + z * Math.cos(hip),
    ]);
    return foot.map((c, k) => base_pos[k] + c);
  });
