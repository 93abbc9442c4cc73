"""`evaluate pairs`: how well frames are mapped, on people held out by body and by how they move.

Every method sees the same frames of the same performances and is planted by the same contact and
temporal consistency; "without contact" rows let the mapped velocity carry the root instead.
"""

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import geometry, metrics
from studio.evaluation.options import TableOptions
from studio.evaluation.pair_methods import SIZES, Fitted, fit_methods, spread
from studio.options import Style
from studio.reference.intent import STATES, StateName
from studio.retarget.baselines.simple import contact_by_height
from studio.retarget.foothold_planner import FootholdPlanner
from studio.retarget.mapper import RATES, Mapped
from studio.retarget.store import load_experts
from studio.robot import kinematics
from studio.robot.a1 import CONTROL_DT
from studio.training.machine import commit
from studio.training.mapper_fit import MapperTraining
from studio.training.operator_pairs import PairSet
from studio.training.synthetic_pairs import make_pairs

log = logging.getLogger(__name__)
Array = NDArray[np.float64]

HELD_OUT_SEED = 20_000
SETTLE = 10
"""Frames of each performance left out: the planner starts in the neutral pose."""


@dataclass(frozen=True, kw_only=True)
class Performed:
    """Poses of one performance, as a method makes them or as they should be, frame by frame."""

    base_pos: Array
    base_quat: Array
    joint_pos: Array
    contact: Array

    @property
    def feet(self) -> Array:
        """(T, 4, 3) m, world."""
        return kinematics.foot_pos_w(self.base_pos, self.base_quat, self.joint_pos)


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate pairs`."""

    episodes: int = 12
    """Held-out performances of 10 s a state."""
    style: Style = "march"
    """Which human motion means walking."""
    train_seconds: float = 300.0
    """Of a state's pairs that all methods are fitted to."""
    steps: int = 1200
    """Gradient steps a state of the networks."""
    sizes: tuple[int, ...] = SIZES
    """Numbers of pairs to fit to, besides all of them."""
    states: tuple[StateName, ...] = STATES
    """Which experts."""


def run_pairs(
    options: Options = Options(), *, tick: Callable[[str], None] = log.info
) -> dict[str, Any]:
    """Rows per state, method and number of pairs.

    All methods are fitted to the same pairs of the default family, `sizes` of a state's
    `train_seconds` and all of them, the networks in `steps` gradient steps a state (see
    `pair_methods`); "expert" alone is the shipped one. All are scored on the family "held_out".
    """
    seed, style, states = options.seed, options.style, options.states
    made_by = commit()
    shipped = load_experts(style)
    known = {s: make_pairs(s, options.train_seconds, seed, style) for s in states}
    held = {
        s: make_pairs(s, 10.0 * options.episodes, seed + HELD_OUT_SEED, style, "held_out")
        for s in states
    }
    training = MapperTraining(style=style, seed=seed, steps=options.steps, resume=False)
    rows: list[dict[str, Any]] = []

    def add(state: StateName, case: str, fitted: Fitted, *, by_height: bool = False) -> None:
        clips = clips_of(held[state])
        mapped = [fitted.method(clip.triplet) for clip in clips]
        rows.append(
            {
                "state": state,
                "case": case,
                "controller": fitted.controller,
                "pairs": fitted.pairs,
                "fit_seconds": fitted.fit_seconds,
                "seed": seed,
                "episodes": len(clips),
                "frames": len(held[state]),
                "commit": made_by,
                **score(state, clips, [by_foot_height(m) if by_height else m for m in mapped]),
            }
        )
        tick(f"{state} {case}: {rows[-1]['joint_rmse_deg']:.1f} deg")

    for size in (*options.sizes, None):
        said = "all pairs" if size is None else f"{size} pairs"
        methods = fit_methods({s: spread(known[s], size) for s in states}, training)
        for state, fitted in methods.items():
            for one in fitted:
                add(state, f"{one.controller}, {said}", one)
    for state in states:
        facts = shipped.sidecars[state]
        ours = Fitted(
            controller="expert",
            method=shipped.mappers[state],
            pairs=int(facts.get("scores", {}).get("train_frames", 0)),
            fit_seconds=float(facts.get("seconds", 0.0)),
        )
        add(state, "expert", ours)
        add(state, "expert, contact by foot height", ours, by_height=True)
    return {"rows": rows}


def clips_of(pairs: PairSet) -> list[PairSet]:
    """The performances of a set, one by one."""
    return [pairs.take(pairs.clip == c) for c in np.unique(pairs.clip)]


def by_foot_height(mapped: Mapped) -> Mapped:
    """The same frames with contact told by the height of the mapped feet."""
    return replace(mapped, contact_prob=contact_by_height(mapped.base_quat, mapped.joint_pos))


def score(state: StateName, clips: list[PairSet], mapped: list[Mapped]) -> dict[str, float]:
    """A row's figures: means over performances of their figures."""
    each = []
    for clip, said in zip(clips, mapped, strict=True):
        truth = as_labelled(state, clip)
        planted, clipped, slips = plant(state, said)
        floating = integrated_velocity(state, said, truth)
        each.append(
            {
                "joint_rmse_deg": metrics.joint_rmse_deg(planted.joint_pos, truth.joint_pos),
                "mapped_joint_rmse_deg": metrics.joint_rmse_deg(
                    said.joint_pos[SETTLE:], truth.joint_pos
                ),
                "orientation_error_deg": metrics.orientation_error_deg(
                    planted.base_quat, truth.base_quat
                ),
                "foot_error_m": metrics.foot_error_m(
                    planted.base_pos,
                    planted.base_quat,
                    planted.feet,
                    truth.base_pos,
                    truth.base_quat,
                    truth.feet,
                ),
                "foot_skate_m_s": _skate(planted.feet, planted.contact),
                "foot_skate_without_m_s": _skate(floating.feet, floating.contact),
                "contact_f1": metrics.contact_f1(said.contact_prob[SETTLE:], truth.contact),
                "contact_switches_hz": switches(said.contact_prob),
                "clipped_share": clipped,
                "slips_per_s": slips / (len(clip) * CONTROL_DT),
                "distance_ratio": metrics.distance_m(planted.base_pos)
                / max(metrics.distance_m(truth.base_pos), 0.05),
                "net_distance_m": metrics.net_distance_m(planted.base_pos),
                "net_distance_true_m": metrics.net_distance_m(truth.base_pos),
            }
        )
    return {name: float(np.mean([row[name] for row in each])) for name in each[0]}


def plant(state: StateName, mapped: Mapped) -> tuple[Performed, float, int]:
    """The planted motion after SETTLE frames, the share of frames clipped, the slips."""
    planner = FootholdPlanner()
    planner.start(state)
    poses, clipped = [], 0
    for i in range(len(mapped.joint_pos)):
        values = {f: getattr(mapped, f) for f in Mapped.__dataclass_fields__}
        frame = Mapped(**{f: v[i] if isinstance(v, np.ndarray) else v for f, v in values.items()})
        pose, cut = planner.step(frame, CONTROL_DT)
        poses.append(pose)
        clipped += cut
    kept = poses[SETTLE:]
    return (
        Performed(
            base_pos=np.array([p.base_pos for p in kept]),
            base_quat=np.array([p.base_quat for p in kept]),
            joint_pos=np.array([p.joint_pos for p in kept]),
            contact=np.array([p.foot_contact for p in kept]),
        ),
        clipped / len(poses),
        planner.slips,
    )


def integrated_velocity(state: StateName, mapped: Mapped, truth: Performed) -> Performed:
    """What is shown without contact consistency: the mapped velocities move the root."""
    velocity = mapped.rates[SETTLE:, RATES["base_lin_vel"]]
    quat = mapped.base_quat[SETTLE:]
    yaw = np.zeros(len(quat))
    if state == "walk":
        spin = geometry.quat_rotate(quat, mapped.rates[SETTLE:, RATES["base_ang_vel"]])
        yaw = np.cumsum(spin[:, 2]) * CONTROL_DT
    turn = geometry.quat_from_yaw(yaw)
    pos = truth.base_pos[0] + np.cumsum(geometry.quat_rotate(turn, velocity), axis=0) * CONTROL_DT
    return Performed(
        base_pos=pos,
        base_quat=geometry.quat_mul(turn, quat),
        joint_pos=mapped.joint_pos[SETTLE:],
        contact=mapped.contact_prob[SETTLE:],
    )


def as_labelled(state: StateName, clip: PairSet) -> Performed:
    """A performance's labels, in the frame of the state (walking: heading removed)."""
    keep = slice(SETTLE, None)
    return Performed(
        base_pos=np.asarray(clip.base_pos[keep], np.float64),
        base_quat=geometry.normalize(clip.base_quat[keep]),
        joint_pos=np.asarray(clip.joint_pos[keep], np.float64),
        contact=np.asarray(clip.contact[keep], np.float64),
    )


def switches(contact: Array) -> float:
    """How often a foot's contact (T, 4), read at 0.5, changes, times a second (mean over feet)."""
    flips = np.abs(np.diff((contact > 0.5).astype(int), axis=0)).sum(axis=0)
    return float(flips.mean() / (len(contact) * CONTROL_DT))


def _skate(feet: Array, contact: Array) -> float:
    return metrics.foot_skate_m_s(feet, contact, CONTROL_DT)
