"""Unitree's A1 URDF, a floor and props to one MuJoCo model.

Masses, inertias, joints and limits come from the URDF of the registry package
`example-robot-data`; collision shapes are the capsules of `robot.collision`, so that the simulator
and the closed-form clearances agree. Names: body = link (a1.LINKS), joint and actuator = a1.JOINTS,
geom = capsule, "floor"; sensors below.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from studio import geometry
from studio.robot import a1
from studio.robot.collision import CAPSULES, PAIRS
from studio.robot.description import load_urdf

Prop = Callable[[mujoco.MjSpec], None]
"""Adds bodies to the world before it is compiled."""

WORLD_BIT, ROBOT_BIT = 1, 2
"""Contact bits. Props: contype WORLD_BIT, conaffinity WORLD_BIT | ROBOT_BIT."""


@dataclass(frozen=True, kw_only=True)
class ModelConfig:
    """How the world is built. SI units.

    timestep: physics step, s. kp, kd: PD gains of every actuator, N m/rad and N m s/rad.
    armature: rotor inertia seen at each joint, kg m^2. friction: of the robot against anything.
    self_collision: links of the robot collide. leg_contact: thighs and calves collide with the
    floor (sitting needs it; walking may save its cost).
    """

    timestep: float = 1.0 / 240.0
    kp: float = a1.KP
    kd: float = a1.KD
    armature: float = a1.ARMATURE
    friction: float = 1.0
    self_collision: bool = True
    leg_contact: bool = True


def build_spec(config: ModelConfig = ModelConfig()) -> mujoco.MjSpec:
    """The editable world: floor and A1, not compiled yet."""
    spec = mujoco.MjSpec()
    spec.modelname = "a1"
    spec.compiler.degree = False
    # The URDF's feet and IMU are fixed links: fused into the calves and the trunk. The trunk has
    # its free joint by then, so that it is not fused into the world (which would lose its 6 kg).
    spec.compiler.fusestatic = True
    option = spec.option
    option.timestep = config.timestep
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_PYRAMIDAL
    option.iterations, option.ls_iterations = 10, 20
    spec.worldbody.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0.0, 0.0, 0.05],
        contype=WORLD_BIT,
        conaffinity=0,
        friction=[config.friction, 0.005, 0.0001],
    )
    trunk = spec.worldbody.add_body(name="trunk", pos=[0.0, 0.0, a1.STAND_HEIGHT])
    trunk.add_freejoint(name="base")
    _add_links(trunk, "trunk", config)
    _add_capsules(spec, config)
    _exclude_pairs(spec)
    _add_actuators(spec, config)
    _add_sensors(spec, trunk)
    return spec


def build_model(config: ModelConfig = ModelConfig(), props: Sequence[Prop] = ()) -> mujoco.MjModel:
    """The compiled world: qpos (7 + 12 + props), ctrl (12,) joint targets in rad."""
    spec = build_spec(config)
    for add_to in props:
        add_to(spec)
    return spec.compile()


def _add_links(body: mujoco.MjsBody, link_name: str, config: ModelConfig) -> None:
    """Fill `body` with the inertia of its link and add the links that hang on it."""
    robot = load_urdf()
    link = next(link for link in robot.links if link.name == link_name)
    inertial = link.inertial
    if inertial is not None and inertial.mass:
        origin = np.eye(4) if inertial.origin is None else inertial.origin
        i = np.asarray(inertial.inertia)
        body.mass = float(inertial.mass)
        body.ipos = origin[:3, 3]
        body.fullinertia = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]
        body.explicitinertial = True
    for joint in robot.joints:
        if joint.parent != link_name or joint.child.endswith("_thigh_shoulder"):
            continue  # the shoulder has neither mass nor a shape of ours
        origin = np.eye(4) if joint.origin is None else joint.origin
        child = body.add_body(
            name=joint.child, pos=origin[:3, 3], quat=geometry.quat_from_matrix(origin[:3, :3])
        )
        if joint.type == "revolute":
            assert joint.limit is not None
            child.add_joint(
                name=joint.name.removesuffix("_joint"),
                type=mujoco.mjtJoint.mjJNT_HINGE,
                axis=joint.axis,
                range=[joint.limit.lower, joint.limit.upper],
                limited=True,
                armature=config.armature,
                # A stop must hold a 33.5 N m motor within 0.02 rad.
                solref_limit=[2.0 * config.timestep, 1.0],
                solimp_limit=[0.98, 0.999, 0.001, 0.5, 2.0],
            )
        _add_links(child, joint.child, config)


def _add_capsules(spec: mujoco.MjSpec, config: ModelConfig) -> None:
    for capsule in CAPSULES:
        start, end = np.array(capsule.start), np.array(capsule.end)
        limb = capsule.name.endswith(("_thigh", "_calf"))
        common = {
            "name": capsule.name,
            "contype": ROBOT_BIT if config.self_collision else 0,
            "conaffinity": (0 if limb and not config.leg_contact else WORLD_BIT)
            | (ROBOT_BIT if config.self_collision else 0),
            "friction": [config.friction, 0.005, 0.0001],
            "priority": 1,  # the robot's own friction counts, whatever it touches
            "mass": 0.0,
            "solref": [0.01, 1.0],
        }
        body = spec.body(capsule.link)
        if np.array_equal(start, end):
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_SPHERE, pos=start, size=[capsule.radius, 0, 0], **common
            )
        else:
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_CAPSULE,
                fromto=np.concatenate([start, end]),
                size=[capsule.radius, 0, 0],
                **common,
            )


def _exclude_pairs(spec: mujoco.MjSpec) -> None:
    """Only the pairs of `robot.collision` may touch (MuJoCo itself leaves parent and child out)."""
    allowed = {frozenset((CAPSULES[i].link, CAPSULES[j].link)) for i, j in PAIRS}
    for i, first in enumerate(a1.LINKS):
        for second in a1.LINKS[i + 1 :]:
            if frozenset((first, second)) not in allowed:
                spec.add_exclude(bodyname1=first, bodyname2=second)


def _add_actuators(spec: mujoco.MjSpec, config: ModelConfig) -> None:
    limits = zip(a1.JOINTS, a1.JOINT_LOWER, a1.JOINT_UPPER, a1.TORQUE_LIMIT)
    for name, lower, upper, torque in limits:
        # Affine bias: force = kp ctrl - kp q - kd qd. Gains are plain model fields
        # (actuator_gainprm[:, 0], actuator_biasprm[:, 1:3]) and may differ per simulation.
        spec.add_actuator(
            name=name,
            target=name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            gaintype=mujoco.mjtGain.mjGAIN_FIXED,
            biastype=mujoco.mjtBias.mjBIAS_AFFINE,
            gainprm=[config.kp] + [0.0] * 9,
            biasprm=[0.0, -config.kp, -config.kd] + [0.0] * 7,
            ctrlrange=[lower, upper],
            ctrllimited=True,
            forcerange=[-torque, torque],
            forcelimited=True,
        )


def _add_sensors(spec: mujoco.MjSpec, trunk: mujoco.MjsBody) -> None:
    """ "imu_quat", "imu_gyro", "imu_acc" of the trunk; "FR_touch" … normal force on a foot, N."""
    trunk.add_site(name="imu", pos=[0.0, 0.0, 0.0])
    kinds = mujoco.mjtSensor
    for name, kind in (
        ("imu_quat", kinds.mjSENS_FRAMEQUAT),
        ("imu_gyro", kinds.mjSENS_GYRO),
        ("imu_acc", kinds.mjSENS_ACCELEROMETER),
    ):
        spec.add_sensor(name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="imu")
    for leg in a1.LEGS:
        # A touch sensor sums the contacts of its body inside its site: a little over the foot.
        spec.body(f"{leg}_calf").add_site(
            name=f"{leg}_foot", pos=[0.0, 0.0, -a1.CALF_LENGTH], size=[1.2 * a1.FOOT_RADIUS] * 3
        )
        spec.add_sensor(
            name=f"{leg}_touch",
            type=kinds.mjSENS_TOUCH,
            objtype=mujoco.mjtObj.mjOBJ_SITE,
            objname=f"{leg}_foot",
        )
