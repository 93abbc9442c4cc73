"""Options of the commands that other rooms share: spelled out here, below them all, so that
`--help` lists every choice without loading the studio."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

StateOption = Literal["auto", "stand", "walk", "sit"]
Style = Literal["march", "circles", "semantic"]
Travel = Literal["auto", "off"]
ControllerName = Literal["stand_still", "pd_playback", "policy"]


@dataclass(frozen=True, kw_only=True)
class ServeConfig:
    """Open the studio in a browser: prints one URL; opening it is all there is to do."""

    source: str = "operator"
    """operator[:TASK], bvh:FILE, frames:FILE, take:NAME or stream."""
    host: str = "127.0.0.1"
    """Address to listen on; 0.0.0.0 is every network this machine is in (docs/remote.md)."""
    port: int = 8080
    """Port to listen on; 0 takes a free one."""
    sessions: Path = Path("sessions")
    """Folder of recorded takes."""
    token: str | None = None
    """What the URL carries as proof; if left out, one is made and kept in the folder of takes."""
    allow_host: Annotated[tuple[str, ...], tyro.conf.UseAppendAction] = ()
    """Also answer to this name, by which others reach this machine; may be repeated."""
    cert: Path | None = None
    """Certificate (PEM, with its chain): serve https. Needs --key."""
    key: Path | None = None
    """The certificate's private key (PEM)."""
    seed: int = 0
    """Of the synthetic operator."""
    style: Style = "march"
    """Which human motion means walking."""
    controller: ControllerName | None = None
    """What turns the reference into an action (default: policy once trained)."""
