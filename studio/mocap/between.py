"""Poses at times of their own → the pose at any time, between the two around it."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from studio.human.pose import HumanPose

GAP = 0.5
"""s between two poses: nobody knows what was between those further apart."""


def pose_at(
    t: float, times: NDArray[np.float64], pose: Callable[[int], HumanPose]
) -> HumanPose | None:
    """The pose at `t` s, which lies as far between its neighbours as `t` does; None in a gap.

    times: (N,) s, ascending. pose: the n-th. A joint is as sure as in the less sure of the two.
    """
    after = int(np.searchsorted(times, t, side="right"))
    near = [n for n in (after - 1, after) if 0 <= n < len(times) and abs(times[n] - t) <= GAP]
    if not near:
        return None
    first, last = pose(near[0]), pose(near[-1])
    span = float(times[near[-1]] - times[near[0]])
    if not 0.0 < span <= GAP:
        return HumanPose(t=t, joint_pos_w=first.joint_pos_w, confidence=first.confidence)
    share = (t - float(times[near[0]])) / span
    return HumanPose(
        t=t,
        joint_pos_w=first.joint_pos_w + share * (last.joint_pos_w - first.joint_pos_w),
        confidence=np.minimum(first.confidence, last.confidence),
    )
