"""The 3-D view: a Tick becomes three figures on a floor, in some twenty messages a frame.

Meshes are sent once, batched by shape; afterwards only poses change. `update` belongs to one
thread (view.py).
"""

from collections.abc import Callable

import numpy as np
import viser
from numpy.typing import NDArray

from studio.geometry import quat_mul, quat_rotate
from studio.human.pose import HumanPose
from studio.human.shape import BONES, JOINT_RADII
from studio.robot import a1
from studio.robot.kinematics import foot_pos_w, link_frames_w
from studio.robot.meshes import link_meshes
from studio.robot.pose import RobotPose
from studio.takes.tick import Tick
from studio.web import shapes
from studio.web.follow import (
    HALF_TURN,
    HUMAN_COLUMN,
    HUMAN_SCALE,
    REFERENCE_COLUMN,
    ROBOT_COLUMN,
    Above,
    Follow,
    HumanPlace,
    faced_away,
)
from studio.web.scene_batch import HIDDEN, Batch

Array = NDArray[np.float64]

REFERENCE_TINT = (92, 156, 255)
CONTACT_ON = np.array([46, 204, 130], dtype=np.float64)
CONTACT_OFF = np.array([120, 128, 145], dtype=np.float64)
CONTACT_RADIUS = 0.036
GRID_SECTION = 0.5
COLUMNS = {"human": HUMAN_COLUMN, "reference": REFERENCE_COLUMN, "robot": ROBOT_COLUMN}
CAPTION_HEIGHTS = {"human": 1.06, "reference": 0.52, "robot": 0.52}
"""Where the page hangs its captions above each figure that stands, m: the least."""
CAPTION_GAP = 0.06
"""Between a figure's highest point and its caption, m."""
NOSE_AND_TAIL = np.array([[0.27, 0.0, 0.06], [-0.25, 0.0, 0.06]])
"""(2, 3) m, upper ends of the trunk in its own frame."""


class HumanFigure:
    """The person: 18 bones and 19 joints in two batches."""

    def __init__(self, scene: viser.SceneApi) -> None:
        self._place = HumanPlace()
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

    def update(self, pose: HumanPose | None, dt: float, away: bool) -> float:
        """Draw the pose; joints that were not seen, and bones that end in them, vanish.

        away: seen from behind. Returns how high it reaches, m.
        """
        if pose is None:
            return 0.0
        joints = self._place.place(pose, dt)
        if away:
            joints = faced_away(joints, HUMAN_COLUMN)
        unseen = pose.confidence <= 0.0
        start, wxyz, scale = shapes.bone_transforms(joints)
        scale[:, :2] *= HUMAN_SCALE
        scale[unseen[shapes.BONE_END] | unseen[shapes.BONE_START]] = HIDDEN
        self._bones.move(start, wxyz, scale)
        radii = np.where(unseen[:, None], HIDDEN, self._radii)
        self._joints.move(joints, scale=radii)
        return float(np.max(joints[:, 2] + self._radii[:, 2], where=~unseen, initial=0.0))


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


class Caption:
    """A point above a figure at which the page hangs what it says of it."""

    def __init__(self, scene: viser.SceneApi, name: str, column: Array) -> None:
        self._column, self._above = column, Above(CAPTION_HEIGHTS[name], CAPTION_GAP)
        self._shown = self._above.height
        self._frame = scene.add_frame(f"/captions/{name}", show_axes=False, position=self._at())

    def rise(self, top: float, dt: float) -> None:
        """Over a figure that reaches up to `top` m; a page is told of whole centimetres only."""
        if abs(self._above.push(top, dt) - self._shown) > 0.01:
            self._shown = self._above.height
            self._frame.position = self._at()

    def _at(self) -> tuple[float, float, float]:
        return float(self._column[0]), float(self._column[1]), self._shown


