"""Where the folders that travel with the package are: trained models, the page."""

import sysconfig
from pathlib import Path


def package_folder(name: str) -> Path:
    """The folder `name` ("models", "web_assets") of a checkout, else of an installed wheel.

    A wheel puts them under share/a1-studio of the environment (pyproject.toml, data-files). The
    path of an installation is returned even where nothing is there yet.
    """
    beside = Path(__file__).resolve().parents[1]
    if (beside / "pyproject.toml").is_file():
        return beside / name
    return Path(sysconfig.get_path("data")) / "share" / "a1-studio" / name
