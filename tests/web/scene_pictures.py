"""The README's picture of *greeting*, step by step: `make pictures`.

The scripted operator's attempt, drawn by MuJoCo at the moment that tells each step. Needs an OpenGL
without a screen (`MUJOCO_GL`, egl by default), no browser; half a minute.
"""

import argparse
import os
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "egl")

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from studio import geometry
from studio.evaluation.composite import Job, act_out, puppeteer_of
from studio.robot.meshes import link_meshes
from studio.scenes import greeting
from studio.sim.spec import build_spec
from studio.takes.tick import Tick

JOB = Job(scene="greeting", controller="policy", style="march", seed=1)
SIZE, GAP = (420, 400), 6
"""px: of each step's picture, and between two."""
FLOOR, SKY, INK = (0.62, 0.66, 0.71), (0.93, 0.95, 0.97), (30, 36, 46)


@dataclass(frozen=True, kw_only=True)
class Frame:
    """One period. step: being done; qpos: of the world; base (3,) and ball (3,) m; lean: rad."""

    step: str
    qpos: np.ndarray
    base: np.ndarray
    ball: np.ndarray
    lean: float


def acted() -> list[Frame]:
    """The whole attempt."""
    puppeteer = puppeteer_of(JOB)
    stage = puppeteer.stage
    frames: list[Frame] = []
    doing = stage.step_now

    def keep(tick: Tick) -> None:
        nonlocal doing
        assert doing is not None
        assert stage.seen is not None
        up = geometry.up_in_body(tick.robot.base_quat)
        frames.append(
            Frame(
                step=doing.name,
                qpos=stage.world.data.qpos.copy(),
                base=tick.robot.base_pos,
                ball=stage.seen.pos["ball"],
                lean=float(np.arccos(np.clip(up[2], -1.0, 1.0))),
            )
        )
        doing = stage.step_now  # the period in which a step is done still shows it

    run = act_out(JOB, puppeteer, keep)
    assert not run.failed, run.failed
    return frames


def telling(frames: list[Frame]) -> dict[str, Frame]:
    """For each step the frame that shows it best."""

    def of(step: str) -> list[Frame]:
        return [frame for frame in frames if frame.step == step]

    halfway = 0.5 * greeting.SCENE.props[0].pos[0]
    return {
        "greet": max(of("greet"), key=lambda f: f.lean),
        "walk 3 m": min(of("walk"), key=lambda f: abs(f.base[0] - halfway)),
        "duck under a thrown ball": min(
            of("dodge"), key=lambda f: np.hypot(*(f.ball - f.base)[:2] - [0.1, 0.0])
        ),
        "touch a ball": of("touch")[-1],
        "sit, and reach 0.8 m": of("reach")[-1],
    }


def drawn_model() -> mujoco.MjModel:
    """The scene with Unitree's shapes on the robot, lit; coordinates as in the simulated one."""
    spec = build_spec()
    for geom in spec.geoms:
        geom.rgba = [*FLOOR, 1.0] if geom.name == "floor" else [0.0, 0.0, 0.0, 0.0]
    for name, link in link_meshes().items():
        faces = link.faces.astype(np.int32)
        spec.add_mesh(
            name=name, uservert=link.vertices.ravel(), userface=faces.ravel(),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        )  # fmt: skip
        spec.body(name).add_geom(
            name=f"{name}_drawn", type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name,
            rgba=[*np.divide(link.color, 255.0), 1.0], contype=0, conaffinity=0, mass=0.0,
        )  # fmt: skip
    for prop in greeting.SCENE.props:
        prop(spec)
    spec.worldbody.add_light(
        pos=[1.0, -2.0, 5.0], dir=[0.1, 0.35, -1.0], diffuse=[0.55] * 3, castshadow=True,
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
    )  # fmt: skip
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.45] * 3, [0.3] * 3
    spec.visual.quality.shadowsize, spec.visual.quality.offsamples = 4096, 8
    spec.add_texture(
        name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, width=64, height=384,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT, rgb1=SKY, rgb2=SKY,
    )  # fmt: skip
    return spec.compile()


def drawn(frames: dict[str, Frame]) -> Image.Image:
    """All steps beside each other, each named."""
    model = drawn_model()
    data = mujoco.MjData(model)
    font = ImageFont.load_default(20)
    strip = Image.new("RGB", ((SIZE[0] + GAP) * len(frames) - GAP, SIZE[1]), "white")
    with mujoco.Renderer(model, SIZE[1], SIZE[0]) as renderer:
        for k, (says, frame) in enumerate(frames.items()):
            data.qpos[:] = frame.qpos
            mujoco.mj_forward(model, data)
            camera = mujoco.MjvCamera()
            camera.lookat = [frame.base[0] + 0.25, frame.base[1], 0.42]
            # A lean to a side is seen from ahead.
            azimuth = 165.0 if says == "greet" else 118.0
            camera.distance, camera.azimuth, camera.elevation = 2.1, azimuth, -12.0
            renderer.update_scene(data, camera)
            picture = Image.fromarray(renderer.render())
            ImageDraw.Draw(picture).text((12, 8), f"{k + 1}  {says}", INK, font)
            strip.paste(picture, (k * (SIZE[0] + GAP), 0))
    return strip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("web_assets/screenshots"))
    folder = parser.parse_args().folder
    drawn(telling(acted())).save(folder / "greeting.webp", quality=88, method=6)
    print("greeting.webp")  # noqa: T201


if __name__ == "__main__":
    main()
