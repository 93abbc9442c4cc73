"""What every command shares: an object out as JSON, usage told, an option taken out."""

import json
import math
import sys
from pathlib import Path
from typing import Any, NoReturn

from studio.errors import StudioError

Answer = dict[str, Any]


def usage(text: str, status: int) -> NoReturn:
    """Say how it is used and end: status 0 where that was asked for, 2 for bad usage."""
    print(text, file=sys.stdout if status == 0 else sys.stderr)
    raise SystemExit(status)


def take_option(argv: list[str], option: str) -> tuple[list[str], str | None]:
    """The arguments without `option VALUE`, and VALUE: --json works the same everywhere."""
    for i, arg in enumerate(argv):
        if arg == option:
            if i + 1 == len(argv):
                usage(f"{option} needs a value", 2)
            return argv[:i] + argv[i + 2 :], argv[i + 1]
        if arg.startswith(f"{option}="):
            return argv[:i] + argv[i + 1 :], arg.partition("=")[2]
    return argv, None


def give(answer: Any, destination: str | None) -> None:
    """The object to its file, or to the terminal. StudioError if the file cannot be written."""
    if answer is None:
        return
    text = json.dumps(strict(answer), indent=1, default=float, allow_nan=False)
    if destination == "-" or destination is None:
        print(text)
        return
    try:
        path = Path(destination)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text + "\n", encoding="utf-8")
    except OSError as error:
        raise StudioError(f"cannot write {destination}: {error.strerror}") from error


def strict(value: Any) -> Any:
    """The same with null for what JSON has no word for: NaN and the infinities."""
    if hasattr(value, "tolist"):  # numpy
        value = value.tolist()
    if isinstance(value, dict):
        return {key: strict(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [strict(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
