"""Weights that are damaged, or answer nonsense, are refused before they drive a robot."""

import shutil

import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

from studio.errors import StudioError
from studio.retarget.store import read_experts, style_dir


def changed(file, **tensors):
    """Write some tensors of a file anew; None takes one out."""
    kept = {**load_file(file), **tensors}
    save_file({name: value for name, value in kept.items() if value is not None}, file)


def nan_like(file, name):
    return np.full_like(load_file(file)[name], np.nan)


DAMAGE = {
    "cut short": ("walk", lambda f: f.write_bytes(f.read_bytes()[:1000])),
    "empty": ("stand", lambda f: f.write_bytes(b"")),
    "something else": ("sit", lambda f: f.write_bytes(b"not weights" * 100)),
    "a tensor missing": ("walk", lambda f: changed(f, mean=None)),
    "another width": ("walk", lambda f: changed(f, mean=np.zeros(7, np.float32))),
    "a layer too narrow": (
        "stand",
        lambda f: changed(f, **{"trunk.1.weight": np.zeros((3, 3), np.float32)}),
    ),
    "weights that are NaN": (
        "walk",
        lambda f: changed(f, **{"trunk.0.weight": nan_like(f, "trunk.0.weight")}),
    ),
    "rates of another number": ("sit", lambda f: changed(f, rate_scale=np.ones(5, np.float32))),
    "prototypes of another width": (
        "selector",
        lambda f: changed(f, points=np.zeros((50, 2), np.float32)),
    ),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_damaged_weights_are_refused_with_their_file(tmp_path, damage):
    folder = tmp_path / "mine"
    shutil.copytree(style_dir("march"), folder)
    read_experts(folder, "march")
    part, spoil = DAMAGE[damage]
    spoil(folder / f"{part}.safetensors")
    with pytest.raises(StudioError, match=rf"mine/{part}\.safetensors cannot be used"):
        read_experts(folder, "march")


@pytest.mark.parametrize(
    "text", ["{", "[1, 2]", '"words"', "", "[" * 100_000 + "]" * 100_000, '{"style": ["march"]}']
)
def test_a_damaged_sidecar_is_refused_with_its_file(tmp_path, text):
    folder = tmp_path / "mine"
    shutil.copytree(style_dir("march"), folder)
    (folder / "walk.json").write_text(text)
    with pytest.raises(StudioError, match=r"mine/walk\.json cannot be used"):
        read_experts(folder, "march")