class StudioScene:
    """Everything in the view. One thread calls `update`.

    mirror: whether the person moves as in a mirror. What is shown to be acted out faces them then;
    else they stand behind it, their left being its left.
    """

    def __init__(
        self, server: viser.ViserServer, mirror: Callable[[], bool] = lambda: True
    ) -> None:
        self._server, self._mirror = server, mirror
        scene = server.scene
        server.initial_camera.position = (3.1, -1.2, 1.35)
        server.initial_camera.look_at = (0.0, -0.03, 0.45)
        server.initial_camera.fov = 0.5
        # One light with one shadow map: viser's default draws every mesh three times more.
        scene.configure_default_lights(enabled=False)
        scene.configure_environment_map("studio", environment_intensity=0.42)
        scene.add_light_spot(
            "/lights/key",
            position=(2.2, -1.6, 4.2),
            direction=(-2.2, 1.6, -4.2),
            angle=0.62,
            penumbra=0.9,
            decay=0.0,
            intensity=1.7,
            cast_shadow=True,
        )
        self._floor = scene.add_grid(
            "/floor",
            width=16.0,
            height=16.0,
            cell_size=GRID_SECTION / 5,
            section_size=GRID_SECTION,
            cell_color=(130, 140, 160),
            section_color=(110, 122, 148),
            cell_thickness=0.5,
            section_thickness=0.9,
            fade_distance=7.0,
            fade_strength=2.2,
            fade_from="origin",
            shadow_opacity=0.32,
        )
        self._human = HumanFigure(scene)
        self._figures = {
            "reference": RobotFigure(scene, "reference", tint=REFERENCE_TINT, opacity=0.62),
            "robot": RobotFigure(scene, "robot"),
        }
        self._contacts = Batch(
            scene,
            "/contacts",
            shapes.disc_mesh(),
            8,
            np.tile(CONTACT_OFF, (8, 1)),
            scaled=True,
            shadow=False,
        )
        self._captions = {name: Caption(scene, name, at) for name, at in COLUMNS.items()}
        self._follow = {"reference": Follow(), "robot": Follow()}
        self._last_t = -np.inf

    def update(self, tick: Tick, dt: float) -> None:
        """Show `tick`; dt: seconds since the tick shown before."""
        if tick.t < self._last_t:
            self._human.reset()
        self._last_t = tick.t
        away = tick.mode == "collect" and not self._mirror()
        with self._server.atomic():
            self._captions["human"].rise(self._human.update(tick.human, dt, away), dt)
            ref = tick.reference
            feet = {
                "reference": foot_pos_w(ref.base_pos, ref.base_quat, ref.joint_pos),
                "robot": tick.robot.foot_pos_w,
            }
            shifts = {}
            for name, pose in (("reference", ref), ("robot", tick.robot)):
                xy = self._follow[name].push(pose.base_pos[:2], dt)
                shifts[name] = COLUMNS[name] - np.array([xy[0], xy[1], 0.0])
                feet[name] = feet[name] + shifts[name]
                about = COLUMNS[name] if away else None
                if about is not None:
                    feet[name] = faced_away(feet[name], about)
                top = self._figures[name].update(pose, shifts[name], about)
                self._captions[name].rise(max(top, feet[name][:, 2].max()), dt)
            self._update_contacts(tick, np.concatenate([feet["reference"], feet["robot"]]))
            # The floor passes under the simulated robot; its pattern repeats every section.
            under = ROBOT_COLUMN - shifts["robot"]
            floor = -np.mod(-under if away else under, GRID_SECTION)
            self._floor.position = (float(floor[0]), float(floor[1]), 0.0)
        self._server.flush()

    def _update_contacts(self, tick: Tick, feet: Array) -> None:
        """Discs under the feet (8, 3) of both robots, green where one stands."""
        contact = np.concatenate([tick.reference.foot_contact, tick.robot.foot_contact])[:, None]
        feet[:, 2] = 0.002
        contact = np.clip(contact, 0.0, 1.0)
        radius = np.repeat(CONTACT_RADIUS * (0.55 + 0.45 * contact), 3, axis=1)
        color = CONTACT_OFF + contact * (CONTACT_ON - CONTACT_OFF)
        self._contacts.move(feet, scale=radius, color=color)
