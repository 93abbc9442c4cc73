"""Policy output → PD target: a residual on the reference's joints, low-passed at 5 Hz."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studio.errors import unknown_name
from studio.robot import a1

Array = NDArray[np.float64]
ActionMode = Literal["residual", "absolute"]
ACTION_CLIP = 4.0
"""Outputs beyond this are cut: 4 * 0.25 rad is a full radian of residual."""


@dataclass(frozen=True, kw_only=True)
class ActionConfig:
    """mode: about the reference's joints or about the neutral stance. scale: rad per unit."""

    mode: ActionMode = "residual"
    scale: float = 0.25
    cutoff_hz: float = 5.0


def clip_action(action: Array) -> Array:
    """The action (…, 12), no unit, within ±ACTION_CLIP, as it enters history and target."""
    return np.minimum(np.maximum(action, -ACTION_CLIP), ACTION_CLIP)


def pd_target(
    action: Array, reference_joint_pos: Array, neutral_joint_pos: Array, config: ActionConfig
) -> Array:
    """(…, 12) rad: p̄ + scale · a, or neutral + scale · a, clipped to the joint limits.

    action (…, 12), no unit; the joint angles (…, 12) rad. Raises StudioError for an unknown mode.
    """
    if config.mode == "residual":
        base = reference_joint_pos
    elif config.mode == "absolute":
        base = neutral_joint_pos
    else:
        raise unknown_name("action mode", config.mode, ("residual", "absolute"))
    target = base + config.scale * action
    return np.minimum(np.maximum(target, a1.JOINT_LOWER), a1.JOINT_UPPER)
