"""An app that moves a virtual character, and sends it by VMC over a real UDP socket."""

import socket
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message_builder import OscMessageBuilder

from studio.geometry import quat_conj, quat_mul, quat_rotate
from studio.human.skeleton import INDEX
from studio.mocap.vmc_avatar import PARENTS

Array = NDArray[np.float64]
_LIMBS = {"UpperArm": "shoulder", "LowerArm": "elbow", "Hand": "wrist", "UpperLeg": "hip",
          "LowerLeg": "knee", "Foot": "ankle", "Toes": "toe"}  # fmt: skip
JOINT = {"Hips": "pelvis", "Spine": "spine", "Chest": "chest", "UpperChest": "chest",
         "Neck": "neck", "Head": "head"}  # fmt: skip
for _side in ("Left", "Right"):
    JOINT |= {f"{_side}Shoulder": "chest"}
    JOINT |= {f"{_side}{bone}": f"{_side[0].lower()}_{joint}" for bone, joint in _LIMBS.items()}
"""Where each bone begins, as a canonical joint."""
LIMB_JOINTS = [INDEX[JOINT[bone]] for bone in JOINT if bone.endswith(("Head", *_LIMBS))]
"""What an avatar gives as it is; the trunk follows from hips and shoulders."""
MINIMAL = tuple(b for b in PARENTS if not b.endswith(("Chest", "Neck", "Shoulder", "Toes")))
"""The bones that no humanoid lacks."""
NOBODY = np.array([1.0, 0.0, 0.0, 0.0])


def bones_of(
    joint_pos_w: Array, bones: Iterable[str] = tuple(PARENTS), seed: int | None = None
) -> dict[str, list[float]]:
    """Each bone's position and quaternion (x y z w) against its parent, Unity's axes, of an avatar
    whose joints are there; each bone turned at random, or not at all (seed None)."""
    rng = np.random.default_rng(seed)
    bones = tuple(bones)
    world: dict[str, tuple[Array, Array]] = {"": (np.zeros(3), NOBODY)}
    out = {}
    for bone in bones:
        parent = PARENTS[bone]
        while parent not in world:
            parent = PARENTS[parent]
        x, y, z = joint_pos_w[INDEX[JOINT[bone]]]
        place, turn = np.array([-y, z, x]), NOBODY
        if seed is not None:
            turn = rng.normal(size=4)
            turn /= np.linalg.norm(turn)
        back = quat_conj(world[parent][1])
        offset, (qw, *qv) = quat_rotate(back, place - world[parent][0]), quat_mul(back, turn)
        world[bone] = place, turn
        out[bone] = [*offset.tolist(), *(float(q) for q in qv), float(qw)]
    return out


def message(address: str, *arguments: str | float) -> bytes:
    """One OSC message, numbers as 32 bit floats."""
    return _built(address, *arguments).dgram


def _built(address: str, *arguments: str | float):
    builder = OscMessageBuilder(address)
    for argument in arguments:
        builder.add_arg(argument, "s" if isinstance(argument, str) else "f")
    return builder.build()


def bundle(*messages: tuple[str | float, ...]) -> bytes:
    """Messages (address, *arguments) in one OSC bundle."""
    builder = OscBundleBuilder(IMMEDIATELY)
    for address, *arguments in messages:
        builder.add_content(_built(str(address), *arguments))
    return builder.build().dgram


def packets(t: float, bones: dict[str, list[float]], size: int = 60) -> list[bytes]:
    """A frame as bundles of at most `size` bones; the last ends it."""
    rows = [("/VMC/Ext/Bone/Pos", name, *numbers) for name, numbers in bones.items()]
    cut = [rows[k : k + size] for k in range(0, len(rows), size)]
    return [*(bundle(*some) for some in cut), bundle(("/VMC/Ext/OK", 1.0), ("/VMC/Ext/T", t))]


class Sender:
    """A socket of its own that sends to a port of this machine."""

    def __init__(self, port: int) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect(("127.0.0.1", port))

    def send(self, *given: bytes) -> None:
        """Each as a packet."""
        for packet in given:
            self._socket.send(packet)

    def close(self) -> None:
        """Leave."""
        self._socket.close()
