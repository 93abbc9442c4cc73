"""One person at one instant (HumanPose) and over time (HumanClip), on the canonical skeleton."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.human.skeleton import NUM_JOINTS
from studio.timing import CONTROL_DT


@dataclass(frozen=True, kw_only=True)
class Echo:
    """What whoever sent a live frame is told of it, so that they know how long its way was.

    sent: the frame's own `t`, s on its sender's clock. waited_ms: from its arrival until the
    control loop read it.
    """

    sent: float
    waited_ms: float


@dataclass(frozen=True, kw_only=True)
class HumanPose:
    """A person at time `t`, as a source saw them: nothing scaled, turned or filtered yet.

    t: seconds into the source.
    joint_pos_w: (19, 3) m, in the source's world turned to z up, x forward, y left.
    confidence: (19,) in [0, 1]; 0 means not seen, and the position is then a guess or NaN-free
        placeholder that must not be used.
    echo: of a frame that a socket brought, once it was read; nothing goes by it, no take keeps it.
    """

    t: float
    joint_pos_w: NDArray[np.float64]
    confidence: NDArray[np.float64]
    echo: Echo | None = None

    def __post_init__(self) -> None:
        assert self.joint_pos_w.shape == (NUM_JOINTS, 3), self.joint_pos_w.shape
        assert self.confidence.shape == (NUM_JOINTS,), self.confidence.shape


@dataclass(frozen=True, kw_only=True)
class HumanClip:
    """A recorded motion: t (T,) s ascending, joint_pos_w (T, 19, 3) m, confidence (T, 19)."""

    name: str
    t: NDArray[np.float64]
    joint_pos_w: NDArray[np.float64]
    confidence: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.t)

    def __getitem__(self, i: int) -> HumanPose:
        return HumanPose(
            t=float(self.t[i]), joint_pos_w=self.joint_pos_w[i], confidence=self.confidence[i]
        )

    @property
    def seconds(self) -> float:
        """How long it lasts: the last frame as long as the others, so N frames last N periods."""
        period = float(np.median(np.diff(self.t))) if len(self.t) > 1 else CONTROL_DT
        return float(self.t[-1] - self.t[0]) + period

    def newest(self, rate: float) -> NDArray[np.int64]:
        """(N,) which frame a loop at `rate` Hz goes by in each of its periods: the newest so far.

        Times are counted from the clip's start; the same rule, half a period of tolerance
        included, as a source's `read`. A frame comes again where there is no newer one.
        """
        period = 1.0 / rate
        count = max(int(np.ceil((self.seconds - 1e-9) / period - 0.5)), 1)
        t = np.arange(count, dtype=np.float64) * period
        newest = np.searchsorted(self.t - self.t[0], t + 0.5 * period - 1e-9) - 1
        return np.maximum(newest, 0)

    def at_rate(self, rate: float) -> "HumanClip":
        """The clip as a loop at `rate` Hz sees it, period by period; see `newest`."""
        newest = self.newest(rate)
        return HumanClip(
            name=self.name,
            t=np.arange(len(newest), dtype=np.float64) / rate,
            joint_pos_w=self.joint_pos_w[newest],
            confidence=self.confidence[newest],
        )
