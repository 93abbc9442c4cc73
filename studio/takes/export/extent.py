"""What of a take an export covers: the ticks that trim and cuts leave, the person in step."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.human.pose import HumanPose
from studio.human.skeleton import NUM_JOINTS
from studio.takes.edit import edited
from studio.takes.take import Take

Array = NDArray[np.float64]

HELD = 6
"""Ticks (0.2 s): what is seen less often than that paused."""


def tick_range(take: Take) -> tuple[int, int]:
    """First tick and one past the last of what the trim leaves."""
    return edited.trimmed(len(take), take.edits)


def human_poses(take: Take) -> list[HumanPose]:
    """The fresh human poses within the trim."""
    start, end = tick_range(take)
    used = [n for n in take.human_tick.tolist() if start <= n < end]
    return [pose for n in used if (pose := take.ticks[n].human) is not None]


def steady_human(take: Take) -> Array:
    """(N, 19, 3) m: the person at each tick of the trim from the first in which they were seen.

    Between poses that are at most HELD apart on the straight line, in longer pauses as seen last.
    """
    if take.human is None:
        return np.zeros((0, NUM_JOINTS, 3))
    start, end = tick_range(take)
    ticks = np.arange(max(start, int(take.human_tick[0])), end)
    low = take.arrays.human_index[ticks]
    high = np.minimum(low + 1, len(take.human_tick) - 1)
    since, wait = ticks - take.human_tick[low], take.human_tick[high] - take.human_tick[low]
    w = np.where((wait > 0) & (wait <= HELD), since / np.maximum(wait, 1), 0.0)[:, None, None]
    return (1.0 - w) * take.human.joint_pos_w[low] + w * take.human.joint_pos_w[high]


@dataclass(frozen=True, kw_only=True)
class Extent:
    """The N ticks an episode of learning covers, and who was seen in them.

    tick: (N,). human: (N, 19, 3) m and confidence (N, 19), shifted and warped as the edits say;
    zeros and confidence 0 where nobody was seen.
    """

    tick: NDArray[np.int64]
    human: Array
    confidence: Array


def extent(take: Take) -> Extent:
    """The ticks within the trim and outside the cuts, with the person who belongs to each."""
    ticks = np.flatnonzero(edited.kept(len(take), take.edits))
    human, confidence = np.zeros((len(ticks), NUM_JOINTS, 3)), np.zeros((len(ticks), NUM_JOINTS))
    if take.human is not None and len(ticks):
        at = np.clip(edited.human_rows(ticks, take.edits), 0, len(take) - 1)
        low = np.floor(at).astype(int)
        high = np.ceil(at).astype(int)
        index = take.arrays.human_index
        there = (index[low] >= 0) & (index[high] >= 0)
        a, b = np.maximum(index[low], 0), np.maximum(index[high], 0)
        w = (at - low)[:, None, None]
        pos, sure = take.human.joint_pos_w, take.human.confidence
        human = np.where(there[:, None, None], (1.0 - w) * pos[a] + w * pos[b], 0.0)
        confidence = np.where(there[:, None], np.minimum(sure[a], sure[b]), 0.0)
    return Extent(tick=ticks, human=human, confidence=confidence)
