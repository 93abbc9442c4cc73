"""A take as its edits leave it, seen at any time: one row of its table as a Tick.

Rows are read from the table as they are needed (`recording.columns`), so an hour is as near as a
minute.
"""

import numpy as np

from studio.errors import StudioError
from studio.human.pose import HumanPose
from studio.robot import a1, kinematics
from studio.robot.a1 import CONTROL_DT
from studio.robot.pose import ReferencePose, RobotState
from studio.takes.columns import Columns
from studio.takes.edit.edited import human_at, human_rows
from studio.takes.edit.edits import Edits
from studio.takes.tick import Tick


class Viewed:
    """aligned: the person as lag and warp put them; else as they were recorded."""

    def __init__(self, name: str, table: Columns, edits: Edits, *, aligned: bool = True) -> None:
        """StudioError for a take without ticks."""
        if not len(table):
            raise StudioError(f"take {name!r} holds no ticks: nothing to show")
        self._table, self._edits, self.aligned = table, edits, aligned
        self.seconds = (len(table) - 1) * CONTROL_DT

    def at(self, t: float) -> Tick:
        """The take at `t` s, to the nearest row."""
        i = int(np.clip(round(t / CONTROL_DT), 0, len(self._table) - 1))
        row = self._table.rows[i]
        target = np.asarray(row["reference_joint_pos"], dtype=np.float64)
        return Tick(
            index=i,
            t=i * CONTROL_DT,
            human=self._human(i),
            human_fresh=True,
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
