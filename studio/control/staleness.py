"""How old the last human pose may be, and why the robot does not do what the person does.

    older than 100 ms   counted as stale: a march goes on as it went (`studio.rhythm`), any
                        other pose stands in for those that do not come
               500 ms   stand

`live.safety` adds what only a live robot knows of: buttons, pages, an overrun.
"""

from collections.abc import Mapping

from studio.control.drive_command import Directive, DriveCommand, Reason

STALE_AFTER = 0.1
STAND_AFTER = 0.5
"""s."""
NOBODY_YET = "stale: no human pose yet"
EPS = 1e-9
"""s: times are sums of periods."""


def stale_directive(age: float) -> Directive:
    """What a human pose `age` s old calls for (infinite: none was ever seen)."""
    return Directive.STAND if age >= STAND_AFTER - EPS else Directive.FOLLOW


def stale_command(age: float) -> DriveCommand:
    """For a drive without a page or a button: only the person can go missing (`age` s ago)."""
    if age == float("inf"):  # nobody yet is no reason to move
        return DriveCommand(reason="nobody", why=NOBODY_YET)
    directive = stale_directive(age)
    if directive is Directive.FOLLOW:
        return DriveCommand()
    return DriveCommand(directive=directive, reason="stale", why=stale_line(age))


def stale_line(age: float) -> str:
    """The line for a pose that is `age` s old."""
    return f"stale: no human pose for {age:.1f} s"


def why_still(
    age: float, expert: str, votes: Mapping[str, float], lock: str | None
) -> tuple[Reason, str]:
    """Why the robot does not do what the person does though nothing forbids it, or two "".

    age: of the last pose, s. expert, votes (summing to 1): of the selector. lock: a state's name.
    """
    if age == float("inf"):
        return "nobody", "nobody seen: waiting for the first human pose"
    if age >= STAND_AFTER - EPS:
        return "stale", stale_line(age)
    if expert == "unknown" and lock is None:
        line = "this motion is unlike any the experts were trained on; easing to neutral"
        return "unknown", f"unknown: {line}"
    seen = max(votes, key=lambda name: votes[name])
    if lock is not None and seen != lock and votes[seen] > 0.5:
        line = f"locked: the state is held at {lock}, the person's motion says {seen}"
        return "locked", line
    return "", ""
