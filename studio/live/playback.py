"""A take under review, shown again as its edits leave it: both sides at any time, speed, in a loop.

Rows are read from the take's table as they are needed (`recording.columns`), so an hour scrubs as
a minute does.
"""

import numpy as np

from studio.errors import StudioError
from studio.human.pose import HumanPose
from studio.recording.columns import Columns
from studio.recording.edits import Edits
from studio.recording.review import human_at, human_rows
from studio.recording.tick import Tick
from studio.robot import a1, kinematics
from studio.robot.a1 import CONTROL_DT
from studio.robot.pose import ReferencePose, RobotState

_EPS = 1e-9


class Playback:
    """Remembers where in the take it is. Only the loop's thread calls it, but for its making."""

    def __init__(self, name: str, table: Columns, edits: Edits, *, aligned: bool = True) -> None:
        """aligned: the person as lag and warp put them; else as they were recorded. StudioError
        for a take without ticks."""
        if not len(table):
            raise StudioError(f"take {name!r} holds no ticks: nothing to show")
        self.name, self._table, self._edits, self.aligned = name, table, edits, aligned
        self.seconds = (len(table) - 1) * CONTROL_DT
        start, end = edits.trim or (0.0, self.seconds)
        self.range = (min(start, self.seconds), min(end, self.seconds))
        self.t, self.playing, self.speed, self.loop = self.range[0], False, 1.0, False
        self._shown = -1

    def seek(
        self,
        t: float | None = None,
        playing: bool | None = None,
        speed: float | None = None,
        loop: bool | None = None,
    ) -> None:
        """Go to `t` s, play or pause, at a speed (0.1 to 4), again and again within the trim."""
        if speed is not None:
            if not 0.1 - _EPS <= speed <= 4.0 + _EPS:
                raise StudioError(f"speed must be between 0.1 and 4, not {speed}")
            self.speed = speed
        if loop is not None:
            self.loop = loop
        if t is not None:
            self.t = float(np.clip(t, 0.0, self.seconds))
        if playing is not None:
            self.playing = playing
            if playing and self.t >= self.range[1] - _EPS:
                self.t = self.range[0]

    def step(self) -> Tick:
        """The tick to show in this control period; then time goes on."""
        tick = self.at(self.t)
        if self.playing:
            self.t += CONTROL_DT * self.speed
            end = (
                self.range[1] if self.t - CONTROL_DT * self.speed <= self.range[1] else self.seconds
            )
            if self.t >= end - _EPS:
                self.t = self.range[0] if self.loop else end
                self.playing = self.loop
        return tick

    def at(self, t: float) -> Tick:
        """The take at `t` s, to the nearest row."""
        i = int(np.clip(round(t / CONTROL_DT), 0, len(self._table) - 1))
        new, self._shown = i != self._shown, i
        row = self._table.rows[i]
        target = np.asarray(row["reference_joint_pos"], dtype=np.float64)
        return Tick(
            index=i,
            t=i * CONTROL_DT,
            human=self._human(i),
            human_fresh=new,
            expert=self._name(row["expert"]),
            votes={},
            state=self._name(row["state"]),
            transition_to=None,
            mode="replay",
            controller="recorded",
            reference=ReferencePose(**_pose(row, "reference")),
            action=target,
            target=target,
            robot=_robot(row, i * CONTROL_DT),
            clipped=False,
            fallen=bool(row["fallen"]),
            why="" if self.playing else "review: paused; play, or choose live",
        )

    def _human(self, i: int) -> HumanPose | None:
        at = human_rows(np.array([i]), self._edits) if self.aligned else np.array([float(i)])
        joints, confidence = human_at(self._table, at)
        if not np.isfinite(joints).all():
            return None
        return HumanPose(
            t=i * CONTROL_DT,
            joint_pos_w=np.asarray(joints[0], dtype=np.float64),
            confidence=np.asarray(confidence[0], dtype=np.float64),
        )

    def _name(self, index: int) -> str:
        return self._table.names[index] if index < len(self._table.names) else "unknown"


def _pose(row: np.void, who: str) -> dict[str, np.ndarray]:
    keys = ("base_pos", "base_quat", "joint_pos", "foot_contact")
    return {key: np.asarray(row[f"{who}_{key}"], dtype=np.float64) for key in keys}


def _robot(row: np.void, t: float) -> RobotState:
    pose = _pose(row, "robot")
    feet = kinematics.foot_pos_w(pose["base_pos"], pose["base_quat"], pose["joint_pos"])
    return RobotState(
        base_pos=pose["base_pos"],
        base_quat=pose["base_quat"],
        joint_pos=pose["joint_pos"],
        foot_contact=pose["foot_contact"],
        t=t,
        base_lin_vel_w=np.zeros(3),
        base_ang_vel_b=np.zeros(3),
        joint_vel=np.zeros(a1.NUM_JOINTS),
        foot_pos_w=feet,
        torque=np.zeros(a1.NUM_JOINTS),
    )
