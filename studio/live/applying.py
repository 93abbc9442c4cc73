"""What each command does to a session: one function a command, run on the loop's thread."""

from functools import singledispatch
from typing import TYPE_CHECKING, Any

from studio.errors import StudioError, unknown_name
from studio.live import commands as c
from studio.live.mappers import OpenedMapper
from studio.live.opened import DrawnMore, DrawnPlan, OpenedCollect, OpenedReplay, OpenedSource

if TYPE_CHECKING:
    from studio.live.session import Session

Made = dict[str, Any]


@singledispatch
def apply(command: Any, session: "Session", now: float) -> Made:
    """Do what a command asks; StudioError says why not. Returns what it made, if anything.

    now: s on the loop's clock.
    """
    raise StudioError(f"unknown command {type(command).__name__}")


# Who is watched, and what the robot does ---------------------------------------------------------


@apply.register(OpenedSource)
def _(command: OpenedSource, session: "Session", now: float) -> Made:
    session.collector.abort("another source was chosen")
    session.acting.forget()
    session.reading.close()
    session.watch(command, now)
    live = session.source.starts_live
    session.mode, session.idle_by_source = ("live" if live else "idle"), not live
    if not session.safety.stopped:
        session.safety.armed = live
    return {}


@apply.register(c.SetMode)
def _(command: c.SetMode, session: "Session", now: float) -> Made:
    if command.mode not in c.MODES:
        raise unknown_name("mode", command.mode, c.MODES)
    if command.mode == "replay" and session.replay is None:
        raise StudioError("nothing to replay: record a take, or choose the source take:NAME")
    if command.mode != "collect":
        session.leave_collect(now)
    session.mode = command.mode
    session.idle_by_source = False
    if session.mode in ("live", "collect"):
        session.puppeteer.rejoin()
    return {}


@apply.register(c.SetStateLock)
def _(command: c.SetStateLock, session: "Session", now: float) -> Made:
    session.puppeteer.lock_state(command.state)
    return {}


@apply.register(c.SetController)
def _(command: c.SetController, session: "Session", now: float) -> Made:
    session.puppeteer.set_controller(command.name)
    return {}


@apply.register(OpenedMapper)
def _(command: OpenedMapper, session: "Session", now: float) -> Made:
    if command.experts.style != session.puppeteer.config.style:
        if session.recorder.recording is not None and session.mode != "collect":
            raise StudioError(f"take {session.recorder.recording} is being recorded: stop it first")
        session.collector.abort("the style was changed: the take was thrown away")
    session.mappers.swap(command)
    session.puppeteer.set_experts(command.experts)
    session.walk_in(command.experts.style)
    return {"name": command.name or "shipped"}


@apply.register(c.SetGain)
def _(command: c.SetGain, session: "Session", now: float) -> Made:
    session.puppeteer.set_gain(command.name, command.value)
    return {}


@apply.register(c.SetMirror)
def _(command: c.SetMirror, session: "Session", now: float) -> Made:
    session.puppeteer.set_mirror(command.mirror)
    return {}


@apply.register(c.Calibrate)
def _(command: c.Calibrate, session: "Session", now: float) -> Made:
    session.puppeteer.calibrate_now()
    return {}


# Safety ------------------------------------------------------------------------------------------


@apply.register(c.Stop)
def _(command: c.Stop, session: "Session", now: float) -> Made:
    session.safety.stop(f"emergency stop by {command.by}")
    session.collector.abort("stopped: the take was thrown away")
    if session.replay is not None:
        session.replay.playing = False
    return {"stop": session.safety.stops}


@apply.register(c.Reset)
def _(command: c.Reset, session: "Session", now: float) -> Made:
    session.puppeteer.stand_up()
    session.safety.reset()
    return {}


@apply.register(c.Arm)
def _(command: c.Arm, session: "Session", now: float) -> Made:
    why = session.safety.arm(now)
    if why:
        raise StudioError(why)
    if session.mode == "idle" and session.idle_by_source:
        session.mode, session.idle_by_source = "live", False
    session.puppeteer.rejoin()
    return {}


@apply.register(c.Disarm)
def _(command: c.Disarm, session: "Session", now: float) -> Made:
    session.safety.disarm()
    return {}


@apply.register(c.TakeControl)
def _(command: c.TakeControl, session: "Session", now: float) -> Made:
    session.safety.take_control(command.page, now)
    return {}


@apply.register(c.ReleaseControl)
def _(command: c.ReleaseControl, session: "Session", now: float) -> Made:
    session.safety.release_control(command.page)
    return {}


# Takes -------------------------------------------------------------------------------------------


@apply.register(c.StartTake)
def _(command: c.StartTake, session: "Session", now: float) -> Made:
    name = session.recorder.start(command.label, name=command.name, about=session.about())
    session.recorded = 0
    return {"name": name}


@apply.register(c.StopTake)
def _(command: c.StopTake, session: "Session", now: float) -> Made:
    if session.mode == "collect":
        raise StudioError("the take belongs to the plan: abort it, or let it end")
    stopped = session.recorder.stop()
    session.last_take = stopped["name"]
    return stopped


@apply.register(OpenedReplay)
def _(command: OpenedReplay, session: "Session", now: float) -> Made:
    session.replay = command.replay
    return apply(c.SetMode(mode="replay"), session, now)


@apply.register(c.Seek)
def _(command: c.Seek, session: "Session", now: float) -> Made:
    if session.mode != "replay" or session.replay is None:
        raise StudioError("nothing is replayed: choose mode replay first")
    session.replay.seek(command.t, command.playing, command.speed, command.loop)
    return {}


# Collecting --------------------------------------------------------------------------------------


@apply.register(OpenedCollect)
def _(command: OpenedCollect, session: "Session", now: float) -> Made:
    if session.mode == "collect":
        return {}
    if session.recorder.recording is not None:
        raise StudioError(f"take {session.recorder.recording} is being recorded: stop it first")
    if command.operator is not None:
        session.acting.enter(session.source, session.reading.played(now))
        session.watch(command.operator, now)
    return apply(c.SetMode(mode="collect"), session, now)


@apply.register(DrawnPlan)
def _(command: DrawnPlan, session: "Session", now: float) -> Made:
    session.collector.begin(command.plan, command.slots)
    return {}


@apply.register(DrawnMore)
def _(command: DrawnMore, session: "Session", now: float) -> Made:
    session.collector.machine.add(command.slots)
    return {}


@apply.register(c.CollectAction)
def _(command: c.CollectAction, session: "Session", now: float) -> Made:
    if session.mode != "collect":
        raise StudioError("nothing is collected: choose mode collect first")
    return session.collector.act(command.action)
