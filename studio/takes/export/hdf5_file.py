"""A file for HDF5 to write into that never fails it.

On a full disk the library, asked to close what it cannot write, takes the whole process down: a
segmentation fault, the studio with its robot included.
"""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

import h5py


@contextmanager
def hdf5_file(path: Path) -> Iterator[h5py.File]:
    """A new HDF5 file; OSError where it could not be written whole, once it is closed."""
    with path.open("w+b", buffering=0) as raw:
        shelter = _Shelter(raw)  # type: ignore[arg-type]
        try:
            with h5py.File(shelter, "w") as file:
                yield file
        finally:
            if shelter.error is not None:
                raise shelter.error


class _Shelter(io.RawIOBase):
    """A file that keeps what it cannot write: `error` says why; HDF5 reads it back as if it was."""

    def __init__(self, file: BinaryIO) -> None:
        self.error: OSError | None = None
        self._file, self._at, self._end = file, 0, 0
        self._kept: list[tuple[int, bytes]] = []

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._at

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        self._at = offset + {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: self._end}[whence]
        return self._at

    def write(self, data) -> int:  # type: ignore[no-untyped-def, override]
        block, at = bytes(data), self._at
        if self.error is None:
            try:
                self._file.seek(at)
                done = 0
                while done < len(block):
                    done += self._file.write(block[done:])
            except OSError as error:
                self.error = error
        if self.error is not None:
            self._kept.append((at, block))
        self._at = at + len(block)
        self._end = max(self._end, self._at)
        return len(block)

    def readinto(self, buffer) -> int:  # type: ignore[no-untyped-def, override]
        at, size = self._at, max(0, min(len(buffer), self._end - self._at))
        self._file.seek(at)
        found = bytearray(self._file.read(size).ljust(size, b"\0"))
        for start, block in self._kept:
            first, last = max(start, at), min(start + len(block), at + size)
            if first < last:
                found[first - at : last - at] = block[first - start : last - start]
        buffer[:size] = found
        self._at = at + size
        return size

    def truncate(self, size: int | None = None) -> int:
        self._end = self._at if size is None else size
        if self.error is None:
            try:
                self._file.truncate(self._end)
            except OSError as error:
                self.error = error
        return self._end
