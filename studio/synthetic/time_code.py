"""A number in a picture that survives JPEG and a camera: which frame of a film it is.

A row of cells at the top left, each as wide as 1/40 of the picture: white, black, twelve bits
(the highest first), a bit that makes the white ones among these thirteen odd, white.
"""

import numpy as np
from numpy.typing import NDArray

BITS = 12
CELLS = BITS + 4
ACROSS = 40
"""Cells that would fill a picture's width."""
_DARK, _LIGHT = 16, 235


def stamp(picture: NDArray[np.uint8], number: int) -> NDArray[np.uint8]:
    """A copy of (height, width, 3) with a number in it, modulo 2 ** BITS."""
    bits = [number >> k & 1 for k in reversed(range(BITS))]
    cells = np.array([1, 0, *bits, 1 - sum(bits) % 2, 1])
    size = picture.shape[1] // ACROSS
    out = picture.copy()
    row = np.where(np.repeat(cells, size), _LIGHT, _DARK).astype(np.uint8)
    out[:size, : CELLS * size] = row[None, :, None]
    return out


def read(picture: NDArray[np.uint8]) -> int | None:
    """The number in (height, width, 3), or None where there is none."""
    size = picture.shape[1] // ACROSS
    row = picture[size // 4 : size - size // 4, : CELLS * size].mean(axis=(0, 2))
    cells = row.reshape(CELLS, size)[:, size // 4 : size - size // 4].mean(axis=1) > 128
    bits = cells[2:-1]
    if not cells[0] or cells[1] or not cells[-1] or bits.sum() % 2 == 0:
        return None
    return int("".join("01"[int(bit)] for bit in bits[:-1]), 2)
