"""What turns a reference into an action, by name: one file each, one line here."""

from collections.abc import Callable

from studio.control.trackers.pd_playback import PdPlayback
from studio.control.trackers.policy import PolicyTracker, trained
from studio.control.trackers.stand_still import StandStill
from studio.control.trackers.tracker import Situation, Tracker
from studio.errors import unknown_name

CONTROLLERS: dict[str, Callable[[], Tracker]] = {
    "stand_still": StandStill,
    "pd_playback": PdPlayback,
    "policy": PolicyTracker,
}


def default_controller() -> str:
    """ "policy" once one is trained for every state, "pd_playback" until then."""
    return "policy" if trained() else "pd_playback"


def open_controller(name: str | None = None) -> Tracker:
    """The controller called `name` (None: the default one).

    StudioError for an unknown name, or for "policy" where no policy is trained.
    """
    name = name or default_controller()
    if name not in CONTROLLERS:
        raise unknown_name("controller", name, CONTROLLERS)
    return CONTROLLERS[name]()


__all__ = ["CONTROLLERS", "Situation", "Tracker", "default_controller", "open_controller"]
