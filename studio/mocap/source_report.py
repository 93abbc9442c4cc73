"""What a source made of what it was given: the load report, the same for every source."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.human.sensor_skeletons import SKELETONS, SourceSkeleton
from studio.human.skeleton import INDEX, JOINTS

MAX_WHY = 5
"""Reasons kept; a file that is wrong throughout gives the same one a million times."""


@dataclass(frozen=True, kw_only=True)
class Refused:
    """frames: how many were left out. why: of the first few, where and what was wrong."""

    frames: int = 0
    why: tuple[str, ...] = ()

    def plus(self, why: str, frames: int = 1) -> "Refused":
        """Some more."""
        return Refused(frames=self.frames + frames, why=(*self.why, why)[:MAX_WHY])

    def __add__(self, other: "Refused") -> "Refused":
        return Refused(frames=self.frames + other.frames, why=(self.why + other.why)[:MAX_WHY])


@dataclass(frozen=True, kw_only=True)
class SourceReport:
    """What was found in a source.

    joints_found: canonical joint → the source's joints it is made of. joints_missing: those that
    the source lacks. scale_m: metres in one of the source's units. up_axis: its axis that points
    up, "y", "-z" … refused: frames left out so far. notes: what else was read differently from
    how it is written, one line each. names: all joints of the source, as it calls them.
    """

    joints_found: dict[str, tuple[str, ...]]
    joints_missing: tuple[str, ...] = ()
    scale_m: float = 1.0
    up_axis: str = "z"
    refused: Refused = field(default_factory=Refused)
    notes: tuple[str, ...] = ()
    names: tuple[str, ...] = ()

    def and_refused(self, more: Refused) -> "SourceReport":
        """The same with more frames refused, by whoever looked at them next."""
        return replace(self, refused=self.refused + more)

    def as_dict(self) -> dict[str, Any]:
        """The `source_report` of contract.md."""
        return {
            "joints_found": {joint: list(own) for joint, own in self.joints_found.items()},
            "joints_missing": list(self.joints_missing),
            "scale_m": self.scale_m,
            "up_axis": self.up_axis,
            "refused": {"frames": self.refused.frames, "why": list(self.refused.why)},
            "notes": list(self.notes),
        }


def report_on(
    skeleton: SourceSkeleton,
    *,
    seen: NDArray[np.bool_] | None = None,
    scale_m: float = 1.0,
    refused: Refused | None = None,
    notes: tuple[str, ...] = (),
) -> SourceReport:
    """The report on a source that speaks `skeleton`. seen: (19,) joints that were ever seen."""
    found = {
        joint: own for joint, own in skeleton.found.items() if seen is None or seen[INDEX[joint]]
    }
    return SourceReport(
        joints_found=found,
        joints_missing=tuple(joint for joint in JOINTS if joint not in found),
        scale_m=scale_m,
        up_axis=skeleton.up_axis,
        refused=refused or Refused(),
        notes=notes,
        names=skeleton.joints,
    )


OWN = report_on(SKELETONS["studio"])
"""Of a source that speaks the canonical skeleton itself: the synthetic operator, a take."""
