"""A headset's frames from a page (WebXR) → human poses: the source `headset`.

A frame is what is tracked, in WebXR's axes (x right, y up, z back): {"t": s, "head": [x, y, z, qx,
qy, qz, qw], "left": [x, y, z] or null, "right", "stick": [x, y], "body": places of BODY or null}.
"""

import math
import time
from collections.abc import Callable

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.human.pose import HumanPose
from studio.human.sensor_skeletons import skeleton_of
from studio.human.skeleton import JOINTS
from studio.mocap.gate import MAX_TIME
from studio.mocap.raw_frame import MAX_BYTES, FrameRejected
from studio.mocap.source_report import SourceReport
from studio.mocap.stream import StreamSource
from studio.synthetic.headset_person import UPRIGHT, HeadsetPerson, Worn

Array = NDArray[np.float64]
Place = tuple[float, float, float]

AXES: Array = np.array([[0, 0, -1], [-1, 0, 0], [0, 1, 0]], dtype=float)
"""Ours = AXES @ WebXR's: a person at rest looks along its -z."""
FAR = 1e4
"""m from where the headset counts from."""
_SIDES = ("left", "right")
BODY = skeleton_of(
    "webxr",
    ("head", *(
        f"{side}-{part}"
        for side in _SIDES
        for part in (
            "arm-upper", "arm-lower", "hand-wrist",
            "upper-leg", "lower-leg", "foot-ankle", "foot-ball",
        )
    )),
    AXES,
    {
        "head": ["head"],
        **{
            f"{side[0]}_{joint}": [f"{side}-{part}"]
            for side in _SIDES
            for joint, part in (
                ("shoulder", "arm-upper"), ("elbow", "arm-lower"), ("wrist", "hand-wrist"),
                ("hip", "upper-leg"), ("knee", "lower-leg"), ("ankle", "foot-ankle"),
                ("toe", "foot-ball"),
            )
        },
    },
)  # fmt: skip
"""The joints that a frame's `body` has, as WebXR's Body Tracking module calls them."""


class HeadsetFrame(msgspec.Struct):
    """As it was sent. head: between the eyes, with its rotation. stick: right and back."""

    t: float
    head: tuple[float, float, float, float, float, float, float]
    left: Place | None = None
    right: Place | None = None
    stick: tuple[float, float] = (0.0, 0.0)
    body: list[Place | None] | None = None


_DECODER = msgspec.json.Decoder(HeadsetFrame)


def worn(raw: object) -> Worn:
    """What a frame says, JSON text, bytes or decoded; FrameRejected where it does not fit."""
    if isinstance(raw, (str, bytes)) and len(raw) > MAX_BYTES:
        raise FrameRejected(f"a frame of {len(raw)} bytes; at most {MAX_BYTES} are read")
    try:
        decoded = isinstance(raw, dict)
        frame = msgspec.convert(raw, HeadsetFrame) if decoded else _DECODER.decode(raw)  # type: ignore[arg-type]
    except (msgspec.MsgspecError, ValueError, TypeError, RecursionError) as error:
        why = " ".join(str(error).split())[:160]
        said = '{"t": s, "head": [x, y, z, qx, qy, qz, qw], "left": [x, y, z] …}'
        raise FrameRejected(f"{why}; a headset's frame is {said}") from None
    x, y, z, *turned = frame.head
    places = [(x, y, z), *(p for p in (frame.left, frame.right, *(frame.body or ())) if p)]
    # Comparisons are written so that NaN fails them: a person remembers what they are told.
    if not abs(frame.t) <= MAX_TIME:
        raise FrameRejected(f"t = {frame.t:g} is no time in seconds")
    if not all(abs(v) <= FAR for place in places for v in place):
        raise FrameRejected(f"a place is not finite or beyond {FAR:g} m: places are in metres")
    if not all(abs(v) <= 2.0 for v in frame.stick):
        raise FrameRejected("a stick goes from -1 to 1")
    length = math.sqrt(sum(v * v for v in turned))
    if not 0.5 <= length <= 2.0:
        raise FrameRejected(f"a head's rotation of length {length:.3g}; 1 would fit")
    qx, qy, qz, qw = (v / length for v in turned)
    right, back = (min(max(v, -1.0), 1.0) for v in frame.stick)
    return Worn(
        t=frame.t,
        head_pos=_ours((x, y, z)),
        head_quat=np.concatenate([[qw], _ours((qx, qy, qz))]),
        wrists=(_seen(frame.left), _seen(frame.right)),
        stick=np.array([-back, -right]),
        body=_body(frame.body),
    )


def _ours(place: Place) -> Array:
    return AXES @ np.array(place)


def _seen(place: Place | None) -> Array | None:
    return None if place is None else _ours(place)


def _body(places: list[Place | None] | None) -> tuple[Array, Array] | None:
    """None, too, where the trunk is not tracked: then head and hands say more."""
    if places is None:
        return None
    if len(places) != BODY.num_joints:
        raise FrameRejected(f"a body of {len(places)} joints; {BODY.num_joints} would fit")
    joint_pos, sure = BODY.to_canonical(
        [place or (0.0, 0.0, 0.0) for place in places], [float(p is not None) for p in places]
    )
    trunk = [JOINTS.index(name) for name in ("pelvis", "chest", "head")]
    return (joint_pos, sure) if sure[trunk].all() else None


class HeadsetSource(StreamSource):
    """As `StreamSource`, of frames that say where a head and two hands are."""

    def __init__(
        self, name: str = "headset", *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        super().__init__(name, clock=clock)
        self._person = HeadsetPerson()
        self._tracked: dict[str, tuple[str, ...]] = {}

    def push(self, raw: object) -> None:
        """Take in one frame; raises FrameRejected."""
        try:
            self._admit(lambda given: self._gate.check_made(given, self._made), raw)
        except FrameRejected as error:
            self._refuse(str(error))
            raise

    def new_sender(self) -> None:
        """Somebody puts a headset on: they stand upright, and face ahead."""
        super().new_sender()
        with self._lock:
            self._person.reset()

    def calibration_poses(self) -> list[HumanPose]:
        """Whatever their size they face ahead: their own frame is known, and need not be found."""
        joint_pos_w, confidence = HeadsetPerson().see(UPRIGHT)
        return [HumanPose(t=0.0, joint_pos_w=joint_pos_w, confidence=confidence)]

    def _made(self, raw: object) -> HumanPose:
        seen = worn(raw)
        joint_pos_w, confidence = self._person.see(seen)
        self._tracked = {
            joint: ("body",) if seen.body else ("headset",) if joint == "head" else ("controller",)
            for joint, sure in zip(JOINTS, confidence)
            if sure == 1.0
        }
        return HumanPose(t=seen.t, joint_pos_w=joint_pos_w, confidence=confidence)

    @property
    def report(self) -> SourceReport:
        """Which joints the newest frame tracked; the others are inferred, and so not found."""
        with self._lock:
            found, refused = self._tracked, self._refused
        return SourceReport(
            joints_found=found,
            joints_missing=tuple(joint for joint in JOINTS if joint not in found),
            up_axis="y",
            refused=refused,
            notes=("joints that are not found are inferred from head, hands and stick",),
        )
