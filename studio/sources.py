"""Where human motion comes from: one file per source, one registry (`open_source`)."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from studio.errors import StudioError, unknown_name
from studio.mocap.joint_maps import JointMap, JointMaps
from studio.mocap.source import Source, SourceEnded, TakesNoFrames, poses

__all__ = [
    "FILES",
    "SOURCES",
    "Source",
    "SourceEnded",
    "SourceKind",
    "TakesNoFrames",
    "listed",
    "open_source",
    "poses",
    "refuse_joint_map",
    "spec_of",
    "usages",
]


DEFAULT_SESSIONS = Path("sessions")
"""Where takes are looked for unless told."""


@dataclass(frozen=True, kw_only=True)
class Opening:
    """What a source is opened with: spec as given, its argument (after the colon), and options."""

    spec: str
    argument: str | None
    seed: int
    style: str
    sessions: Path
    joint_map: JointMap | None

    def needed(self) -> str:
        """The argument, or a StudioError saying that one is needed."""
        if not self.argument:
            kind = self.spec.partition(":")[0]
            raise StudioError(f"source {self.spec!r} needs {SOURCES[kind].usage}")
        return self.argument


@dataclass(frozen=True, kw_only=True)
class SourceKind:
    """One entry of the registry. usage: how a spec is written. about: one line for people.

    served: it gives frames only while a studio is served. suffixes: of the files it plays.
    mappable: it may be said which of its joints is which. batch: opening it takes minutes, for
    which nobody at a page waits: not in a studio that is served.
    """

    usage: str
    about: str
    open: Callable[[Opening], Source]
    served: bool = False
    suffixes: tuple[str, ...] = ()
    mappable: bool = False
    batch: bool = False


# Rooms' files are imported when their source is opened: `stream` needs no BVH parser to start.


def _operator(o: Opening) -> Source:
    from studio.synthetic.operator import InteractiveOperator, OperatorSource

    if o.argument == "interactive":  # keys, a gamepad or a script say what is meant
        return InteractiveOperator(seed=o.seed, style=o.style)
    return OperatorSource(o.argument, seed=o.seed, style=o.style)


def _bvh(o: Opening) -> Source:
    from studio.mocap.bvh import read_bvh
    from studio.mocap.clip_source import ClipSource

    recorded = read_bvh(o.needed(), o.joint_map, JointMaps(o.sessions))
    return ClipSource(recorded.clip, o.spec, recorded.report)


def _frames(o: Opening) -> Source:
    from studio.mocap.clip_source import ClipSource
    from studio.mocap.frames import read_frames

    recorded = read_frames(o.needed())
    return ClipSource(recorded.clip, o.spec, recorded.report)


def _video(o: Opening) -> Source:
    from studio.mocap.clip_source import ClipSource
    from studio.mocap.video import read_video

    recorded = read_video(o.needed())
    return ClipSource(recorded.clip, o.spec, recorded.report)


def _take(o: Opening) -> Source:
    from studio.mocap.take_source import TakeSource

    return TakeSource(o.needed(), o.sessions)


def _stream(o: Opening) -> Source:
    from studio.mocap.stream import StreamSource

    return StreamSource(o.spec)


def _headset(o: Opening) -> Source:
    from studio.synthetic.headset import HeadsetSource

    return HeadsetSource(o.spec)


def _vmc(o: Opening) -> Source:
    from studio.mocap.vmc import VmcSource

    return VmcSource(o.spec, o.argument)


SOURCES: dict[str, SourceKind] = {
    "operator": SourceKind(
        usage="operator[:TASK]", about="the built-in synthetic operator", open=_operator
    ),
    "bvh": SourceKind(
        usage="bvh:FILE", about="motion capture in a BVH file", open=_bvh,
        suffixes=(".bvh",), mappable=True,
    ),
    "frames": SourceKind(
        usage="frames:FILE", about="recorded human frames in JSON", open=_frames,
        suffixes=(".jsonl", ".json"),
    ),
    "video": SourceKind(
        usage="video:FILE", about="the person in a video, by the page's model", open=_video,
        batch=True,
    ),
    "take": SourceKind(usage="take:NAME", about="the human side of a recorded take", open=_take),
    "webcam": SourceKind(
        usage="webcam", about="the camera of a page (/camera)", open=_stream, served=True
    ),
    "stream": SourceKind(
        usage="stream", about="frames sent to WS /api/human", open=_stream, served=True
    ),
    "headset": SourceKind(
        usage="headset", about="head and hands by WebXR (/camera)", open=_headset, served=True
    ),
    "vmc": SourceKind(
        usage="vmc[:PORT]", about="an app's VMC over UDP (39539)", open=_vmc, served=True
    ),
}  # fmt: skip
"""Every source by the first word of its spec (docs/contract.md)."""


FILES = {suffix: name for name, kind in SOURCES.items() for suffix in kind.suffixes}
"""Which source plays a file, by its suffix in lower case."""


def spec_of(file: Path) -> str:
    """The spec that plays a file of motion; StudioError for one that no source plays."""
    kind = FILES.get(file.suffix.lower())
    if kind is None:
        raise StudioError(f"{file.name!r} is no file of motion: one ends in {', '.join(FILES)}")
    return f"{kind}:{file}"


def usages(*, served: bool = True) -> list[str]:
    """How each source's spec is written; served: those too that need a studio that is served."""
    return [kind.usage for kind in SOURCES.values() if served or not kind.served]


def listed(*, served: bool = True) -> str:
    """The same with what each is, for `--help`."""
    kinds = [kind for kind in SOURCES.values() if served or not kind.served]
    return "; ".join(f"{kind.usage} ({kind.about})" for kind in kinds)


def refuse_joint_map(spec: str) -> None:
    """StudioError for a source whose joints are known."""
    name = spec.partition(":")[0]
    if name not in SOURCES or not SOURCES[name].mappable:
        does = ", ".join(kind.usage for kind in SOURCES.values() if kind.mappable)
        raise StudioError(f"source {name!r} takes no joint map: its joints are known; {does} does")


def open_source(
    spec: str,
    *,
    seed: int = 0,
    style: str = "march",
    sessions: str | Path | None = None,
    joint_map: JointMap | None = None,
) -> Source:
    """Open the source that `spec` names: NAME or NAME:ARGUMENT, as listed in SOURCES.

    seed, style: of the synthetic operator. sessions: the folder takes are looked for in, and joint
    maps. joint_map: which joint of a BVH is which; remembered for all with the same joint names.
    Raises StudioError for an unknown name (listing the known), a missing or needless argument,
    and whatever the source itself cannot read.
    """
    name, colon, argument = spec.partition(":")
    kind = SOURCES.get(name)
    if kind is None:
        raise unknown_name("source", spec, usages())
    if colon and ":" not in kind.usage:
        raise StudioError(f"source {name!r} takes no argument: write {kind.usage}")
    if joint_map is not None:
        refuse_joint_map(spec)
    return kind.open(
        Opening(
            spec=spec,
            argument=argument or None,
            seed=seed,
            style=style,
            sessions=Path(sessions) if sessions is not None else DEFAULT_SESSIONS,
            joint_map=joint_map,
        )
    )
