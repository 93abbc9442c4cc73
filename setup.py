"""What pyproject.toml cannot say: a wheel carries the trained models and the page."""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

CARRIED = {"models": ("checkpoints", "*.png", "*.md"), "web_assets": ("cache", "screenshots")}
"""Folders beside the sources that go into `studio/`, and what of them stays behind."""


class BuildWithAssets(build_py):
    """Copies CARRIED into a build; an editable install finds them beside the sources."""

    def run(self) -> None:
        super().run()
        if self.editable_mode:
            return
        for name, left_out in CARRIED.items():
            target = Path(self.build_lib) / "studio" / name
            shutil.rmtree(target, ignore_errors=True)
            shutil.copytree(
                Path(__file__).parent / name, target, ignore=shutil.ignore_patterns(*left_out)
            )


setup(cmdclass={"build_py": BuildWithAssets})
