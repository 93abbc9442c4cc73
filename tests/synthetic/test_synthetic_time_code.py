"""The number in a picture survives JPEG, and a picture without one says so."""

import io

import numpy as np
import pytest
from PIL import Image

from studio.synthetic.film import FPS, film
from studio.synthetic.mannequin import mjpeg
from studio.synthetic.time_code import BITS, CELLS, read, stamp

ROOM = np.random.default_rng(3).integers(90, 200, (480, 640, 3)).astype(np.uint8)


@pytest.mark.parametrize("number", [0, 1, 2, 777, 2730, 2**BITS - 1])
@pytest.mark.parametrize("quality", [80, 10])
def test_a_number_is_read_from_a_jpeg_as_it_was_stamped(number, quality):
    (jpeg,) = mjpeg([stamp(ROOM, number)], quality)
    seen = np.asarray(Image.open(io.BytesIO(jpeg)))
    assert read(seen) == number
    half = np.asarray(Image.open(io.BytesIO(jpeg)).resize((320, 240)))
    assert read(half) == number


def test_no_number_is_read_where_none_was_stamped_or_a_cell_is_covered():
    assert read(ROOM) is None
    assert read(np.zeros_like(ROOM)) is None
    assert read(np.full_like(ROOM, 255)) is None
    for cell in range(CELLS):
        spoilt = stamp(ROOM, 1234)
        spoilt[:16, 16 * cell : 16 * (cell + 1)] = 255 - spoilt[:16, 16 * cell : 16 * (cell + 1)]
        assert read(spoilt) is None, cell


def test_only_the_row_of_cells_is_changed_and_of_a_copy():
    before = ROOM.copy()
    stamped = stamp(ROOM, 5)
    assert (before == ROOM).all()
    assert (stamped[16:] == ROOM[16:]).all()
    assert (stamped[:16, 16 * CELLS :] == ROOM[:16, 16 * CELLS :]).all()


def test_the_frames_of_a_film_are_numbered_one_after_the_other(tmp_path):
    video = film(tmp_path / "a.mjpeg", ("quiet", 0.2)).read_bytes()
    starts = [k for k in range(len(video)) if video.startswith(b"\xff\xd8\xff", k)]
    parts = [video[a:b] for a, b in zip(starts, [*starts[1:], None], strict=True)]
    pictures = [np.asarray(Image.open(io.BytesIO(part))) for part in parts]
    assert [read(picture) for picture in pictures] == list(range(round(0.2 * FPS)))
