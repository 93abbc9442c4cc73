"""The figures of the view: the person, and an A1 twice, each a few batches of one shape."""

import numpy as np
import viser
from numpy.typing import NDArray

from studio.geometry import quat_mul, quat_rotate
from studio.human.pose import HumanPose
from studio.human.shape import BONES, JOINT_RADII
from studio.robot import a1
from studio.robot.kinematics import link_frames_w
from studio.robot.meshes import link_meshes
from studio.robot.pose import RobotPose
from studio.web import shapes
from studio.web.follow import HALF_TURN, HUMAN_COLUMN, HUMAN_SCALE, HumanPlace, faced_away
from studio.web.scene_batch import HIDDEN, Batch

Array = NDArray[np.float64]

NOSE_AND_TAIL = np.array([[0.27, 0.0, 0.06], [-0.25, 0.0, 0.06]])
"""(2, 3) m, upper ends of the trunk in its own frame."""
STANDING = 1.0
"""How high the person reaches before anybody was seen, m."""


class HumanFigure:
    """The person: 18 bones and 19 joints in two batches."""

    def __init__(self, scene: viser.SceneApi) -> None:
        self._place = HumanPlace()
        self._top = STANDING
        n_bones, n_joints = len(BONES), len(JOINT_RADII)
        bone, ball = shapes.bone_mesh(), shapes.ball_mesh()
        self._bones = Batch(scene, "/human/bones", bone, n_bones, shapes.BONE_COLORS, scaled=True)
        self._joints = Batch(
            scene, "/human/joints", ball, n_joints, shapes.JOINT_COLORS, scaled=True
        )
        self._radii = HUMAN_SCALE * np.repeat(JOINT_RADII[:, None], 3, axis=1)

    def reset(self) -> None:
        """Another source: find floor and heading anew."""
        self._place.reset()

    def update(self, pose: HumanPose | None, dt: float, column: Array, away: bool) -> float:
        """Draw the pose at `column` (3,) m; joints that were not seen, and bones that end in them,
        vanish.

        away: seen from behind. Returns how high what is drawn reaches, m: of whom nobody sees any
        more, the last pose.
        """
        if pose is None:
            return self._top
        joints = self._place.place(pose, dt) + (column - HUMAN_COLUMN)
        if away:
            joints = faced_away(joints, column)
        unseen = pose.confidence <= 0.0
        start, wxyz, scale = shapes.bone_transforms(joints)
        scale[:, :2] *= HUMAN_SCALE
        scale[unseen[shapes.BONE_END] | unseen[shapes.BONE_START]] = HIDDEN
        self._bones.move(start, wxyz, scale)
        radii = np.where(unseen[:, None], HIDDEN, self._radii)
        self._joints.move(joints, scale=radii)
        if not unseen.all():
            self._top = float(np.max((joints[:, 2] + self._radii[:, 2])[~unseen]))
        return self._top


class RobotFigure:
    """An A1: links of the same shape share one batch."""

    def __init__(
        self,
        scene: viser.SceneApi,
        name: str,
        *,
        tint: tuple[int, int, int] | None = None,
        opacity: float | None = None,
    ) -> None:
        meshes = link_meshes()
        groups: dict[bytes, list[str]] = {}
        for link, mesh in meshes.items():
            groups.setdefault(mesh.vertices.tobytes() + mesh.faces.tobytes(), []).append(link)
        self._batches: list[tuple[NDArray[np.intp], Batch]] = []
        for links in groups.values():
            mesh = meshes[links[0]]
            shape = shapes.Mesh(vertices=mesh.vertices, faces=mesh.faces)
            batch = Batch(
                scene, f"/{name}/{links[0]}", shape, len(links), tint or mesh.color, opacity=opacity
            )
            self._batches.append((np.array([a1.LINKS.index(link) for link in links]), batch))

    def update(self, pose: RobotPose, shift: Array, away: Array | None) -> float:
        """Draw the pose, its world moved by `shift` (3,) m; returns how high it reaches, m.

        But for its feet, which are not links. away: the column (3,) m that it is turned about.
        """
        pos, quat = link_frames_w(pose.base_pos, pose.base_quat, pose.joint_pos)
        pos = pos + shift
        if away is not None:
            pos, quat = faced_away(pos, away), quat_mul(HALF_TURN, quat)
        for links, batch in self._batches:
            batch.move(pos[links], quat[links])
        ends = pos[0] + quat_rotate(quat[0], NOSE_AND_TAIL)
        return float(max(ends[:, 2].max(), pos[:, 2].max()))
