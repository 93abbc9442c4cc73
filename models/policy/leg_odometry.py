"""How far an A1 moved between two periods, by its joint angles, tilt, gyro and foot sensors alone.

A foot that stands does not move. numpy alone; legs FR FL RR RL, joints hip thigh calf, rad and m.
"""

import numpy as np

HIP = np.array([[0.1805, -0.047], [0.1805, 0.047], [-0.1805, -0.047], [-0.1805, 0.047]])
SIDE = np.array([-1.0, 1.0, -1.0, 1.0])
THIGH_OFFSET, THIGH, CALF = 0.0838, 0.2, 0.2


def level_feet(z: np.ndarray) -> np.ndarray:
    """(4, 3) feet relative to the trunk with its roll and pitch undone; z as for the runner."""
    hip, thigh, calf = z[:12].reshape(4, 3).T
    down = THIGH * np.cos(thigh) + CALF * np.cos(thigh + calf)
    out = SIDE * THIGH_OFFSET
    x = HIP[:, 0] - THIGH * np.sin(thigh) - CALF * np.sin(thigh + calf)
    y = HIP[:, 1] + out * np.cos(hip) + down * np.sin(hip)
    up = out * np.sin(hip) - down * np.cos(hip)
    (roll, pitch), lifted = z[12:14], np.sin(z[12]) * y + np.cos(z[12]) * up
    return np.stack(
        [
            np.cos(pitch) * x + np.sin(pitch) * lifted,
            np.cos(roll) * y - np.sin(roll) * up,
            np.cos(pitch) * lifted - np.sin(pitch) * x,
        ],
        axis=1,
    )


class LegOdometry:
    """Remembers the last period's feet."""

    def __init__(self, z: np.ndarray, contact: np.ndarray) -> None:
        self.feet, self.contact = level_feet(z), np.array(contact)

    def step(self, z: np.ndarray, contact: np.ndarray) -> tuple[float, float]:
        """m moved forward and left, in the present heading; z and contact (4,) of this period."""
        feet, stood = level_feet(z), self.contact * contact
        turn = z[16] / 30.0
        c, s = np.cos(turn), np.sin(turn)
        before = self.feet[:, :2] @ np.array([[c, -s], [s, c]])  # turned by -turn
        moved = stood @ (before - feet[:, :2]) / max(stood.sum(), 1.0)
        self.feet, self.contact = feet, np.array(contact)
        return float(moved[0]), float(moved[1])
