"""Our own BVH writer: a person who marches, in any convention that files are found in.

It knows where every joint is by a forward kinematics of its own, so that what the reader says can
be held against it. Metres, x forward, y left, z up, until a file's own axes and units are applied.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

Array = np.ndarray
TRUNK = ("hips", "spine", "chest", "neck", "head")
ARM, LEG = ("collar", "shoulder", "elbow", "wrist"), ("hip", "knee", "ankle", "toe")
# role: parent, offset from it in m (a T-pose, facing +x)
BODY: dict[str, tuple[str, tuple[float, float, float]]] = {
    "hips": ("", (0.0, 0.0, 0.0)),
    "spine": ("hips", (0.0, 0.0, 0.12)),
    "chest": ("spine", (0.0, 0.0, 0.18)),
    "neck": ("chest", (0.0, 0.0, 0.22)),
    "head": ("neck", (0.0, 0.0, 0.10)),
}
for _s, _sign in (("l", 1.0), ("r", -1.0)):
    BODY |= {
        f"{_s}_collar": ("chest", (0.0, 0.03 * _sign, 0.17)),
        f"{_s}_shoulder": (f"{_s}_collar", (0.0, 0.15 * _sign, 0.0)),
        f"{_s}_elbow": (f"{_s}_shoulder", (0.0, 0.28 * _sign, 0.0)),
        f"{_s}_wrist": (f"{_s}_elbow", (0.0, 0.25 * _sign, 0.0)),
        f"{_s}_hip": ("hips", (0.0, 0.10 * _sign, -0.02)),
        f"{_s}_knee": (f"{_s}_hip", (0.0, 0.0, -0.43)),
        f"{_s}_ankle": (f"{_s}_knee", (0.0, 0.0, -0.42)),
        f"{_s}_toe": (f"{_s}_ankle", (0.14, 0.0, -0.05)),
    }
ENDS = {"head": (0.0, 0.0, 0.17), "l_wrist": (0.0, 0.1, 0.0), "r_wrist": (0.0, -0.1, 0.0),
        "l_toe": (0.05, 0.0, 0.0), "r_toe": (0.05, 0.0, 0.0)}  # fmt: skip
Y_UP: Array = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]], dtype=float)
"""file vector = Y_UP @ ours: x left, y up, z forward."""


@dataclass(frozen=True, kw_only=True)
class Names:
    """What a convention calls each role: {} is the side; "A>B" is a twist joint B half way on."""

    left: str = "Left"
    right: str = "Right"
    trunk: tuple[str, ...] = ("Hips", "Spine", "Spine1", "Neck", "Head")
    arm: tuple[str, ...] = ("{}Shoulder", "{}Arm", "{}ForeArm", "{}Hand")
    leg: tuple[str, ...] = ("{}UpLeg", "{}Leg", "{}Foot", "{}ToeBase")
    above: str = ""
    """A motionless root above the hips."""

    def of(self, role: str) -> str:
        if role in TRUNK:
            return self.trunk[TRUNK.index(role)]
        side, _, part = role.partition("_")
        word = self.left if side == "l" else self.right
        names = self.arm[ARM.index(part)] if part in ARM else self.leg[LEG.index(part)]
        return names.format(word, word)


_DAZ = ("hip", "abdomenLower", "chestLower", "neckLower", "head")
NAMES = {
    "MotionBuilder": Names(),
    "Bandai Namco": Names(
        left="L", right="R", above="joint_Root", trunk=("Hips", "Spine", "Chest", "Neck", "Head"),
        arm=("Shoulder_{}", "UpperArm_{}", "LowerArm_{}", "Hand_{}"),
        leg=("UpperLeg_{}", "LowerLeg_{}", "Foot_{}", "Toes_{}")),
    "LAFAN1": Names(leg=("{}UpLeg", "{}Leg", "{}Foot", "{}Toe")),
    "Mixamo": Names(
        trunk=tuple(f"mixamorig:{n}" for n in ("Hips", "Spine", "Spine1", "Neck", "Head")),
        arm=tuple(f"mixamorig:{{}}{n}" for n in ("Shoulder", "Arm", "ForeArm", "Hand")),
        leg=tuple(f"mixamorig:{{}}{n}" for n in ("UpLeg", "Leg", "Foot", "ToeBase"))),
    "Mixamo under an armature": Names(
        above="Armature",
        trunk=tuple(f"mixamorig_{n}" for n in ("Hips", "Spine", "Spine1", "Neck", "Head")),
        arm=tuple(f"mixamorig_{{}}{n}" for n in ("Shoulder", "Arm", "ForeArm", "Hand")),
        leg=tuple(f"mixamorig_{{}}{n}" for n in ("UpLeg", "Leg", "Foot", "ToeBase"))),
    "Xsens": Names(
        trunk=("Hips", "Chest", "Chest2", "Neck", "Head"),
        arm=("{}Collar", "{}Shoulder", "{}Elbow", "{}Wrist"),
        leg=("{}Hip", "{}Knee", "{}Ankle", "{}Toe")),
    "Xsens MVN": Names(
        trunk=("Pelvis", "L5", "T12", "Neck", "Head"),
        arm=("{}Shoulder", "{}UpperArm", "{}ForeArm", "{}Hand"),
        leg=("{}UpperLeg", "{}LowerLeg", "{}Foot", "{}Toe")),
    "Rokoko": Names(
        above="Root", trunk=("Hips", "Spine1", "Spine4", "Neck", "Head"),
        leg=("{}Thigh", "{}Shin", "{}Foot", "{}Toe")),
    "OptiTrack": Names(
        left="L", right="R", trunk=("Hip", "Ab", "Chest", "Neck", "Head"),
        arm=("{}Shoulder", "{}UArm", "{}FArm", "{}Hand"),
        leg=("{}Thigh", "{}Shin", "{}Foot", "{}Toe")),
    "Perception Neuron": Names(
        above="Reference", trunk=tuple(f"Robot_{n}" for n in ("Hips", "Spine", "Spine1", "Neck",
                                                              "Head")),
        arm=("Robot_{}Shoulder", "Robot_{}Arm", "Robot_{}ForeArm", "Robot_{}Hand"),
        leg=("Robot_{}UpLeg", "Robot_{}Leg", "Robot_{}Foot", "Robot_{}Toe")),
    "Truebones": Names(
        left="L", right="R",
        trunk=("Bip01", "Bip01_Spine", "Bip01_Spine1", "Bip01_Neck", "Bip01_Head"),
        arm=("Bip01_{}_Clavicle", "Bip01_{}_UpperArm", "Bip01_{}_Forearm", "Bip01_{}_Hand"),
        leg=("Bip01_{}_Thigh", "Bip01_{}_Calf", "Bip01_{}_Foot", "Bip01_{}_Toe0")),
    "100STYLE": Names(
        trunk=("Hips", "Chest", "Chest4", "Neck", "Head"),
        arm=("{}Collar", "{}Shoulder", "{}Elbow", "{}Wrist"),
        leg=("{}Hip", "{}Knee", "{}Ankle", "{}Toe")),
    "MakeHuman": Names(
        left="L", right="R", trunk=("root", "spine05", "spine01", "neck01", "head"),
        arm=("clavicle.{}", "upperarm01.{}>upperarm02.{}", "lowerarm01.{}>lowerarm02.{}",
             "wrist.{}"),
        leg=("upperleg01.{}>upperleg02.{}", "lowerleg01.{}>lowerleg02.{}", "foot.{}",
             "toe1-1.{}")),
    "Daz": Names(
        left="l", right="r", trunk=_DAZ,
        arm=("{}Collar", "{}ShldrBend>{}ShldrTwist", "{}ForearmBend>{}ForearmTwist", "{}Hand"),
        leg=("{}ThighBend>{}ThighTwist", "{}Shin", "{}Foot", "{}Toe")),
    "SOMA": Names(
        trunk=("Hips", "Spine1", "Chest", "Neck1", "Head"),
        leg=("{}Leg", "{}Shin", "{}Foot", "{}ToeBase")),
    "Sintel": Names(
        left="L", right="R", trunk=("Hips", "Spine1", "Spine3", "Neck", "Head"),
        arm=("Clavicle_{}", "UpArm_{}", "LoArm_{}", "Hand_{}"),
        leg=("UpLeg_{}", "LoLeg_{}", "Foot_{}", "Toe_{}")),
    "MMD": Names(
        left="左", right="右", trunk=("センター", "上半身", "上半身2", "首", "頭"),
        arm=("{}肩", "{}腕", "{}ひじ", "{}手首"),
        leg=("{}足", "{}ひざ", "{}足首", "{}つま先")),
    "MMD in English": Names(
        left="L", right="R", trunk=("center", "upper body", "upper body2", "neck", "head"),
        arm=("shoulder_{}", "arm_{}", "elbow_{}", "wrist_{}"),
        leg=("leg_{}", "knee_{}", "ankle_{}", "toe_{}")),
    "CMU": Names(
        arm=("{}Collar", "{}Shoulder", "{}Elbow", "{}Wrist"),
        leg=("{}Hip", "{}Knee", "{}Ankle", "{}Toe")),
    "Acclaim": Names(
        left="l", right="r", trunk=("root", "lowerback", "thorax", "lowerneck", "head"),
        arm=("{}clavicle", "{}humerus", "{}radius", "{}wrist"),
        leg=("{}femur", "{}tibia", "{}foot", "{}toes")),
    "Poser": Names(
        left="l", right="r", trunk=("hip", "abdomen", "chest", "neck", "head"),
        arm=("{}Collar", "{}Shldr", "{}ForeArm", "{}Hand"),
        leg=("{}Thigh", "{}Shin", "{}Foot", "{}Toe")),
    "SMPL": Names(
        left="L", right="R", trunk=("Pelvis", "Spine1", "Spine3", "Neck", "Head"),
        arm=("{}_Collar", "{}_Shoulder", "{}_Elbow", "{}_Wrist"),
        leg=("{}_Hip", "{}_Knee", "{}_Ankle", "{}_Foot")),
    "Unreal": Names(
        left="l", right="r", above="root", trunk=("pelvis", "spine_01", "spine_03", "neck_01",
                                                  "head"),
        arm=("clavicle_{}", "upperarm_{}", "lowerarm_{}", "hand_{}"),
        leg=("thigh_{}", "calf_{}", "foot_{}", "ball_{}")),
    "Rigify": Names(
        left="L", right="R",
        trunk=("DEF-spine", "DEF-spine.001", "DEF-spine.003", "DEF-spine.004", "DEF-head"),
        arm=("DEF-shoulder.{}", "DEF-upper_arm.{}>DEF-upper_arm.{}.001",
             "DEF-forearm.{}>DEF-forearm.{}.001", "DEF-hand.{}"),
        leg=("DEF-thigh.{}>DEF-thigh.{}.001", "DEF-shin.{}>DEF-shin.{}.001", "DEF-foot.{}",
             "DEF-toe.{}")),
    "VRM": Names(
        left="L", right="R", above="Root",
        trunk=("J_Bip_C_Hips", "J_Bip_C_Spine", "J_Bip_C_Chest", "J_Bip_C_Neck", "J_Bip_C_Head"),
        arm=("J_Bip_{}_Shoulder", "J_Bip_{}_UpperArm", "J_Bip_{}_LowerArm", "J_Bip_{}_Hand"),
        leg=("J_Bip_{}_UpperLeg", "J_Bip_{}_LowerLeg", "J_Bip_{}_Foot", "J_Bip_{}_ToeBase")),
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Layout:
    """How a file is written. axes: file vector = axes @ ours. unit: file units in a metre.

    channels: positions on the root or on "all" joints. offsets: "rest", or "zero". added: positions
    of joints are displacements from OFFSET. start: m, where the person begins; travel: m/s forward.
    t_pose_first: a first frame at the origin with the arms out. scales: three channels more.
    """

    names: Names = field(default_factory=Names)
    axes: Array = field(default_factory=Y_UP.copy)
    unit: float = 100.0
    fps: float = 30.0
    seconds: float = 2.0
    channels: str = "root"
    offsets: str = "rest"
    added: bool = False
    start: tuple[float, float, float] = (0.0, 0.0, 0.93)
    travel: float = 0.0
    t_pose_first: bool = False
    scales: bool = False
    end_name: str = "Site"


def march(layout: Layout) -> tuple[Array, dict[str, Array]]:
    """Root positions (T, 3) m and local rotations (T, 3, 3) of the roles that turn."""
    t = np.arange(round(layout.seconds * layout.fps)) / layout.fps
    still = np.zeros_like(t)

    def about(axis: str, angle: Array) -> Array:
        return Rotation.from_euler(axis, np.asarray(angle)[:, None]).as_matrix()

    turns = {"hips": about("z", 0.2 * np.sin(2 * t)), "chest": about("z", 0.1 * np.sin(3 * t))}
    for side, sign in (("l", 1.0), ("r", -1.0)):
        lift = np.maximum(sign * np.sin(2 * np.pi * t), 0.0)
        turns[f"{side}_hip"] = about("y", -1.0 * lift)
        turns[f"{side}_knee"] = about("y", 1.3 * lift)
        down = about("x", still - sign * np.radians(82.0))
        turns[f"{side}_shoulder"] = about("y", 0.3 * (lift - 0.5)) @ down
        turns[f"{side}_elbow"] = about("z", -sign * (0.2 + 0.2 * lift))
    root = np.array(layout.start) + t[:, None] * [layout.travel, 0.0, 0.0]
    if layout.t_pose_first:
        root[0] = [0.0, 0.0, 0.93]
        for turn in turns.values():
            turn[0] = np.eye(3)
    return root, turns


def joints(layout: Layout) -> dict[str, Array]:
    """Where every role is, (T, 3) m each: the truth that a reader has to find."""
    root, turns = march(layout)
    pos, rot = {"hips": root}, {}
    for role, (parent, offset) in BODY.items():
        turn = turns.get(role, np.broadcast_to(np.eye(3), (len(root), 3, 3)))
        rot[role] = rot[parent] @ turn if parent else turn
        if parent:
            pos[role] = pos[parent] + rot[parent] @ np.array(offset)
    pos["head"] = pos["head"] + 0.5 * (rot["head"] @ np.array(ENDS["head"]))
    return pos


def write(layout: Layout) -> str:
    """The text of the file."""
    return "\n".join([*_header(layout), "MOTION", *_motion(layout), ""])


def _children(role: str) -> list[str]:
    return [child for child, (parent, _) in BODY.items() if parent == role]


def _numbers(layout: Layout, v: Array | tuple) -> str:
    return " ".join(f"{x:.6f}" for x in layout.unit * (layout.axes @ np.array(v)))


def _channels(layout: Layout, positions: bool) -> str:
    kinds = (["position"] if positions else []) + ["rotation"] + ["scale"] * layout.scales
    words = [f"{a}{kind}" for kind in kinds for a in ("ZYX" if kind == "rotation" else "XYZ")]
    return f"CHANNELS {len(words)} {' '.join(words)}"


def _joint(layout: Layout, name: str, offset: Array, root: bool, inside: list[str]) -> list[str]:
    written = offset if layout.offsets == "rest" or root else np.zeros(3)
    channels = _channels(layout, root or layout.channels == "all")
    return [f"{'ROOT' if root else 'JOINT'} {name}", "{", f"OFFSET {_numbers(layout, written)}",
            channels, *inside, "}"]  # fmt: skip


def _tree(layout: Layout, role: str, root: bool) -> list[str]:
    name, _, twist = layout.names.of(role).partition(">")
    inside = [line for child in _children(role) for line in _tree(layout, child, False)]
    if role in ENDS:
        inside += [f"End {layout.end_name}", "{", f"OFFSET {_numbers(layout, ENDS[role])}", "}"]
    if twist:  # half of the bone to the child, and the child the other half on
        inside = _joint(layout, twist, np.zeros(3), False, inside)
    return _joint(layout, name, np.array(BODY[role][1]), root, inside)


def _header(layout: Layout) -> list[str]:
    above = layout.names.above
    tree = _tree(layout, "hips", not above)
    return ["HIERARCHY", *(_joint(layout, above, np.zeros(3), True, tree) if above else tree)]


def _motion(layout: Layout) -> list[str]:
    root, turns = march(layout)
    columns: list[Array] = []
    one = np.ones((len(root), 3))

    def add(pos: Array | None, turn: Array | None) -> None:
        if pos is not None:
            columns.append(layout.unit * pos @ layout.axes.T)
        matrix = np.eye(3) if turn is None else layout.axes @ turn @ layout.axes.T
        angles = Rotation.from_matrix(np.broadcast_to(matrix, (len(root), 3, 3)))
        columns.append(angles.as_euler("ZYX", degrees=True))
        columns.extend([one] * layout.scales)

    def visit(role: str) -> None:
        offset = 0.0 if layout.added else np.array(BODY[role][1])
        pos = None
        if role == "hips":
            pos = root if not layout.names.above or layout.channels == "all" else None
        elif layout.channels == "all":
            pos = 0.0 * one + offset
        add(pos, turns.get(role))
        if ">" in layout.names.of(role):
            add(0.0 * one if layout.channels == "all" else None, None)
        for child in _children(role):
            visit(child)

    if layout.names.above:
        add(0.0 * one if layout.channels == "all" else root, None)
    visit("hips")
    rows = [" ".join(f"{v:.6f}" for v in row) for row in np.concatenate(columns, axis=1)]
    return [f"Frames: {len(rows)}", f"Frame Time: {1 / layout.fps:.7f}", *rows]
