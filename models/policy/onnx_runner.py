"""Run an exported policy with onnxruntime and numpy alone, one call per control period (30 Hz).

z: (17,) 12 joint angles, roll, pitch, roll rate, pitch rate, yaw rate. p: (18,) reference: 12
joint angles, base height, roll, pitch, yaw rate, velocity forward and left. rad, m, s; joints in
the manifest's order. Tilts and rates are those of the trunk turned by the inverse of "level_quat".
"""

import json

import numpy as np
import onnxruntime


class Runner:
    """Histories and filter of one robot; `reset` before the first step."""

    def __init__(self, path: str) -> None:
        self.session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
        self.manifest = json.loads(self.session.get_modelmeta().custom_metadata_map["manifest"])
        self.begun = False

    def reset(self, z: np.ndarray, p: np.ndarray) -> None:
        self.z, self.p = np.tile(z, (4, 1)), np.tile(p, (4, 1))
        self.actions = np.zeros((3, 12))
        b, a = self.manifest["filter"]["b"], self.manifest["filter"]["a"]
        self.state = np.stack([(1 - b[0]) * z[:12], (b[2] - a[2]) * z[:12]]).astype(np.float32)
        self.begun = False

    def step(self, z: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(12,) rad for a PD with the manifest's kp and kd."""
        if self.begun:
            self.z, self.p = np.vstack([self.z[1:], z]), np.vstack([self.p[1:], p])
        self.begun = True
        o = np.concatenate([self.z.ravel(), self.actions.ravel(), self.p.ravel()])
        feed = {"observation": o[None], "reference_joint_pos": p[None, :12]}
        feed = {k: v.astype(np.float32) for k, v in feed.items()} | {"filter_state": self.state}
        action, target, self.state = self.session.run(None, feed)
        self.actions = np.vstack([self.actions[1:], action])
        return target[0]
