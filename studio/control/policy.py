"""A trained expert: reference and robot in, PD target out, in numpy from safetensors."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.numpy import load_file, save_file

from studio.control.action import ActionConfig, clip_action, pd_target
from studio.control.observation import History, ObservationConfig
from studio.control.observation_frame import one_reference_frame, one_sensor_frame
from studio.control.symmetry import observation_mirror
from studio.errors import StudioError
from studio.files import whole, write_whole
from studio.geometry import scalars
from studio.paths import package_folder
from studio.reference.intent import STATES
from studio.robot import a1
from studio.robot.a1 import MIRROR_JOINT, MIRROR_SIGN
from studio.robot.pose import ReferencePose, RobotState
from studio.takes.untrusted import read_json

Array = NDArray[np.float64]
MODELS = package_folder("models") / "policy"
_MANIFEST = msgspec.json.Decoder(dict[str, Any])


class Network:
    """Normaliser and layers: (N, dim) float32 to (N, 12); remembers nothing."""

    def __init__(self, tensors: dict[str, NDArray[np.float32]]) -> None:
        self.mean, self.scale = tensors["mean"], 1.0 / tensors["std"]
        count = sum(name.startswith("weight") for name in tensors)
        self.weights = [np.ascontiguousarray(tensors[f"weight_{i}"].T) for i in range(count)]
        self.biases = [tensors[f"bias_{i}"] for i in range(count)]

    def __call__(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """ReLU layers over the normalised observation, the last one linear."""
        x = (observation - self.mean) * self.scale
        for weight, bias in zip(self.weights[:-1], self.biases[:-1]):
            x = np.maximum(x @ weight + bias, 0.0)
        return x @ self.weights[-1] + self.biases[-1]


class Symmetric:
    """A network and its mirror image, averaged: ½ (π(o) + M π(M o)), M left and right exchanged.

    What a network has learnt to the left it then also does to the right.
    """

    def __init__(self, network: Network, observation: ObservationConfig) -> None:
        self.network = network
        index, sign = observation_mirror(observation)
        self._index, self._sign = index, sign.astype(np.float32)
        self._joint_sign = MIRROR_SIGN.astype(np.float32)

    def __call__(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """As the network: (N, dim) float32 to (N, 12)."""
        both = np.concatenate([observation, observation[:, self._index] * self._sign])
        action = self.network(both)
        half = len(observation)
        both_sides = action[:half] + action[half:][:, MIRROR_JOINT] * self._joint_sign
        return np.multiply(both_sides, 0.5, dtype=np.float32)


class Policy:
    """One expert and the history it sees. One thread only; `reset` before the first action."""

    def __init__(self, tensors: dict[str, NDArray[np.float32]], manifest: dict[str, Any]) -> None:
        self.manifest, self._tensors = manifest, tensors
        self.observation = _observed(manifest["observation"])
        self.layers = Network(tensors)
        self.network: Network | Symmetric = self.layers
        if manifest.get("symmetric", False):
            self.network = Symmetric(self.layers, self.observation)
        self.action_config = ActionConfig(**manifest["action"])
        self._level = scalars.rows(manifest["level_quat"])
        self.neutral = np.array(manifest["neutral_joint_pos"], dtype=np.float64)
        self.history = History(1, self.observation)
        self._begun = False

    @classmethod
    def load(cls, name: str | Path) -> "Policy":
        """From models/policy/NAME.safetensors and its sidecar NAME.json, or from a path.

        StudioError if either is missing or damaged.
        """
        path = Path(name)
        if path.suffix != ".safetensors":
            path = MODELS / f"{name}.safetensors"
        try:
            with np.errstate(all="ignore"):
                policy = cls(load_file(path), read_json(path.with_suffix(".json"), _MANIFEST))
                policy.try_out()
            return policy
        except FileNotFoundError as error:
            names = sorted(p.stem for p in MODELS.glob("*.safetensors")) or ["none yet"]
            raise StudioError(
                f"no policy {str(name)!r}; trained: {', '.join(names)}; "
                f"`a1-studio train policy --state {'|'.join(STATES)}` makes one"
            ) from error
        except (SafetensorError, OSError, LookupError, ValueError, TypeError) as error:
            raise StudioError(f"policy {path} cannot be read: {error}; train it again") from error

    def try_out(self) -> None:
        """ValueError unless a target that the robot can be given comes out of it."""
        said = self.network(np.zeros((1, self.observation.dim), dtype=np.float32))
        at = np.zeros((1, a1.NUM_JOINTS))
        target = pd_target(
            clip_action(said.astype(np.float64)), at, self.neutral, self.action_config
        )
        level = np.array(self.manifest["level_quat"], dtype=np.float64)
        values = (said, target, level, self.neutral)
        if [np.shape(x) for x in values] != [(1, 12), (1, 12), (4,), (12,)]:
            raise ValueError("its answers are of another shape")
        if not all(np.isfinite(x).all() for x in values) or not level.any():
            raise ValueError("its answers are not finite")

    def observing(self, observation: ObservationConfig) -> "Policy":
        """The same network behind other gains of the observation (its blocks must stay)."""
        assert observation.dim == self.observation.dim
        manifest = {**self.manifest, "observation": asdict(observation)}
        return Policy(self._tensors, manifest)

    def reset(self, reference: ReferencePose, robot: RobotState) -> None:
        """Forget the past; the history is filled with the present."""
        z, p = self._frames(reference, robot)
        self.history.reset(slice(None), z, p)
        self._begun = False

    def action(self, reference: ReferencePose, robot: RobotState) -> Array:
        """(12,) rad, the PD target before low-pass and limits.

        Exactly what the environment does in training: the reference and the robot enter the
        history, the network acts on it, its output is remembered and added to the reference.
        Raises StudioError for a policy that is to see its reference's future.
        """
        if self.observation.future:
            raise StudioError("this policy needs the true future: only `evaluate` can give it that")
        z, p = self._frames(reference, robot)
        if self._begun:
            self.history.push(z, p)
        else:
            # The first frame of an episode fills the history, as in training.
            self.history.reset(slice(None), z, p)
            self._begun = True
        output = clip_action(self.network(self.history.observation()).astype(np.float64))
        self.history.push_action(output)
        return pd_target(output, p[:, :12], self.neutral, self.action_config)[0]

    def _frames(self, reference: ReferencePose, robot: RobotState) -> tuple[Array, Array]:
        z = one_sensor_frame(robot, self._level, self.observation.yaw_rate)
        return z[None], one_reference_frame(reference, self._level)[None]


def _observed(saved: dict[str, Any]) -> ObservationConfig:
    """As a sidecar tells it; up to 0.1 they said how much a policy holds its place, too."""
    fields = dict(saved)
    if fields.pop("place_gain", 0.0):
        raise ValueError("it holds its place, which made robots fall and is no longer supported")
    return ObservationConfig(**fields)


def manifest_of(
    state: str,
    observation: ObservationConfig,
    action: ActionConfig,
    level: Array,
    neutral: Array,
    **facts: Any,
) -> dict[str, Any]:
    """Everything needed to run the weights elsewhere, and where they come from (`facts`).

    level: (4,) T_level_base of the state. neutral: (12,) rad.
    """
    return {
        "state": state,
        "observation": asdict(observation),
        "observation_blocks": observation.manifest(),
        "action": asdict(action),
        "level_quat": [float(v) for v in level],
        "neutral_joint_pos": [float(v) for v in neutral],
        "joints": list(a1.JOINTS),
        "control_hz": a1.CONTROL_HZ,
        "kp": a1.KP,
        "kd": a1.KD,
        **facts,
    }


def save_policy(
    path: Path, tensors: dict[str, NDArray[np.float32]], manifest: dict[str, Any]
) -> None:
    """Write NAME.safetensors and NAME.json, each whole or not at all. Raises OSError.

    tensors: mean and std (dim,) of the observation, weight_i (out, in) and bias_i (out,).
    """
    with whole(path, parents=True) as scratch:
        save_file(tensors, scratch)
    write_whole(path.with_suffix(".json"), json.dumps(manifest, indent=1) + "\n")
