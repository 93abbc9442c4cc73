"""A line that fails: frames dropped, late, swapped, doubled or spoilt at rising rates, through the
gate that every frame from outside passes → falls, and how much of the time the person is followed.
"""

import heapq
import logging
from collections.abc import Callable
from dataclasses import dataclass
from itertools import count
from typing import Any

import numpy as np

from studio import metrics
from studio.client.wire import frame_text
from studio.control.drive_command import PuppeteerConfig
from studio.errors import StudioError
from studio.evaluation.behind import met
from studio.evaluation.long_drive import set_up_again
from studio.evaluation.options import TableOptions
from studio.human.pose import HumanPose
from studio.mocap.source import Source
from studio.mocap.source_report import SourceReport
from studio.mocap.stream import StreamSource
from studio.options import ControllerName
from studio.sources import open_source
from studio.timing import CONTROL_DT
from studio.training.machine import commit

log = logging.getLogger(__name__)
RATES: dict[str, tuple[float, ...]] = {
    "none": (0.0,),
    "dropped": (0.1, 0.3, 0.6, 0.9),
    "late": (0.05, 0.1, 0.2, 0.5),
    "swapped": (0.1, 0.3, 0.6),
    "doubled": (0.3, 1.0),
    "spoilt": (0.1, 0.3, 0.6, 0.9),
    "silent": (0.1, 0.3, 0.6),
}
"""Kinds of fault and how much: a share of the frames; "late": s by which each comes late at most;
"silent": the share of the time without a line, 0.2 to 2 s at a stretch."""
_SILENCE_S = (0.2, 2.0)


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate faults`."""

    episodes: int = 3
    """Synthetic people a row."""
    seconds: float = 60.0
    """That each of them drives."""
    source: str = "operator"
    """Who: the tour of every task, or operator:TASK."""
    controller: ControllerName | None = None
    """What turns the reference into an action (default: policy once trained)."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (self.source == "operator" or self.source.startswith("operator:")):
            raise StudioError("faults are of a synthetic person's line: --source operator[:TASK]")
        if not self.seconds > 0.0:
            raise StudioError("a drive takes time: --seconds over 0")


class FaultyLine(Source):
    """A person whose frames go as JSON over a line that fails, to a stream's gate; `read` turns the
    clock. The same seed fails the same way. One thread only."""

    starts_live = True
    duration: float | None = None

    def __init__(self, person: Source, kind: str, rate: float, seed: int) -> None:
        """kind and rate: as in RATES."""
        self.name = person.name
        self._person, self._kind, self._rate = person, kind, rate
        self._rng = np.random.default_rng([seed, 13])
        self._now, self._silent_until = 0.0, 0.0
        self._line = StreamSource(clock=lambda: self._now)
        self._under_way: list[tuple[float, int, bytes]] = []
        self._number = count()
        self.sent = 0

    @property
    def report(self) -> SourceReport:
        """As the gate's."""
        return self._line.report

    def calibration_poses(self) -> list[HumanPose]:
        """As the person's: somebody calibrates in peace."""
        return self._person.calibration_poses()

    def close(self) -> None:
        """Both ends."""
        self._person.close()
        self._line.close()

    def read(self, t: float) -> HumanPose | None:
        """What came through by `t`, the newest of it."""
        pose = self._person.read(t)
        if pose is not None:
            self._send(t, pose)
        while self._under_way and self._under_way[0][0] <= t + 1e-9:
            self._now, _, raw = heapq.heappop(self._under_way)
            try:
                self._line.push(raw)
            except StudioError:
                continue
        self._now = t
        return self._line.read(t)

    def _send(self, t: float, pose: HumanPose) -> None:
        rng, rate = self._rng, self._rate
        self.sent += 1
        text = frame_text(pose.t, "studio", pose.joint_pos_w.tolist(), pose.confidence.tolist())
        raw, arrives, hit = text.encode(), t, rng.random() < rate
        if self._kind == "silent":
            mean = sum(_SILENCE_S) / 2.0
            begins = rng.random() < rate / (1.0 - rate) * CONTROL_DT / mean
            if t >= self._silent_until and begins:
                self._silent_until = t + rng.uniform(*_SILENCE_S)
            if t < self._silent_until:
                return
        elif self._kind == "dropped" and hit:
            return
        elif self._kind == "late":
            arrives = t + rng.uniform(0.0, rate)
        elif self._kind == "swapped" and hit:
            arrives = t + 1.5 * CONTROL_DT  # behind the next one
        elif self._kind == "spoilt" and hit:
            raw = _spoilt(raw, rng)
        for _ in range(2 if self._kind == "doubled" and hit else 1):
            heapq.heappush(self._under_way, (arrives, next(self._number), raw))


def _spoilt(raw: bytes, rng: np.random.Generator) -> bytes:
    """A few bytes of it changed, or cut off."""
    out = bytearray(raw)
    if rng.random() < 0.5:
        for at in rng.integers(0, len(out), 3):
            out[at] = rng.integers(32, 127)
    else:
        del out[rng.integers(1, len(out)) :]
    return bytes(out)


@dataclass(frozen=True, kw_only=True)
class Driven:
    """One person's drive. falls. followed: share of the periods in which the robot does what the
    person does. joint_sq: mean rad², robot from reference. sent, refused: frames."""

    falls: int
    followed: float
    joint_sq: float
    sent: int
    refused: int


def drive_over(kind: str, rate: float, options: Options, seed: int) -> Driven:
    """A person, drawn from `seed`, over a line that fails."""
    source = FaultyLine(open_source(options.source, seed=seed), kind, rate, seed)
    puppeteer = met(source, PuppeteerConfig(controller=options.controller, seed=seed))
    ticks = [tick for _, tick in set_up_again(puppeteer, source, options.seconds)]
    source.close()
    errors = [metrics.joint_error_sq(t.robot.joint_pos, t.reference.joint_pos) for t in ticks]
    return Driven(
        falls=sum(tick.fallen for tick in ticks),
        followed=sum(not tick.why for tick in ticks) / round(options.seconds / CONTROL_DT),
        joint_sq=float(np.mean(errors)),
        sent=source.sent,
        refused=source.rejected,
    )


def run_faults(
    options: Options, *, drive: Callable[[str, float, Options, int], Driven] = drive_over
) -> dict[str, Any]:
    """`{"rows": [...]}`: a row per kind and rate, all people together."""
    made_by, rows = commit(), []
    for kind, rates in RATES.items():
        for rate in rates:
            each = [drive(kind, rate, options, options.seed + k) for k in range(options.episodes)]
            sent = sum(one.sent for one in each)
            rows.append(
                {
                    "case": kind,
                    "rate": rate,
                    "source": options.source,
                    "controller": options.controller or "policy",
                    "episodes": options.episodes,
                    "seconds": options.seconds * options.episodes,
                    "falls": sum(one.falls for one in each),
                    "followed": float(np.mean([one.followed for one in each])),
                    "refused_share": sum(one.refused for one in each) / max(sent, 1),
                    "joint_rmse_deg": metrics.rms_deg(float(np.mean([x.joint_sq for x in each]))),
                    "seed": options.seed,
                    "commit": made_by,
                }
            )
            log.info("%s %g: %d falls", kind, rate, rows[-1]["falls"])
    return {"rows": rows}
