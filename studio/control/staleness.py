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
EPS = 1e-9
"""s: times are sums of periods."""


def missing(age: float) -> tuple[Reason, str]:
    """Why a human pose `age` s old (infinite: none was ever seen) is not followed, or two ""."""
    if age == float("inf"):
        return "nobody", "nobody seen yet: waiting for the first human pose"
    if age >= STAND_AFTER - EPS:
        return "stale", f"stale: no human pose for {age:.1f} s"
    return "", ""


def stale_command(age: float) -> DriveCommand:
    """For a drive without a page or a button: only the person can go missing (`age` s ago)."""
    reason, why = missing(age)
    # Nobody yet is no reason to move: the robot starts in the first state that is seen.
    directive = Directive.STAND if reason == "stale" else Directive.FOLLOW
    return DriveCommand(directive=directive, reason=reason, why=why)


def why_still(
    age: float, expert: str, votes: Mapping[str, float], lock: str | None
) -> tuple[Reason, str]:
    """Why the robot does not do what the person does though nothing forbids it, or two "".

    age: of the last pose, s. expert, votes (summing to 1): of the selector. lock: a state's name.
    """
    reason, line = missing(age)
    if reason:
        return reason, line
    if expert == "unknown" and lock is None:
        line = "this motion is unlike any the experts were trained on; easing to neutral"
        return "unknown", f"unknown: {line}"
    seen = max(votes, key=lambda name: votes[name])
    if lock is not None and seen != lock and votes[seen] > 0.5:
        line = f"locked: the state is held at {lock}, the person's motion says {seen}"
        return "locked", line
    return "", ""
