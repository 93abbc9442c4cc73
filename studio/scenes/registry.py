"""The scenes by name: one file each here, listed in `options.SCENES`."""

from importlib import import_module

from studio.errors import unknown_name
from studio.options import SCENES
from studio.scenes.scene import Scene

_FILES = {"empty": "free"}


def scene(name: str) -> Scene:
    """The scene of that name. StudioError, naming those that there are, for an unknown one."""
    if name not in SCENES:
        raise unknown_name("scene", name, SCENES)
    return import_module(f"studio.scenes.{_FILES.get(name, name)}").SCENE
