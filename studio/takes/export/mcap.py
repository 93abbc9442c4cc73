"""A take to one MCAP file that viewers show as three figures: our streams, and Foxglove's beside.

/human /reference /robot /tick are the tape's own (JSON), as recorded, on one clock. /tf has each
link's place (foxglove.FrameTransforms), /scene the figures as lines (SceneUpdate: Foxglove),
/points/* the same as dots (PointCloud: rerun draws no SceneUpdate). A tape itself holds no figures:
they follow from it, and would double it.
"""

from pathlib import Path

import numpy as np
from mcap.writer import CompressionType, Writer
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.skeleton import NUM_JOINTS, PARENTS
from studio.robot import a1
from studio.robot.legs import foot_pos_w, link_frames_w
from studio.takes.export import foxglove
from studio.takes.export.episodes import nothing_left
from studio.takes.export.extent import tick_range
from studio.takes.record import codec
from studio.takes.record.tape import LIBRARY
from studio.takes.take import Take

Array = NDArray[np.float64]

FIGURES = {
    "person": (1.5, (1.0, 0.71, 0.33)),
    "reference": (0.0, (0.35, 0.66, 1.0)),
    "robot": (-1.0, (0.48, 0.85, 0.56)),
}
"""Frame of each figure: m to the left of the world's origin, so that they stand side by side, and
its colour."""
BONE_ENDS = [[p, i] for i, p in enumerate(PARENTS) if p >= 0]
ROBOT_LINES = [[1, 4], [4, 10], [10, 7], [7, 1]] + [
    pair
    for leg in range(4)
    for pair in ([3 * leg + 1, 3 * leg + 2], [3 * leg + 2, 3 * leg + 3], [3 * leg + 3, 13 + leg])
]
"""The trunk's outline and the legs: pairs of what `robot_points` gives."""
_DOTS = 6
"""Points on each bone."""


def robot_points(base_pos: Array, base_quat: Array, joint_pos: Array) -> Array:
    """Points (N, 17, 3) m in the world: trunk, hip, thigh and calf frame of FR FL RR RL, four feet.

    base (N, 3), (N, 4) in the world, joints (N, 12) rad.
    """
    links, _ = link_frames_w(base_pos, base_quat, joint_pos)
    return np.concatenate([links, foot_pos_w(base_pos, base_quat, joint_pos)], axis=-2)


def write_mcap(take: Take, path: Path) -> None:
    """What the trim leaves, at the tape's own times; StudioError when that is nothing."""
    start, end = tick_range(take)
    if start >= end:
        raise StudioError(nothing_left(take))
    begun = max(0, int(take.meta.get("started_ns") or 0))
    shown = _Figures(take)
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start(profile="", library=LIBRARY)
        channels = _channels(writer)
        for n in range(start, end):
            time = begun + round(n * 1e9 / a1.CONTROL_HZ)
            rows = _streams(take, n) | shown.at(n, time)
            for topic, data in rows.items():
                writer.add_message(channels[topic], time, data, time, n - start)
        writer.finish()


def _channels(writer: Writer) -> dict[str, int]:
    out = {}
    for name, schema in codec.SCHEMAS.items():
        number = writer.register_schema(f"studio.{name}", "jsonschema", schema)
        out[f"/{name}"] = writer.register_channel(f"/{name}", "json", number)
    shown = {"/tf": "FrameTransforms", "/scene": "SceneUpdate"}
    shown |= {f"/points/{figure}": "PointCloud" for figure in FIGURES}
    for topic, name in shown.items():
        number = writer.register_schema(f"foxglove.{name}", "protobuf", foxglove.SCHEMA)
        out[topic] = writer.register_channel(topic, "protobuf", number)
    return out


def _streams(take: Take, n: int) -> dict[str, bytes]:
    """The tape's own messages of a tick; the person only when somebody new was seen."""
    tick = take.ticks[n]
    i = int(take.arrays.human_index[n])
    new = i >= 0 and bool(take.human_tick[i] == n)
    return {f"/{stream}": data for stream, data in codec.messages(tick, person=new).items()}


class _Figures:
    """Foxglove's messages of a tick."""

    def __init__(self, take: Take) -> None:
        self._take = take
        self._links, self._points = {}, {}
        for who, group in (("reference", take.arrays.reference), ("robot", take.arrays.robot)):
            pose = [group[key] for key in ("base_pos", "base_quat", "joint_pos")]
            self._links[who] = link_frames_w(*pose)
            self._points[who] = robot_points(*pose)

    def at(self, n: int, time: int) -> dict[str, bytes]:
        tick = self._take.ticks[n]
        frames, scene = foxglove.message("FrameTransforms")(), foxglove.message("SceneUpdate")()
        out = {}
        for who, (left, color) in FIGURES.items():
            _transform(frames, time, "world", who, (0.0, left, 0.0), (1.0, 0.0, 0.0, 0.0))
            if who != "person":
                pos, quat = (x[n] for x in self._links[who])
                for link, p, q in zip(a1.LINKS, pos.tolist(), quat.tolist(), strict=True):
                    _transform(frames, time, who, f"{who}/{link}", p, q)
                points, bones = self._points[who][n], ROBOT_LINES
            elif tick.human is not None:
                points, bones = tick.human.joint_pos_w, BONE_ENDS
            else:
                continue
            _lines(scene, time, who, points, bones, color)
            out[f"/points/{who}"] = _dots(time, who, points, bones)
        return out | {"/tf": frames.SerializeToString(), "/scene": scene.SerializeToString()}


def _transform(frames, time: int, parent: str, child: str, pos, quat) -> None:
    one = frames.transforms.add(parent_frame_id=parent, child_frame_id=child)
    one.timestamp.FromNanoseconds(time)
    one.translation.x, one.translation.y, one.translation.z = pos
    one.rotation.w, one.rotation.x, one.rotation.y, one.rotation.z = quat


def _lines(scene, time: int, who: str, points: Array, bones, color) -> None:
    entity = scene.entities.add(frame_id=who, id=who)
    entity.timestamp.FromNanoseconds(time)
    lines = entity.lines.add(type=foxglove.LINE_LIST, thickness=0.03)
    lines.pose.orientation.w = 1.0
    for x, y, z in np.round(points, codec.DECIMALS).tolist():
        lines.points.add(x=x, y=y, z=z)
    lines.indices.extend(i for bone in bones for i in bone)
    lines.color.r, lines.color.g, lines.color.b = color
    lines.color.a = 1.0


def _dots(time: int, who: str, points: Array, bones) -> bytes:
    a, b = points[[bone[0] for bone in bones]], points[[bone[1] for bone in bones]]
    share = np.linspace(0.0, 1.0, _DOTS)[:, None, None]
    dots = ((1.0 - share) * a + share * b).reshape(-1, 3).astype("<f4")
    cloud = foxglove.message("PointCloud")(frame_id=who, point_stride=12, data=dots.tobytes())
    cloud.timestamp.FromNanoseconds(time)
    cloud.pose.orientation.w = 1.0
    for i, axis in enumerate("xyz"):
        cloud.fields.add(name=axis, offset=4 * i, type=foxglove.FLOAT32)
    return cloud.SerializeToString()


assert len(BONE_ENDS) + 1 == NUM_JOINTS, "every joint but the root hangs on one bone"
