"""Takes to one HDF5 file in robomimic's layout: data/demo_N with obs, actions, dones, rewards."""

from collections.abc import Sequence
from pathlib import Path

import h5py
import msgspec
import numpy as np

from studio.errors import StudioError
from studio.human.skeleton import JOINTS, NUM_JOINTS
from studio.robot import a1
from studio.takes.export.extent import extent
from studio.takes.take import Take


def write_hdf5(takes: Sequence[Take], path: Path) -> None:
    """A demo per take: what trim and cuts leave, the person in step with the robot.

    obs: robot_* and reference_* (as in a Tick), human (N, 19, 3) m, human_confidence (N, 19);
    next_obs the same a period later; actions (N, 12): PD targets, rad; rewards are 0.
    """
    env = {"env_name": "a1-studio", "type": 0, "env_kwargs": {"control_hz": a1.CONTROL_HZ}}
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["env_args"] = msgspec.json.encode(env).decode()
        data.attrs["joints"] = list(a1.JOINTS)
        data.attrs["human_joints"] = list(JOINTS)
        total = 0
        for number, take in enumerate(takes):
            part = extent(take)
            length = len(part.tick)
            if not length:
                raise StudioError(f"nothing is left of take {take.name}: widen its trim")
            demo = data.create_group(f"demo_{number}")
            demo.attrs["num_samples"] = length
            demo.attrs["take"], demo.attrs["label"] = take.name, take.label
            demo.attrs["lag"] = take.edits.lag or 0.0
            arrays = {
                f"{who}_{key}": value[part.tick].reshape(length, -1)
                for who, group in (
                    ("robot", take.arrays.robot),
                    ("reference", take.arrays.reference),
                )
                for key, value in group.items()
            }
            arrays["human"] = part.human.reshape(length, 3 * NUM_JOINTS)
            arrays["human_confidence"] = part.confidence
            later = np.minimum(np.arange(length) + 1, length - 1)
            for key, value in arrays.items():
                x = value.astype(np.float32)
                demo.create_dataset(f"obs/{key}", data=x, compression="gzip")
                demo.create_dataset(f"next_obs/{key}", data=x[later], compression="gzip")
            demo["actions"] = take.arrays.target[part.tick].astype(np.float32)
            demo["states"] = np.concatenate(
                [arrays[f"robot_{key}"] for key in ("base_pos", "base_quat", "joint_pos")], axis=1
            )
            demo["rewards"] = np.zeros(length, np.float32)
            demo["dones"] = (np.arange(length) == length - 1).astype(np.int64)
            total += length
        data.attrs["total"] = total
        names = np.array([f"demo_{i}" for i in range(len(takes))], dtype="S")
        file.create_dataset("mask/train", data=names)
