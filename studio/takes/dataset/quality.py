"""A take's streams to one score from 0 to 100 and the reasons for it, worst first.

The score starts at 100 and every fault takes its part, so that the reasons add up to what is
missing. It judges what a mapper would learn from: is the person seen, steady and in time, and did
the robot do what was shown.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.takes.align.alignment import Alignment
from studio.takes.dataset.cleaning import Suggestion

Array = NDArray[np.float64]

_COST = {"dropped": 60.0, "frozen": 60.0, "jitter": 50.0, "low_confidence": 60.0, "limb_swap": 80.0}
"""Points a fault costs that lasts the whole take and touches the whole body."""
_LABEL = {
    "dropped": "frames lost",
    "frozen": "frozen frames",
    "jitter": "shaking joints",
    "low_confidence": "joints not seen",
    "limb_swap": "limbs swapped",
}
MIN_SECONDS = 2.0
AGREE = 0.4
"""Correlation under which person and robot hardly do the same; good takes reach 0.5 to 0.9."""
ROUGHNESS_M_S3 = 60.0
"""Median jerk of the wrists, m/s^3, above which a motion is called rough; people acting a robot's
motion stay under 30, a webcam's raw depth noise exceeds 200."""


@dataclass(frozen=True, kw_only=True)
class Reason:
    """What was found, and the points it costs."""

    name: str
    points: float
    message: str


@dataclass(frozen=True, kw_only=True)
class Quality:
    """score in [0, 100]; reasons, the dearest first."""

    score: float
    reasons: tuple[Reason, ...]


def quality(
    *,
    seconds: float,
    found: list[Suggestion],
    alignment: Alignment | None = None,
    jerk_m_s3: float = 0.0,
    fallen_share: float = 0.0,
) -> Quality:
    """Score a take of `seconds` s with the suggestions found in it.

    alignment: None when there is no robot side. jerk_m_s3: see `median_jerk`. fallen_share: share
    of ticks in which the simulated robot lay on the floor.
    """
    reasons = []
    for kind, cost in _COST.items():
        same = [s for s in found if s.kind == kind]
        share = sum((s.end - s.start) * s.share for s in same) / max(seconds, 1e-6)
        if same:
            # A fault costs something however short: it has to be looked at.
            points = min(cost, 2.0 + cost * min(1.0, 3.0 * share))
            message = f"{_LABEL[kind]}: {len(same)} time{'s' if len(same) > 1 else ''}"
            reasons.append(Reason(name=kind, points=points, message=message))
    if seconds < MIN_SECONDS:
        reasons.append(Reason(name="short", points=30.0, message=f"only {seconds:.1f} s long"))
    if alignment is not None and alignment.correlation < AGREE:
        points = 40.0 * (1.0 - max(alignment.correlation, 0.0) / AGREE)
        message = f"person and robot agree little (correlation {alignment.correlation:.2f})"
        reasons.append(Reason(name="disagree", points=points, message=message))
    if alignment is not None and abs(alignment.lag) > 0.1:
        message = f"person is {alignment.lag:+.2f} s late; align it"
        reasons.append(
            Reason(name="lag", points=10.0 * min(1.0, abs(alignment.lag)), message=message)
        )
    if jerk_m_s3 > ROUGHNESS_M_S3:
        points = min(20.0, 10.0 * np.log2(jerk_m_s3 / ROUGHNESS_M_S3))
        reasons.append(Reason(name="rough", points=float(points), message="motion is not smooth"))
    if fallen_share > 0.0:
        message = f"the robot lay on the floor for {100 * fallen_share:.0f} % of it"
        reasons.append(Reason(name="fallen", points=20.0 + 30.0 * fallen_share, message=message))
    reasons.sort(key=lambda r: -r.points)
    score = max(0.0, 100.0 - sum(r.points for r in reasons))
    return Quality(score=score, reasons=tuple(reasons))


def median_jerk(joint_pos: Array, dt: float) -> float:
    """m/s^3, median over time of the third derivative of positions (T, J, 3) m, in any frame."""
    if len(joint_pos) < 4:
        return 0.0
    jerk = np.linalg.norm(np.diff(joint_pos, n=3, axis=0), axis=-1) / dt**3
    return float(np.median(jerk))
