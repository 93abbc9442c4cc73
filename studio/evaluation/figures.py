"""`evaluate figures`: a strip a task: person, what the robot should do, and what it does.

Drawn from the meshes by our own projection, so that no graphics card and no browser is needed. The
paper's workspace and ablation bars are `workspace --figure` and `ablation --figure`; its pictures
of the real robot are out of reach.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control.drive_command import PuppeteerConfig
from studio.evaluation.behind import drive, met
from studio.evaluation.options import TableOptions
from studio.evaluation.tracking import names_of
from studio.human.shape import BONE_RADII, BONES, JOINT_RADII
from studio.human.skeleton import INDEX, PARENTS
from studio.options import ControllerName
from studio.reference.library import TASKS
from studio.robot import a1
from studio.robot.kinematics import link_frames_w
from studio.robot.meshes import link_meshes
from studio.robot.pose import ReferencePose, RobotState
from studio.sources import open_source
from studio.takes.tick import Tick
from studio.training.machine import commit

Array = NDArray[np.float64]
STRIPS = ("tilt", "crouch", "manipulate_right", "walk", "turn", "sit_tilt", "sit_manipulate")
"""The tasks that show most of what a person can mean."""
SETTLED_S = 2.0
"""s until the robot does the task, sitting down included, before the strip begins."""
COLUMNS = 7
_AZIMUTH, _ELEVATION = 0.9, 0.25
"""rad: seen from ahead and from the figure's left, from a little above."""
_PERSON, _REFERENCE = (0.80, 0.41, 0.24), (0.36, 0.61, 1.0)
_LIGHT = np.array([0.45, 0.35, 0.82])


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate figures`."""

    episodes: int = 1
    """Strips a task, by the seeds from `seed` on."""
    tasks: tuple[str, ...] = STRIPS
    """Which tasks."""
    seconds: float = 5.0
    """How much of a task a strip shows."""
    controller: ControllerName | None = None
    """What turns the reference into an action (default: policy once trained)."""
    out: Path = Path("runs/evaluate/figures")
    """Folder of the pictures."""


def run_figures(options: Options = Options()) -> dict[str, Any]:
    """A row a strip, which names its picture and how far the robot was from what it should do.

    StudioError for a task that is not in the library.
    """
    tasks = names_of("task", options.tasks, tuple(TASKS))
    options.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for task in tasks:
        for seed in range(options.seed, options.seed + options.episodes):
            seen = _seen(task, seed, options)
            picture = options.out / f"strip_{task}_{seed}.png"
            _strip(task, seen, picture)
            joints = [tick.reference.joint_pos - tick.robot.joint_pos for tick in seen]
            rows.append({
                "case": task,
                "state": seen[-1].state,
                "controller": seen[-1].controller,
                "seed": seed,
                "episodes": 1,
                "commit": commit(),
                "joint_rmse_deg": float(np.degrees(np.sqrt(np.mean(np.square(joints))))),
                "survived": not seen[-1].fallen,
                "picture": picture.name,
            })  # fmt: skip
    return {"rows": rows}


def _seen(task: str, seed: int, options: Options) -> list[Tick]:
    """The ticks of a strip: a task acted out, from when the robot does it on."""
    source = open_source(f"operator:{task}", seed=seed)
    puppeteer = met(source, PuppeteerConfig(controller=options.controller, seed=seed))
    try:
        state = TASKS[task].state
        ticks: list[Tick] = []
        begun = False
        for tick in drive(puppeteer, source, 30.0):
            begun = begun or (tick.state == state and tick.human is not None)
            ticks += [tick] if begun else []
            if len(ticks) > (SETTLED_S + options.seconds) * a1.CONTROL_HZ:
                break
    finally:
        source.close()
        puppeteer.link.close()
    return ticks[round(SETTLED_S * a1.CONTROL_HZ) :] or ticks[-1:]


def _strip(task: str, ticks: Sequence[Tick], out: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    at = np.linspace(0, len(ticks) - 1, COLUMNS).round().astype(int)
    figure, axes = plt.subplots(3, COLUMNS, figsize=(1.7 * COLUMNS, 5.2), layout="constrained")
    begin = ticks[0].t
    for column, tick in enumerate(ticks[i] for i in at):
        _draw_person(axes[0, column], tick)
        _draw_robot(axes[1, column], tick.reference, _REFERENCE)
        _draw_robot(axes[2, column], tick.robot, None)
        axes[0, column].set_title(f"{tick.t - begin:.1f} s", fontsize=9)
    for axis in axes.flat:
        axis.set_aspect("equal")
        axis.set_xticks([])
        axis.set_yticks([])
        axis.spines[:].set_visible(False)
    for row, words in enumerate(("person", "should do", f"does ({ticks[-1].controller})")):
        axes[row, 0].set_ylabel(words)
    figure.suptitle(task.replace("_", " "))
    figure.savefig(out, dpi=100)
    plt.close(figure)


def _draw_person(axis: Any, tick: Tick) -> None:
    """Bones as capsules, the far ones first; the person faces ahead."""
    assert tick.human is not None  # a strip begins once somebody is seen
    joints = np.asarray(tick.human.joint_pos_w, np.float64)
    across = joints[INDEX["l_hip"]] - joints[INDEX["r_hip"]]
    turned = joints - joints[INDEX["pelvis"]]
    turned[:, :2] = geometry.turn_xy(turned[:, :2], -np.arctan2(-across[0], across[1]))
    turned[:, 2] -= turned[:, 2].min()
    xy, depth = _projected(turned)
    points = 72.0 * 1.45 / 2.1  # of a metre, in a panel that shows 2.1 m
    for bone, end in sorted(enumerate(BONES), key=lambda each: depth[each[1]]):
        line = xy[[PARENTS[end], end]]
        width = 2.0 * float(BONE_RADII[bone].mean()) * points
        shade = 0.75 + 0.25 * np.clip(0.5 + depth[end], 0.0, 1.0)
        axis.plot(*line.T, color=tuple(shade * np.array(_PERSON)), lw=width, solid_capstyle="round")
    head = INDEX["head"]
    axis.plot(*xy[head], "o", color=_PERSON, ms=2.0 * JOINT_RADII[head] * points)
    axis.set_xlim(-0.9, 0.75)
    axis.set_ylim(-0.25, 1.95)


def _draw_robot(axis: Any, pose: ReferencePose | RobotState, color: Any) -> None:
    """Its meshes, faces towards the eye, the far ones first; it faces as ahead as it leans."""
    from matplotlib.collections import PolyCollection

    quat = np.asarray(pose.base_quat, np.float64)
    level = geometry.quat_mul(geometry.quat_conj(geometry.heading_quat(quat)), quat)
    place = np.array([0.0, 0.0, float(pose.base_pos[2])])
    positions, turns = link_frames_w(place, level, pose.joint_pos)
    faces, shades = [], []
    for link, position, turn in zip(a1.LINKS, positions, turns, strict=True):
        mesh = link_meshes()[link]
        corners = (position + geometry.quat_rotate(turn, mesh.vertices.astype(float)))[mesh.faces]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
        light = 0.45 + 0.55 * np.clip(normal @ _LIGHT, 0.0, 1.0)
        base = np.array(mesh.color) / 255.0 if color is None else np.array(color)
        faces.append(corners)
        shades.append(np.clip(light[:, None] * base, 0.0, 1.0))
    corners, colors = np.concatenate(faces), np.concatenate(shades)
    xy, depth = _projected(corners.reshape(-1, 3))
    xy, depth = xy.reshape(-1, 3, 2), depth.reshape(-1, 3).mean(axis=1)
    order = np.argsort(depth)
    shown = PolyCollection(list(xy[order]), facecolors=colors[order], edgecolors="none")
    axis.add_collection(shown)
    axis.axhline(0.0, color="#8886", lw=0.8, zorder=0)
    axis.set_xlim(-0.48, 0.48)
    axis.set_ylim(-0.16, 0.86)


def _projected(points: Array) -> tuple[Array, Array]:
    """Of points (P, 3) m, x forward: (P, 2) m in the picture, right and up, and (P,) how near."""
    sin, cos = np.sin(_AZIMUTH), np.cos(_AZIMUTH)
    right = -sin * points[:, 0] + cos * points[:, 1]
    towards = cos * points[:, 0] + sin * points[:, 1]
    up = np.cos(_ELEVATION) * points[:, 2] - np.sin(_ELEVATION) * towards
    near = np.cos(_ELEVATION) * towards + np.sin(_ELEVATION) * points[:, 2]
    return np.stack([right, up], axis=-1), near
