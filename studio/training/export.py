"""A trained policy → one ONNX file with all a real A1 needs: normaliser, network, filter, gains.

Inputs of a control period: observation (1, dim), reference_joint_pos (1, 12) rad, filter_state
(2, 12). Outputs: action (1, 12) for the next observations, target (1, 12) rad for the PD, and the
next filter_state. The metadata entry "manifest" says what the observation holds, the rates and
gains. `models/policy/onnx_runner.py` runs it without this package.

    a1-studio export policy --state walk --out walk.onnx
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper
from scipy.signal import butter

from studio.control.action import ACTION_CLIP
from studio.control.observation import HEADING_CLIP
from studio.control.policy import Policy, Symmetric
from studio.control.symmetry import observation_mirror
from studio.errors import StudioError
from studio.files import whole
from studio.robot import a1
from studio.robot.a1 import MIRROR_JOINT, MIRROR_SIGN


@dataclass(frozen=True, kw_only=True)
class PolicyExport:
    """Write a policy as one ONNX file with all that a real A1 needs."""

    state: str = "walk"
    """Which expert: stand, walk, sit, or a path to its weights."""
    out: Path | None = None
    """The file (default: STATE.onnx here)."""


def run_export_policy(config: PolicyExport) -> dict[str, Any]:
    """Write the file: `{"file", "state", "bytes"}`. StudioError if there is no such policy."""
    out = export_onnx(config.state, config.out or Path(f"{Path(config.state).stem}.onnx"))
    return {"file": str(out), "state": config.state, "bytes": out.stat().st_size}


def export_onnx(name: str | Path, out: Path) -> Path:
    """Write the policy NAME (or a path to its weights) to `out`; returns `out`.

    StudioError if there is no such policy.
    """
    policy = Policy.load(name)
    if policy.observation.future:
        raise StudioError("a policy that is given its future cannot be exported: train one without")
    config = policy.action_config
    coefficients = butter(2, config.cutoff_hz, fs=a1.CONTROL_HZ)
    b, a = (np.asarray(c) for c in cast(tuple[Any, Any], coefficients))
    graph = _Graph()
    layers = policy.layers
    graph.constant("mean", layers.mean[None])
    graph.constant("scale", layers.scale[None])
    for i, (weight, bias) in enumerate(zip(layers.weights, layers.biases, strict=True)):
        graph.constant(f"weight_{i}", weight)
        graph.constant(f"bias_{i}", bias)
    x = graph.network("observation", len(layers.weights))
    if isinstance(policy.network, Symmetric):
        index, sign = observation_mirror(policy.observation)
        other = graph.network(graph.mirrored("observation", index, sign), len(layers.weights))
        both = graph.op("Add", x, graph.mirrored(other, MIRROR_JOINT, MIRROR_SIGN))
        graph.constant("half", np.float32(0.5))
        x = graph.op("Mul", both, "half")
    bounds = {"lo": -ACTION_CLIP, "hi": ACTION_CLIP, "action_scale": config.scale}
    for key, value in bounds.items():
        graph.constant(key, np.float32(value))
    graph.op("Clip", x, "lo", "hi", out="action")
    offset = "reference_joint_pos"
    if config.mode == "absolute":
        offset = "neutral"
        graph.constant(offset, policy.neutral[None])
    graph.constant("lower", a1.JOINT_LOWER[None])
    graph.constant("upper", a1.JOINT_UPPER[None])
    raw = graph.op("Add", offset, graph.op("Mul", "action", "action_scale"))
    raw = graph.op("Min", graph.op("Max", raw, "lower"), "upper")
    # y = b0 x + s1;  s1' = b1 x − a1 y + s2;  s2' = b2 x − a2 y (direct form II, transposed)
    for key, value in (("b0", b[0]), ("b1", b[1]), ("b2", b[2]), ("a1", a[1]), ("a2", a[2])):
        graph.constant(key, np.float32(value))
    graph.constant("row0", np.array([0], dtype=np.int64))
    graph.constant("row1", np.array([1], dtype=np.int64))
    s1, s2 = (graph.op("Gather", "filter_state", row) for row in ("row0", "row1"))
    y = graph.op("Add", graph.op("Mul", raw, "b0"), s1)
    n1 = graph.op("Sub", graph.op("Mul", raw, "b1"), graph.op("Mul", y, "a1"))
    n2 = graph.op("Sub", graph.op("Mul", raw, "b2"), graph.op("Mul", y, "a2"))
    graph.op("Concat", graph.op("Add", n1, s2), n2, out="next_filter_state", axis=0)
    graph.op("Min", graph.op("Max", y, "lower"), "upper", out="target")
    facts = {
        **policy.manifest,
        "filter": {"order": 2, "cutoff_hz": config.cutoff_hz, "b": b.tolist(), "a": a.tolist()},
        "filter_rest": "state rows: (1 - b0) q and (b2 - a2) q hold still at q",
        "hold": {
            "heading_gain": policy.observation.heading_gain,
            "tau": policy.observation.hold_tau,
            "heading_smooth": policy.observation.heading_smooth,
            "heading_clip": HEADING_CLIP,
        },
        "joint_lower": a1.JOINT_LOWER.tolist(),
        "joint_upper": a1.JOINT_UPPER.tolist(),
        "torque_limit": a1.TORQUE_LIMIT.tolist(),
    }
    facts.pop("curve", None)
    model = graph.model(policy.observation.dim)
    helper.set_model_props(model, {"manifest": json.dumps(facts)})
    onnx.checker.check_model(model)
    with whole(out, parents=True) as scratch:
        onnx.save(model, scratch)
    return out


class _Graph:
    """Nodes and constants of an ONNX graph, named as they come."""

    def __init__(self) -> None:
        self.nodes: list[Any] = []
        self.constants: list[Any] = []

    def constant(self, name: str, value: Any) -> None:
        value = np.asarray(value)
        kind = np.int64 if value.dtype == np.int64 else np.float32
        self.constants.append(numpy_helper.from_array(value.astype(kind), name))

    def op(self, kind: str, *inputs: str, out: str = "", **attributes: Any) -> str:
        out = out or f"v{len(self.nodes)}"
        self.nodes.append(helper.make_node(kind, list(inputs), [out], **attributes))
        return out

    def network(self, x: str, layers: int) -> str:
        """Normaliser and layers, whose constants are there already."""
        x = self.op("Mul", self.op("Sub", x, "mean"), "scale")
        for i in range(layers):
            x = self.op("Gemm", x, f"weight_{i}", f"bias_{i}")
            if i < layers - 1:
                x = self.op("Relu", x)
        return x

    def mirrored(self, x: str, index: Any, sign: Any) -> str:
        """x (1, n) with left and right exchanged."""
        self.constant(f"{x}_index", np.asarray(index, dtype=np.int64))
        self.constant(f"{x}_sign", np.asarray(sign)[None])
        return self.op("Mul", self.op("Gather", x, f"{x}_index", axis=1), f"{x}_sign")

    def model(self, dim: int) -> onnx.ModelProto:
        def value(name: str, *shape: int) -> Any:
            return helper.make_tensor_value_info(name, TensorProto.FLOAT, list(shape))

        graph = helper.make_graph(
            self.nodes,
            "a1_policy",
            [
                value("observation", 1, dim),
                value("reference_joint_pos", 1, 12),
                value("filter_state", 2, 12),
            ],
            [value("action", 1, 12), value("target", 1, 12), value("next_filter_state", 2, 12)],
            self.constants,
        )
        return helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
