"""How far an A1 moved between two periods, by its joint angles, tilt, gyro and foot sensors alone.

A foot that stands does not slip, but is a ball and rolls. numpy alone; legs FR FL RR RL, joints hip
thigh calf, rad and m.
"""

import numpy as np

HIP = np.array([[0.1805, -0.047], [0.1805, 0.047], [-0.1805, -0.047], [-0.1805, 0.047]])
SIDE = np.array([-1.0, 1.0, -1.0, 1.0])
THIGH_OFFSET, THIGH, CALF = 0.0838, 0.2, 0.2
FOOT_RADIUS, UPRIGHT = 0.02, -0.895665  # of a standing robot's lower legs


def footholds(z: np.ndarray) -> np.ndarray:
    """(4, 2) feet, roll and pitch undone, less what each has rolled; z as for the runner."""
    hip, thigh, calf = z[:12].reshape(4, 3).T
    down = THIGH * np.cos(thigh) + CALF * np.cos(thigh + calf)
    out = SIDE * THIGH_OFFSET
    x = HIP[:, 0] - THIGH * np.sin(thigh) - CALF * np.sin(thigh + calf)
    y = HIP[:, 1] + out * np.cos(hip) + down * np.sin(hip)
    up = out * np.sin(hip) - down * np.cos(hip)
    (roll, pitch), lifted = z[12:14], np.sin(z[12]) * y + np.cos(z[12]) * up
    rolled = pitch + thigh + calf - UPRIGHT
    return np.stack(
        [
            np.cos(pitch) * x + np.sin(pitch) * lifted - FOOT_RADIUS * rolled,
            np.cos(roll) * y - np.sin(roll) * up + FOOT_RADIUS * (roll + hip),
        ],
        axis=1,
    )


class LegOdometry:
    """Remembers the last period's feet."""

    def __init__(self, z: np.ndarray, contact: np.ndarray) -> None:
        self.feet, self.contact = footholds(z), np.array(contact)

    def step(self, z: np.ndarray, contact: np.ndarray) -> tuple[float, float]:
        """m moved forward and left, in the present heading; z and contact (4,) of this period."""
        feet, stood = footholds(z), self.contact * contact > 0.5
        turn = z[16] / 30.0
        c, s = np.cos(turn), np.sin(turn)
        before = self.feet @ np.array([[c, -s], [s, c]])  # turned by -turn
        moved = np.median((before - feet)[stood], axis=0) if stood.any() else np.zeros(2)
        self.feet, self.contact = feet, np.array(contact)
        return float(moved[0]), float(moved[1])
