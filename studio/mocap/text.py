"""A text file from anywhere → numbered lines of words: any usual encoding, decimal commas."""

import codecs
import io
import math
from collections import deque
from collections.abc import Iterator
from pathlib import Path

from studio.errors import StudioError
from studio.files import BUFFER, open_regular

MAX_LINE = 200_000
"""Characters in a line; no honest frame is longer."""
MAX_FRAMES = 1_000_000
"""In a file: nine hours at 30 Hz."""
_MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"),
          (codecs.BOM_UTF16_BE, "utf-16"))  # fmt: skip
_NAMING = ("root", "joint", "end")
"""First words of lines whose other words are names, not numbers."""


class Lines:
    """A text file as lines of words that know their number; `error` names the line."""

    def __init__(self, file: io.TextIOBase, name: str) -> None:
        self._file, self.name, self.number = file, name, 0
        self._words: deque[str] = deque()

    def error(self, what: str) -> StudioError:
        """The complaint about the line read last."""
        return StudioError(f"{self.name}, line {self.number}: {what}")

    def rows(self) -> Iterator[list[str]]:
        """The words of each line left that is not blank; a brace is always a word of its own.

        Raises StudioError for a line longer than MAX_LINE.
        """
        while text := self._file.readline(MAX_LINE + 1):
            self.number += 1
            if len(text) > MAX_LINE:
                raise self.error(f"longer than {MAX_LINE} characters: this is no BVH file")
            if "{" in text or "}" in text:
                text = text.replace("{", " { ").replace("}", " } ")
            words = text.split()
            if "," in text and words[0].lower() not in _NAMING:
                words = _without_commas(text).split()
            if words:
                yield words

    def word(self) -> str:
        """The next word, on this line or a later one. StudioError at the end of the file."""
        if not self._words:
            self._words.extend(next(self.rows(), []))
        if not self._words:
            raise self.error("the file ends here, inside its header")
        return self._words.popleft()

    def name_until_brace(self) -> str:
        """What is left of this line, up to a brace, as one name (some names hold blanks)."""
        name = []
        while self._words and self._words[0] != "{":
            name.append(self._words.popleft())
        return " ".join(name)

    def finite(self, word: str) -> float:
        """The number in a word, in its own unit. StudioError if there is none, or none finite."""
        try:
            value = float(word)
        except ValueError:
            raise self.error(f"{word[:40]!r} is no number") from None
        if not math.isfinite(value):
            raise self.error(f"{word[:40]!r} is not finite")
        return value


def open_text(path: Path, max_bytes: int) -> io.TextIOWrapper:
    """A regular file as text, in the encoding its beginning shows; see `open_regular`."""
    file = open_regular(path, max_bytes)
    encoding = encoding_of(file.peek(BUFFER))  # type: ignore[attr-defined]
    return io.TextIOWrapper(file, encoding=encoding, errors="replace", newline=None)


def encoding_of(start: bytes) -> str:
    """By its mark, by the zeros of UTF-16, else the first that can be: UTF-8, Shift JIS (names of
    MikuMikuDance), Latin-1."""
    for mark, encoding in _MARKS:
        if start.startswith(mark):
            return encoding
    if len(start) >= 4 and start[0] and start[2] and not (start[1] or start[3]):
        return "utf-16-le"
    if len(start) >= 4 and start[1] and start[3] and not (start[0] or start[2]):
        return "utf-16-be"
    for encoding in ("utf-8", "cp932"):
        try:
            codecs.getincrementaldecoder(encoding)().decode(start)
        except UnicodeDecodeError:
            continue
        return encoding
    return "latin-1"


def _without_commas(text: str) -> str:
    """Numbers with decimal commas, or with commas between them, as everybody's."""
    between = "." in text or any(w.endswith(",") or w.count(",") > 1 for w in text.split())
    return text.replace(",", " " if between else ".")
