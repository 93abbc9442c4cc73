"""What a wheel carries: the trained models and the page, where the package looks for them."""

import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def test_a_build_carries_models_and_page_inside_the_package(tmp_path, monkeypatch):
    setuptools = pytest.importorskip("setuptools", reason="wheels are built with setuptools")
    monkeypatch.setattr(setuptools, "setup", lambda **_: None)
    monkeypatch.chdir(ROOT)
    build_type = runpy.run_path(str(ROOT / "setup.py"))["BuildWithAssets"]
    distribution = setuptools.Distribution({"packages": ["studio"]})
    distribution.script_name = "setup.py"
    build = build_type(distribution)
    build.build_lib = str(tmp_path)
    build.ensure_finalized()
    build.run()
    carried = {str(p.relative_to(tmp_path / "studio")) for p in tmp_path.rglob("*") if p.is_file()}
    assert {"__init__.py", "web_assets/index.html", "web_assets/js/app.js"} <= carried
    for state in ("stand", "walk", "sit"):
        assert f"models/mapper/march/{state}.safetensors" in carried
        assert f"models/policy/{state}.safetensors" in carried
    assert not [name for name in carried if "checkpoints" in name or "web_assets/cache" in name]
