"""Takes to one HDF5 file in robomimic's layout: data/demo_N with obs, actions, states, dones.

What robomimic asks of it: actions in [-1, 1], filter keys `train` and `valid` that share no demo,
an environment type it knows. https://robomimic.github.io/docs/datasets/overview.html
"""

from collections.abc import Iterable, Iterator
from pathlib import Path

import h5py
import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.skeleton import JOINTS
from studio.robot import a1
from studio.takes.export.episodes import Episode, episodes, words
from studio.takes.export.hdf5_file import hdf5_file
from studio.takes.take import Take

Array = NDArray[np.float64]

GYM = 2
"""robomimic's number of a Gymnasium environment."""
HELD_OUT = 0.1
"""Share of the demos, or of the only one's steps, that is kept for validation."""
_STATE = ("base_pos", "base_quat", "joint_pos", "base_lin_vel_w", "base_ang_vel_b", "joint_vel")


def write_hdf5(takes: Iterable[Take], path: Path) -> None:
    """A demo for each stretch of a take without a gap, the person in step with the robot.

    obs: robot_* (before the action) and reference_* as in a Tick, human (N, 57) m and
    human_confidence (N, 19); next_obs the same after it. actions (N, 12): PD targets, a joint's
    lower limit -1 and its upper 1; actions_rad the same in rad. states (N, 37): qpos and qvel
    before the action. rewards are 0. action_stats: min, max, mean, std of actions_rad,
    and the limits. StudioError when nothing is left of a take.
    """
    env = {"env_name": "a1-studio", "type": GYM, "env_kwargs": {"control_hz": a1.CONTROL_HZ}}
    demos: list[str] = []  # whose each is
    actions: list[Array] = []
    with hdf5_file(path) as file:
        data = file.create_group("data")
        data.attrs["env_args"] = msgspec.json.encode(env).decode()
        data.attrs["joints"] = list(a1.JOINTS)
        data.attrs["human_joints"] = list(JOINTS)
        for take, part in _parts(takes):
            _write_demo(data.create_group(f"demo_{len(demos)}"), take, part)
            demos.append(take.name)
            actions.append(part.action)
        data.attrs["total"] = sum(len(x) for x in actions)
        valid = _held_out(demos)
        for key, use in (("train", ~valid), ("valid", valid)):
            names = [f"demo_{i}" for i in np.flatnonzero(use)]
            file.create_dataset(f"mask/{key}", data=np.array(names, dtype="S"))
        _write_statistics(file.create_group("action_stats"), np.concatenate(actions))


def _parts(takes: Iterable[Take]) -> Iterator[tuple[Take, Episode]]:
    """Every episode; if there is only one, its end is another: something has to be held out."""
    found = ((take, part) for take in takes for part in episodes(take))
    take, first = next(found)
    second = next(found, None)
    at = min(round((1.0 - HELD_OUT) * len(first)), len(first) - 1)
    if second is None and not at:
        raise StudioError(f"take {take.name} has one step: a second one is held out for validation")
    if second is not None:
        yield take, first
        yield second
        yield from found
    else:
        yield take, first[:at]
        yield take, first[at:]


def _held_out(demos: list[str]) -> NDArray[np.bool_]:
    """Which demos are for validation: the last takes', or of one take its last."""
    own = {name: np.array([name == other for other in demos]) for name in demos}
    if len(own) == 1:
        return np.arange(len(demos)) >= len(demos) - max(1, round(HELD_OUT * len(demos)))
    last = list(own)[-max(1, round(HELD_OUT * len(own))) :]
    return np.any([own[name] for name in last], axis=0)


def _write_demo(demo: h5py.Group, take: Take, part: Episode) -> None:
    length = len(part)
    demo.attrs["num_samples"] = length
    for key, said in (("take", take.name), ("label", take.label), ("task", words(take))):
        demo.attrs[key] = said.replace("\0", "")  # which ends a text here
    demo.attrs["lag"], demo.attrs["first_tick"] = take.edits.lag or 0.0, int(part.tick[0])
    later = np.minimum(np.arange(length) + 1, length - 1)
    seen = {"human": part.human, "human_confidence": part.confidence}
    seen |= {f"reference_{key}": x for key, x in part.reference.items()}
    pairs = {key: (x, x[later]) for key, x in seen.items()}
    pairs |= {f"robot_{key}": (x, part.after[key]) for key, x in part.before.items()}
    for key, (now, then) in pairs.items():
        for group, x in (("obs", now), ("next_obs", then)):
            flat = x.reshape(length, -1).astype(np.float32)
            demo.create_dataset(f"{group}/{key}", data=flat, compression="gzip")
    demo["actions"] = normalised(part.action).astype(np.float32)
    demo["actions_rad"] = part.action.astype(np.float32)
    demo["states"] = np.concatenate([part.before[key] for key in _STATE], axis=1)
    demo["rewards"] = np.zeros(length, np.float32)
    demo["dones"] = (np.arange(length) == length - 1).astype(np.int64)


def normalised(joint_pos: Array) -> Array:
    """Joint angles (…, 12) rad to (…, 12) in [-1, 1] between their limits; targets are within."""
    span = a1.JOINT_UPPER - a1.JOINT_LOWER
    return np.clip(2.0 * (joint_pos - a1.JOINT_LOWER) / span - 1.0, -1.0, 1.0)


def _write_statistics(group: h5py.Group, actions: Array) -> None:
    group["lower"], group["upper"] = a1.JOINT_LOWER, a1.JOINT_UPPER
    group["min"], group["max"] = actions.min(0), actions.max(0)
    group["mean"], group["std"] = actions.mean(0), actions.std(0)
