"""Options of the commands that other rooms share: spelled out here, below them all, so that
`--help` lists every choice without loading the studio."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, get_args

import tyro

from studio.timing import PAPER_JOINT_SPEED_DEG

StateName = Literal["stand", "walk", "sit"]
STATES: tuple[StateName, ...] = get_args(StateName)
StateOption = Literal["auto", StateName]
Style = Literal["march", "circles", "semantic"]
STYLES: tuple[Style, ...] = get_args(Style)
"""Which human motion means walking: marching in place, circling hands, or marching in place read by
rule (`retarget.semantic`)."""
SceneName = Literal["empty", "free", "greeting", "hardware", "push", "slalom", "rough", "fetch"]
SCENES: tuple[SceneName, ...] = get_args(SceneName)
"""What the robot is set into (`studio.scenes`); "empty" is what "free" was called first."""
Travel = Literal["auto", "off"]
Steps = Literal["generated", "mapped"]
ControllerName = Literal["stand_still", "pd_playback", "policy"]
EngineName = Literal["mujoco", "pybullet"]


@dataclass(frozen=True, kw_only=True)
class RobotOptions:
    """Which robot is driven."""

    robot: str = "sim"
    """The robot: sim, or udp:HOST:PORT of an `a1-studio robot` (docs/robot-link.md)."""
    robot_level: Literal["references", "targets"] = "references"
    """What is sent to it: references, for policies on its side, or PD targets, over a link without
    delay."""
    robot_secret: Path | None = None
    """File with the secret shared with it; needed beyond this machine."""


@dataclass(frozen=True, kw_only=True)
class ServeConfig(RobotOptions):
    """Open the studio in a browser: prints one URL; opening it is all there is to do."""

    source: str = "operator"
    """Where human motion comes from."""
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
    phone: str | None = None
    """Take a phone's camera: also serve https, to invited phones alone, on this address of this
    machine, or `auto` (docs/remote.md)."""
    phone_port: int = 8443
    """Its port; 0 takes a free one."""
    seed: int = 0
    """Of the synthetic operator."""
    style: Style = "march"
    """Which human motion means walking."""
    mapper: str = "expert"
    """What maps the person, as of `drive`; the page can choose another one. What a rival refuses to
    map stays with the shipped experts."""
    controller: ControllerName | None = None
    """What turns the reference into an action (default: policy once trained)."""
    scene: SceneName = "empty"
    """What stands around the robot, and what there is to do."""
    travel: Travel = "auto"
    """Walk through space beside a person who does (auto), or read marches alone (off)."""
    steps: Steps = "mapped"
    """Walk in the network's own steps (mapped), or in even ones at the speed and turn that it says
    (generated), which do not fall on slopes."""


@dataclass(frozen=True, kw_only=True)
class DriveConfig(RobotOptions):
    """Run the whole flow without a browser, as fast as it goes, and report on it."""

    source: str
    """Where human motion comes from."""
    seconds: float | None = None
    """When to end at the latest (an endless operator: 40 s, a tour of every task)."""
    seed: int = 0
    """Of the synthetic operator and the world."""
    state: StateOption = "auto"
    """Stay in one state, or let the selector decide."""
    style: Style = "march"
    """Which human motion means walking."""
    mapper: str = "expert"
    """What maps the person: expert, one that was trained here, a rival (stand_still, nearest_pair,
    ridge, kim2020, dontcheva2003, yamane2010, seol2013, gmr), fitted at the start, or FILE.py:Class
    of your own (docs/mapper_plugin.py)."""
    controller: ControllerName | None = None
    """What turns the reference into an action (default: policy once trained)."""
    scene: SceneName = "empty"
    """What stands around the robot, and what there is to do."""
    mirror: bool = False
    """Mirror the person."""
    travel: Travel = "auto"
    """Walk through space beside a person who does (auto), or read marches alone (off)."""
    steps: Steps = "mapped"
    """Walk in the steps that the network says, joint by joint, as in the paper (mapped), or at the
    speed and turn that it says in the gait generator's own (generated)."""
    max_joint_speed: float = PAPER_JOINT_SPEED_DEG
    """Degrees a second that a standing or sitting reference's joints may reach, 60 to 480: the
    paper's 120 is late and steady (`evaluate response`); on a slope it is never more than that."""
    sessions: Path = Path("sessions")
    """Folder of recorded takes."""
    record: bool = False
    """Keep the drive as a take."""
    trace: Path | None = None
    """Write a JSON line per tick to this file."""
    realtime: bool = False
    """Pace it at 30 Hz."""
    joint_map: Path | None = None
    """JSON that says which joint of a BVH is which, {"l_hip": "NAME", …}: remembered for others
    with the same joint names."""


@dataclass(frozen=True, kw_only=True)
class RobotConfig:
    """Be a robot: a simulated A1 behind the robot's side of the link, until Ctrl C."""

    engine: EngineName = "mujoco"
    """Which physics; pybullet has an A1 of its own (pip install 'a1-studio[pybullet]')."""
    host: str = "127.0.0.1"
    """Address to listen on; beyond this machine only with --secret."""
    port: int = 8090
    """UDP port to listen on; 0 takes a free one."""
    rate: int = 240
    """Steps a second, 240 to 500; mujoco takes multiples of 30."""
    secret: Path | None = None
    """File with the secret shared with whoever drives, 16 bytes or more."""


@dataclass(frozen=True, kw_only=True)
class BenchConfig:
    """Measure the control period, the drive and the page on this machine."""

    compare: Path | None = None
    """An earlier --json to compare with."""
    seconds: float = 20.0
    """How long each part is measured."""
    page: bool = True
    """Also start a server, connect four clients and measure the loop's periods."""
    browser: bool = True
    """Also measure them beside a Chromium that draws the page, and the page itself (needs one)."""
    floods: bool = True
    """Also measure how soon a stop is answered while clients flood the server."""
    training: bool = True
    """Also measure physics, environment and PPO as environments grow."""
    takes: bool = True
    """Also measure what takes cost as there are more of them and longer ones."""
