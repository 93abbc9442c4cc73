"""The 3-D view: a Tick becomes three figures on a floor, in some twenty messages a frame.

Meshes are sent once, batched by shape; afterwards only poses change. `update` belongs to one
thread (view.py).
"""

from collections.abc import Callable

import numpy as np
import viser
from numpy.typing import NDArray

from studio.geometry import IDENTITY_QUAT
from studio.robot.kinematics import foot_pos_w
from studio.scenes.scene import Scene
from studio.sim.prop_world import PropPoses
from studio.takes.tick import Tick
from studio.web.feet import Feet
from studio.web.figures import STANDING, HumanFigure, RobotFigure
from studio.web.follow import COLUMNS, HALF_TURN, WIDE_COLUMNS, Above, Follow, faced_away
from studio.web.scene_props import Props

Array = NDArray[np.float64]

REFERENCE_TINT = (92, 156, 255)
GRID_SECTION = 0.5
CAPTION_GAP = 0.06
"""Between a figure's highest point and its caption, m."""


def _above(name: str) -> Above:
    """A robot's caption is never lower than over one that stands; a person's follows the head down
    into a squat, but not every step of a march."""
    if name == "human":
        return Above(0.4, CAPTION_GAP, first=STANDING + CAPTION_GAP, slack=0.05)
    return Above(0.52, CAPTION_GAP)


class Caption:
    """A point above a figure at which the page hangs what it says of it."""

    def __init__(self, scene: viser.SceneApi, name: str) -> None:
        self._column, self._above = COLUMNS[name], _above(name)
        self._shown = self._above.height
        self._frame = scene.add_frame(f"/{name}/caption", show_axes=False, position=self._at())

    def rise(self, top: float, dt: float, column: Array) -> None:
        """Over a figure in this column that reaches up to `top` m; a page is told of whole
        centimetres only."""
        if abs(self._above.push(top, dt) - self._shown) > 0.01 or column is not self._column:
            self._shown, self._column = self._above.height, column
            self._frame.position = self._at()

    def _at(self) -> tuple[float, float, float]:
        return float(self._column[0]), float(self._column[1]), self._shown


class World:
    """Where a robot's own world lies in the view: props are in it, and what a page adds."""

    def __init__(self, scene: viser.SceneApi, figure: str) -> None:
        self._frame = scene.add_frame(f"/{figure}/world", show_axes=False)

    def move(self, shift: Array, about: Array | None) -> None:
        """By (3,) m; about: the column (3,) m that it is turned about by half a turn, if any."""
        turn = IDENTITY_QUAT if about is None else HALF_TURN
        if not np.array_equal(turn, self._frame.wxyz):
            self._frame.wxyz = turn
        at = shift if about is None else faced_away(shift, about)
        self._frame.position = (float(at[0]), float(at[1]), float(at[2]))


class StudioScene:
    """Everything in the view. One thread calls `update`.

    mirror: whether the person moves as in a mirror. What is shown to be acted out faces them then;
    else they stand behind it, their left being its left. props: those beside the simulated robot.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        mirror: Callable[[], bool] = lambda: True,
        props: Callable[[], tuple[Scene, PropPoses] | None] = lambda: None,
    ) -> None:
        self._server, self._mirror, self._props_now = server, mirror, props
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
        # In the place of the environment where a processor draws: the page turns it up there.
        scene.add_light_hemisphere(
            "/lights/fill", sky_color=(235, 240, 255), ground_color=(120, 116, 110), intensity=0.0
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
        for name in COLUMNS:  # a page may move a figure whole: nothing else is told of these
            scene.add_frame(f"/{name}", show_axes=False)
        self._human = HumanFigure(scene)
        self._figures = {
            "reference": RobotFigure(scene, "reference", tint=REFERENCE_TINT, opacity=0.62),
            "robot": RobotFigure(scene, "robot"),
        }
        self._feet = {name: Feet(scene, name) for name in self._figures}
        self._worlds = {name: World(scene, name) for name in self._figures}
        self._props = Props(scene)
        self._captions = {name: Caption(scene, name) for name in COLUMNS}
        self._follow = {"reference": Follow(), "robot": Follow()}
        self._last_t = -np.inf

    def update(self, tick: Tick, dt: float) -> None:
        """Show `tick`; dt: seconds since the tick shown before."""
        if tick.t < self._last_t:
            self._human.reset()
        self._last_t = tick.t
        away = tick.mode == "collect" and not self._mirror()
        props = self._props_now()
        columns = COLUMNS if props is None else WIDE_COLUMNS
        with self._server.atomic():
            top = self._human.update(tick.human, dt, columns["human"], away)
            self._captions["human"].rise(top, dt, columns["human"])
            ref = tick.reference
            all_feet = {
                "reference": foot_pos_w(ref.base_pos, ref.base_quat, ref.joint_pos),
                "robot": tick.robot.foot_pos_w,
            }
            poses = {"reference": ref, "robot": tick.robot}
            here = {name: self._follow[name].push(p.base_pos[:2], dt) for name, p in poses.items()}
            for name, pose in poses.items():
                shift = columns[name] - np.append(here[name], 0.0)
                feet = all_feet[name] + shift
                about = columns[name] if away else None
                self._worlds[name].move(shift, about)
                if about is not None:
                    feet = faced_away(feet, about)
                top = self._figures[name].update(pose, shift, about)
                self._captions[name].rise(max(top, feet[:, 2].max()), dt, columns[name])
                self._feet[name].update(feet, pose.foot_contact)
            self._props.update(props)
            # The floor passes under the simulated robot; its pattern repeats every section.
            floor = np.mod((1.0 if away else -1.0) * here["robot"], GRID_SECTION)
            self._floor.position = (float(floor[0]), float(floor[1]), 0.0)
        self._server.flush()
