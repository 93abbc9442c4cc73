"""Run an exported policy with onnxruntime and numpy alone, one call per control period (30 Hz).

z: (17,) 12 joint angles, roll, pitch, roll rate, pitch rate, yaw rate. p: (18,) reference: 12
joint angles, base height, roll, pitch, yaw rate, velocity forward and left.
rad, m, s; joints in the manifest's order. Tilts and rates are those of the trunk turned by the
inverse of "level_quat".
"""

import json

import numpy as np
import onnxruntime


class Runner:
    """Histories and filter of one robot; `reset` before the first step."""

    def __init__(self, path: str) -> None:
        self.session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
        self.manifest = json.loads(self.session.get_modelmeta().custom_metadata_map["manifest"])

    def reset(self, z: np.ndarray, p: np.ndarray) -> None:
        self.z, self.p, self.actions = np.tile(z, (4, 1)), np.tile(p, (4, 1)), np.zeros((3, 12))
        b, a = self.manifest["filter"]["b"], self.manifest["filter"]["a"]
        self.state = np.stack([(1 - b[0]) * z[:12], (b[2] - a[2]) * z[:12]]).astype(np.float32)
        self.begun, self.heading, self.steering = False, 0.0, 0.0

    def step(self, z: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(12,) rad for a PD with the manifest's kp and kd."""
        if self.begun:
            self.z = np.vstack([self.z[1:], z])
            self.p = np.vstack([self.p[1:], self._held(z, p)])
        self.begun = True
        o = np.concatenate([self.z.ravel(), self.actions.ravel(), self.p.ravel()])
        feed = {"observation": o[None], "reference_joint_pos": p[None, :12]}
        feed = {k: v.astype(np.float32) for k, v in feed.items()} | {"filter_state": self.state}
        action, target, self.state = self.session.run(None, feed)
        self.actions = np.vstack([self.actions[1:], action])
        return target[0]

    def _held(self, z: np.ndarray, p: np.ndarray) -> np.ndarray:
        """p with what the robot has missed of its heading made up for."""
        hold, dt = self.manifest["hold"], 1.0 / self.manifest["control_hz"]
        keep, turn, p = 1.0 - dt / hold["tau"], z[16] * dt, np.array(p)
        error = keep * (self.heading + p[15] * dt - turn)
        self.heading = min(max(error, -hold["heading_clip"]), hold["heading_clip"])
        self.steering += (self.heading - self.steering) * dt / max(hold["heading_smooth"], dt)
        p[15] += hold["heading_gain"] * self.steering
        return p
