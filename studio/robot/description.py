"""Unitree's description of the A1, as the registry package `example-robot-data` brings it."""

import sysconfig
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

import yourdfpy

from studio.errors import StudioError


def a1_folder() -> Path:
    """The folder of Unitree's A1 description, wherever `example-robot-data` was installed.

    Raises StudioError where it was not.
    """
    inside = Path("share", "example-robot-data", "robots", "a1_description")
    roots = [Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix"]
    found = find_spec("cmeel")
    if found is not None and found.submodule_search_locations:
        roots.insert(0, Path(found.submodule_search_locations[0]).parent / "cmeel.prefix")
    for root in roots:
        if (root / inside / "urdf" / "a1.urdf").is_file():
            return root / inside
    raise StudioError("the A1's description is missing: pip install 'example-robot-data>=6'")


@lru_cache(maxsize=1)
def load_urdf() -> yourdfpy.Robot:
    """The A1's links and joints as written in its URDF (no meshes loaded)."""
    path = a1_folder() / "urdf" / "a1.urdf"
    urdf = yourdfpy.URDF.load(
        str(path), build_scene_graph=False, load_meshes=False, load_collision_meshes=False
    )
    return urdf.robot
