"""On three legs: the trunk moved over the feet that carry it, as far as the floor's slope needs.

The library brings the centre of mass 4.5 cm inside the long side of the support triangle, an expert
repeats that within a centimetre or two, and a slope of 8° moves what is under it by 3.7 cm. Whoever
held a paw up there tipped over that side; 8 cm inside, wherever the floor fell to, over the other.
"""

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.robot import kinematics

Array = NDArray[np.float64]

MARGIN = 0.065
"""m inside the long side; 8.9 cm is the middle of the triangle."""
FARTHEST = 0.1
"""m, the most that the trunk moves."""
RAISED, STANDING = 0.3, 0.6
"""Contact under which a front paw is up, and over which the other feet stand."""
RAMP_S = 0.25
"""In which the trunk moves there and back."""


class SupportMargin:
    """Remembers how far the trunk has moved over, and for which paw; `reset` forgets."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """All four feet stand."""
        self._share, self._paw = 0.0, 0

    def step(
        self, joint_pos: Array, base_quat: Array, contact: Array, dt: float, slope: Array
    ) -> Array:
        """Joint angles (12,) rad with the trunk moved level over the standing feet.

        base_quat (4,) wxyz, contact (4,) 0 to 1, slope (2,) m that the floor rises a metre, world.
        The raised leg keeps its pose against the trunk.
        """
        paw = int(np.argmin(contact[:2]))
        raised = contact[paw] < RAISED and np.delete(contact, paw).min() > STANDING
        if raised:
            self._paw = paw
        change = (1.0 if raised else -1.0) * dt / RAMP_S
        self._share = min(max(self._share + change, 0.0), 1.0)
        if self._share == 0.0:
            return joint_pos
        paw = self._paw
        feet_b = kinematics.foot_pos_b(joint_pos)
        feet_3d = geometry.quat_rotate(base_quat, feet_b)
        com_3d = geometry.quat_rotate(base_quat, kinematics.center_of_mass_b(joint_pos))
        height = com_3d[2] - np.delete(feet_3d[:, 2], paw).mean()
        feet, com = feet_3d[:, :2], com_3d[:2] - height * slope  # what is under it lies downhill
        # The long side runs from the other front foot to the hind foot behind the raised paw.
        side, foot, inner = feet[1 - paw], feet[2 + paw], feet[3 - paw]
        along = foot - side
        inwards = np.array([-along[1], along[0]]) / max(float(np.hypot(*along)), 1e-9)
        if inwards @ (inner - side) < 0.0:
            inwards = -inwards
        missing = min(MARGIN - float(inwards @ (com - side)), FARTHEST)
        if missing <= 0.0:
            return joint_pos
        by = np.append(self._share * missing * inwards, 0.0)
        moved = feet_b - geometry.quat_rotate(geometry.quat_conj(base_quat), by)
        own, out = slice(3 * paw, 3 * paw + 3), kinematics.leg_ik(moved, near=joint_pos)[0]
        out[own] = joint_pos[own]
        return out
