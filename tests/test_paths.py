"""What a wheel carries besides code: the trained models and the page, and where they are found."""

import sysconfig
import tomllib
from pathlib import Path

from studio import paths as room
from studio.paths import package_folder

ROOT = Path(__file__).resolve().parents[1]
STAYS = {
    "models/policy/checkpoints",
    "models/policy/teachers",
    "models/mapper",
    "models",
    "models/report",
    "web_assets/screenshots",
    "web_assets/tests",
    "web_assets/types",
}


def listed() -> set[str]:
    """Files that the data-files of pyproject.toml put into a wheel, from the checkout's root."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    folders = project["tool"]["setuptools"]["data-files"]
    out = set()
    for target, patterns in folders.items():
        for pattern in patterns:
            for path in ROOT.glob(pattern):
                assert path.is_file(), f"{pattern} takes the folder {path.name} along"
                name = path.relative_to(ROOT).as_posix()
                assert f"share/a1-studio/{name}" == f"{target}/{path.name}"
                out.add(name)
    return out


def test_a_wheel_carries_every_model_and_all_of_the_page_and_no_checkpoint():
    kept = {
        path.relative_to(ROOT).as_posix()
        for folder in ("models", "web_assets")
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and "cache" not in path.parts and "node_modules" not in path.parts
        if path.parent.relative_to(ROOT).as_posix() not in STAYS
        if "__pycache__" not in path.parts
        if path.parent != ROOT / "web_assets" or path.suffix == ".html"  # others check the page
    }
    assert listed() == kept


def test_a_checkout_is_used_where_it_lies_and_an_installation_from_the_environment(
    monkeypatch, tmp_path
):
    assert package_folder("models") == ROOT / "models"
    monkeypatch.setattr(room, "__file__", str(tmp_path / "site-packages" / "studio" / "x.py"))
    data = Path(sysconfig.get_path("data"))
    assert package_folder("web_assets") == data / "share" / "a1-studio" / "web_assets"
