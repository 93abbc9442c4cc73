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

from studio import metrics, spatial
from studio.reference.intent import STATES, StateName
from studio.retarget.baselines.base import FrameMapper, Targets
from studio.retarget.baselines.foot_height import contact_by_height
from studio.retarget.baselines.nearest import NearestPair
from studio.retarget.baselines.ridge import Ridge
from studio.retarget.mapper import RATES, Mapped
from studio.retarget.planting import Planting
from studio.retarget.store import load_experts
from studio.robot import kinematics
from studio.robot.a1 import CONTROL_DT
from studio.training.mapper import commit, make_pairs
from studio.training.operator_pairs import PairSet

log = logging.getLogger(__name__)
Array = NDArray[np.float64]

HELD_OUT_SEED = 20_000
SETTLE = 10
"""Frames of each performance left out: planting starts in the neutral pose."""


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


def run_pairs(
    *,
    episodes: int | None = None,
    seed: int = 0,
    style: str = "march",
    train_seconds: float = 300.0,
    states: tuple[StateName, ...] = STATES,
    tick: Callable[[str], None] = log.info,
    **_: Any,
) -> dict[str, Any]:
    """Rows per state and method. episodes: held-out performances of 10 s per state (default 12).

    The baselines are fitted to `train_seconds` of the same kind of pairs as the experts (default
    family); everything is scored on the family "held_out".
    """
    experts = load_experts(style)
    rows: list[dict[str, Any]] = []
    for state in states:
        known = make_pairs(state, train_seconds, seed, style)
        held = make_pairs(state, 10.0 * (episodes or 12), seed + HELD_OUT_SEED, style, "held_out")
        targets = Targets(**{f: getattr(known, f) for f in Targets.__dataclass_fields__})
        methods: dict[str, FrameMapper] = {
            "nearest_pair": NearestPair(known.triplet, targets),
            "ridge": Ridge(known.triplet, targets),
            "expert": experts.mappers[state],
        }
        clips = [held.take(held.clip == c) for c in np.unique(held.clip)]
        for name, method in methods.items():
            mapped = [method(clip.triplet) for clip in clips]
            row = {"state": state, "case": name, "controller": name, "seed": seed}
            row.update(episodes=len(clips), frames=len(held), commit=commit())
            row.update(score(state, clips, mapped))
            tick(f"{state} {name}: {row['joint_rmse_deg']:.1f} deg")
            rows.append(row)
        rows.append({**rows[-1], "case": "expert, contact by foot height"})
        by_height = [by_foot_height(method(clip.triplet)) for clip in clips]
        rows[-1].update(score(state, clips, by_height))
    return {"rows": rows}


def by_foot_height(mapped: Mapped) -> Mapped:
    """The same frames with contact told by the height of the mapped feet."""
    return replace(mapped, contact_prob=contact_by_height(mapped.base_quat, mapped.joint_pos))


def score(state: StateName, clips: list[PairSet], mapped: list[Mapped]) -> dict[str, float]:
    """A row's figures: means over performances of their figures."""
    each = []
    for clip, said in zip(clips, mapped, strict=True):
        truth = as_labelled(state, clip)
        planted, clipped, slips = plant(state, said)
        floating = carried_by_velocity(state, said, truth)
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
            }
        )
    return {name: float(np.mean([row[name] for row in each])) for name in each[0]}


def plant(state: StateName, mapped: Mapped) -> tuple[Performed, float, int]:
    """The planted motion after SETTLE frames, the share of frames clipped, the slips."""
    planting = Planting()
    planting.start(state)
    poses, clipped = [], 0
    for i in range(len(mapped.joint_pos)):
        frame = Mapped(**{f: getattr(mapped, f)[i] for f in Mapped.__dataclass_fields__})
        pose, cut = planting.step(frame, CONTROL_DT)
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
        planting.slips,
    )


def carried_by_velocity(state: StateName, mapped: Mapped, truth: Performed) -> Performed:
    """What is shown without contact consistency: the mapped velocities move the root."""
    velocity = mapped.rates[SETTLE:, RATES["base_lin_vel"]]
    quat = mapped.base_quat[SETTLE:]
    yaw = np.zeros(len(quat))
    if state == "walk":
        spin = spatial.quat_rotate(quat, mapped.rates[SETTLE:, RATES["base_ang_vel"]])
        yaw = np.cumsum(spin[:, 2]) * CONTROL_DT
    zero = np.zeros_like(yaw)
    turn = spatial.quat_from_rpy(np.stack([zero, zero, yaw], axis=-1))
    pos = truth.base_pos[0] + np.cumsum(spatial.quat_rotate(turn, velocity), axis=0) * CONTROL_DT
    return Performed(
        base_pos=pos,
        base_quat=spatial.quat_mul(turn, quat),
        joint_pos=mapped.joint_pos[SETTLE:],
        contact=mapped.contact_prob[SETTLE:],
    )


def as_labelled(state: StateName, clip: PairSet) -> Performed:
    """A performance's labels, in the frame of the state (walking: heading removed)."""
    keep = slice(SETTLE, None)
    return Performed(
        base_pos=np.asarray(clip.base_pos[keep], np.float64),
        base_quat=spatial.normalize(clip.base_quat[keep]),
        joint_pos=np.asarray(clip.joint_pos[keep], np.float64),
        contact=np.asarray(clip.contact[keep], np.float64),
    )


def switches(contact: Array) -> float:
    """How often a foot's contact (T, 4), read at 0.5, changes, times a second (mean over feet)."""
    flips = np.abs(np.diff((contact > 0.5).astype(int), axis=0)).sum(axis=0)
    return float(flips.mean() / (len(contact) * CONTROL_DT))


def _skate(feet: Array, contact: Array) -> float:
    return metrics.foot_skate_m_s(feet, contact, CONTROL_DT)
