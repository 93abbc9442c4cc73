"""Poses as the human frames a sensor would send."""

from typing import Any

from studio.human.pose import HumanPose


def object_of(pose: HumanPose) -> dict[str, Any]:
    """A pose as the human frame of skeleton "studio": what the gate reads back unchanged."""
    return {
        "t": pose.t,
        "skeleton": "studio",
        "positions": pose.joint_pos_w.tolist(),
        "confidence": pose.confidence.tolist(),
    }
