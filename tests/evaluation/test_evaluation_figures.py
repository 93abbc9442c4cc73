"""Strips of person, reference and robot: pictures of what was driven, rows that say how near."""

from pathlib import Path

import numpy as np
import pytest

from studio.errors import StudioError
from studio.evaluation.figures import Options, _projected, run_figures


@pytest.mark.slow
def test_a_strip_is_of_a_task_that_the_robot_does(tmp_path: Path) -> None:
    from matplotlib import image

    options = Options(tasks=("sit_tilt",), seconds=1.0, out=tmp_path)
    (row,) = run_figures(options)["rows"]
    assert (row["case"], row["state"], row["survived"]) == ("sit_tilt", "sit", True)
    assert 0.0 < row["joint_rmse_deg"] < 8.0
    picture = image.imread(tmp_path / row["picture"])[..., :3]
    rows = np.array_split(picture, 3)
    blue = [((part[..., 2] - part[..., 0]) > 0.3).mean() for part in rows]
    orange = [((part[..., 0] - part[..., 2]) > 0.3).mean() for part in rows]
    dark = [(part.max(axis=2) < 0.3).mean() for part in rows]
    assert np.argmax(orange) == 0  # the person
    assert np.argmax(blue) == 1  # what the robot should do
    assert np.argmax(dark) == 2  # the simulated robot, in its own colours
    assert min(orange[0], blue[1], dark[2]) > 0.003


def test_what_is_nearer_is_drawn_over_what_is_behind_it() -> None:
    xy, near = _projected(np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
    assert near[0] > near[1]
    assert xy[2, 1] == pytest.approx(np.cos(0.25))


def test_a_task_that_is_not_in_the_library_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StudioError, match="unknown task"):
        run_figures(Options(tasks=("juggle",), out=tmp_path))
