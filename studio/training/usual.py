"""Numbers that tell whether somebody gave them: a default that gives way to a stage's own.

They are numbers in every other way; a command line, a file or a program gives plain ones, be they
equal to the default or not.
"""

from typing import Any


class Usual(float):
    """A default of a setting that a stage may have of its own."""


class UsualInt(int):
    """The same of a whole number."""


def given(value: Any) -> bool:
    """Whether a setting was given, be it None: it is no usual value."""
    return not isinstance(value, Usual | UsualInt)
