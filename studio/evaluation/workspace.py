"""The volume that the right front paw reaches while standing, with tilts and without.

`a1-studio evaluate workspace --figure models/policy/workspace.png` also draws where it was.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.evaluation.options import TableOptions
from studio.evaluation.scripted import controllers, record
from studio.reference.keyframes import Goal, keyframe_track
from studio.robot import kinematics
from studio.training.machine import commit

Array = NDArray[np.float64]
VOXEL = 0.02
SECONDS = 10.0
TILT = np.radians([25.0, 25.0, 25.0])
"""Largest tilts beside a raised paw: the library's own range."""


def voxel_volume(points: Array, size: float = VOXEL) -> float:
    """m³ of the cubes of edge `size` m that points (N, 3) m fall into, in any frame."""
    return len(np.unique(np.floor(points / size).astype(int), axis=0)) * size**3


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate workspace`."""

    episodes: int = 64
    """Motions of the paw."""
    figure: Path | None = None
    """Also draw where the policy's paw was into this file (.png)."""


def run_workspace(options: Options = Options()) -> dict[str, Any]:
    """`{"rows": [...]}` per controller: `volume_m3` of manipulation alone, `volume_tilt_m3` of
    manipulation with tilts of as many episodes, and their `ratio` (the paper: 2.7)."""
    episodes, seed = options.episodes, options.seed
    rows = []
    for controller in controllers("stand"):
        without, survived = _reached(episodes, seed, controller, tilt=False)
        tilted, survived_tilt = _reached(episodes, seed, controller, tilt=True)
        volume, volume_tilt = voxel_volume(without), voxel_volume(tilted)
        rows.append(
            {
                "state": "stand",
                "controller": controller,
                "seed": seed,
                "episodes": episodes,
                "commit": commit(),
                "volume_m3": volume,
                "volume_tilt_m3": volume_tilt,
                "ratio": volume_tilt / volume,
                "survived": survived,
                "survived_tilt": survived_tilt,
            }
        )
    if options.figure is not None:
        draw_chart(options.figure, episodes, seed)
    return {"rows": rows}


def _reached(episodes: int, seed: int, controller: str, *, tilt: bool) -> tuple[Array, float]:
    """Positions (M, 3) m of the raised paw about where the robot stands, and the share alive."""
    rng = np.random.default_rng([seed, int(tilt)])

    def goal(rng: np.random.Generator) -> Goal:
        return Goal(
            reach=np.array([rng.uniform(0.25, 1.0), 0.0]),
            reach_side=np.array([rng.uniform(-1.0, 1.0), 0.0]),
            tilt=rng.uniform(-1.0, 1.0, 3) * TILT if tilt else np.zeros(3),
        )

    tracks = [
        keyframe_track(rng, "stand", "manipulate_right", SECONDS, goal) for _ in range(episodes)
    ]
    done = record("stand", tracks, controller, seed=seed)
    paw = kinematics.foot_pos_w(done.base_pos, done.base_quat, done.joint_pos)[:, :, 0]
    raised = np.stack([m.foot_contact[1:, 0] < 0.5 for m in done.motions], axis=1)
    return paw[raised & done.alive], float(done.alive[-1].mean())


def draw_chart(out: Path, episodes: int = 64, seed: int = 0) -> Path:
    """Where the policy's paw was, from the side and from above: without tilts over with them."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    controller = controllers("stand")[-1]
    clouds = {
        tilt: np.unique(
            np.floor(_reached(episodes, seed, controller, tilt=tilt)[0] / VOXEL), axis=0
        )
        for tilt in (True, False)
    }
    figure, axes = plt.subplots(1, 2, figsize=(11.0, 5.0))
    names = ("forward", "left", "up")
    for axis, (i, j) in zip(axes, ((0, 2), (0, 1)), strict=True):
        for tilt, colour in ((True, "#f4a259"), (False, "#2a6f97")):
            points = (clouds[tilt] + 0.5) * VOXEL
            label = f"{'with' if tilt else 'without'} tilts: {1e3 * len(points) * VOXEL**3:.1f} l"
            axis.scatter(points[:, i], points[:, j], s=9, color=colour, alpha=0.5, label=label)
        axis.set_xlabel(f"{names[i]} (m)")
        axis.set_ylabel(f"{names[j]} (m)")
        axis.set_aspect("equal")
        axis.grid(alpha=0.3)
        axis.spines[["top", "right"]].set_visible(False)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="lower center", ncols=2, frameon=False)
    ratio = len(clouds[True]) / len(clouds[False])
    figure.suptitle(
        f"Right front paw of the standing robot in physics ({controller}), "
        f"voxels of {100 * VOXEL:.0f} cm: {ratio:.1f} times the volume with tilts"
    )
    figure.tight_layout(rect=(0.0, 0.05, 1.0, 1.0))
    figure.savefig(out, dpi=120)
    plt.close(figure)
    return out
