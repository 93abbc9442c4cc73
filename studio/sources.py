"""Where human motion comes from: one file per source, one registry (`open_source`)."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from studio.errors import StudioError, unknown_name
from studio.mocap.source import Source, SourceEnded, poses

__all__ = ["SOURCES", "Source", "SourceEnded", "SourceKind", "open_source", "poses"]


DEFAULT_SESSIONS = Path("sessions")
"""Where takes are looked for unless told."""


@dataclass(frozen=True, kw_only=True)
class Opening:
    """What a source is opened with: spec as given, its argument (after the colon), and options."""

    spec: str
    argument: str | None
    seed: int
    style: str
    sessions: Path | None

    def needed(self) -> str:
        """The argument, or a StudioError saying that one is needed."""
        if not self.argument:
            kind = self.spec.partition(":")[0]
            raise StudioError(f"source {self.spec!r} needs {SOURCES[kind].usage}")
        return self.argument


@dataclass(frozen=True, kw_only=True)
class SourceKind:
    """One entry of the registry. usage: how a spec is written. about: one line for people."""

    usage: str
    about: str
    open: Callable[[Opening], Source]


# Rooms' files are imported when their source is opened: `stream` needs no BVH parser to start.


def _operator(o: Opening) -> Source:
    from studio.synthetic.operator import InteractiveOperator, OperatorSource

    if o.argument == "interactive":  # keys, a gamepad or a script say what is meant
        return InteractiveOperator(seed=o.seed, style=o.style)
    return OperatorSource(o.argument, seed=o.seed, style=o.style)


def _bvh(o: Opening) -> Source:
    from studio.mocap.bvh import load_bvh
    from studio.mocap.clip_source import ClipSource

    return ClipSource(load_bvh(o.needed()), o.spec)


def _frames(o: Opening) -> Source:
    from studio.mocap.clip_source import ClipSource
    from studio.mocap.frames import load_frames

    clip, rejected = load_frames(o.needed())
    return ClipSource(clip, o.spec, rejected)


def _take(o: Opening) -> Source:
    from studio.mocap.take import TakeSource

    return TakeSource(o.needed(), o.sessions or DEFAULT_SESSIONS)


def _stream(o: Opening) -> Source:
    from studio.mocap.stream import StreamSource

    return StreamSource(o.spec)


SOURCES: dict[str, SourceKind] = {
    "operator": SourceKind(
        usage="operator[:TASK]", about="the built-in synthetic operator", open=_operator
    ),
    "bvh": SourceKind(usage="bvh:FILE", about="motion capture in a BVH file", open=_bvh),
    "frames": SourceKind(
        usage="frames:FILE", about="recorded human frames, a JSON object a line", open=_frames
    ),
    "take": SourceKind(usage="take:NAME", about="the human side of a recorded take", open=_take),
    "stream": SourceKind(usage="stream", about="frames sent to WS /api/human", open=_stream),
}
"""Every source by the first word of its spec (docs/contract.md)."""


def open_source(
    spec: str, *, seed: int = 0, style: str = "march", sessions: str | Path | None = None
) -> Source:
    """Open the source that `spec` names: NAME or NAME:ARGUMENT, as listed in SOURCES.

    seed, style: of the synthetic operator. sessions: the folder takes are looked for in.
    Raises StudioError for an unknown name (listing the known), a missing or needless argument,
    and whatever the source itself cannot read.
    """
    name, colon, argument = spec.partition(":")
    kind = SOURCES.get(name)
    if kind is None:
        raise unknown_name("source", spec, (k.usage for k in SOURCES.values()))
    if colon and ":" not in kind.usage:
        raise StudioError(f"source {name!r} takes no argument: write {kind.usage}")
    return kind.open(
        Opening(
            spec=spec,
            argument=argument or None,
            seed=seed,
            style=style,
            sessions=Path(sessions) if sessions is not None else None,
        )
    )
