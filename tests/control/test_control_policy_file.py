"""A policy's two files: whatever is wrong with them is one line with the file's name."""

import json
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

from studio.control.policy import MODELS, Policy
from studio.errors import StudioError

WEIGHTS = MODELS / "stand.safetensors"
NAN = float("nan")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A copy of a policy that works."""
    for suffix in (".safetensors", ".json"):
        source = WEIGHTS.with_suffix(suffix)
        (tmp_path / f"mine{suffix}").write_bytes(source.read_bytes())
    return tmp_path / "mine.safetensors"


def refused(file: Path) -> None:
    with pytest.raises(StudioError, match=r"policy \S*mine\.safetensors cannot be read: .+"):
        Policy.load(file)


def test_the_copy_works(file):
    assert Policy.load(file).manifest["state"] == "stand"


@pytest.mark.parametrize("raw", [b"", b"x" * 1000, b"\xff" * 8, WEIGHTS.read_bytes()[:-9]], ids=len)
def test_weights_that_are_none_are_refused(file, raw):
    file.write_bytes(raw)
    refused(file)


@pytest.mark.parametrize(
    "change",
    [
        lambda t: {"x": t["mean"]},
        lambda t: {k: v for k, v in t.items() if not k.startswith("weight")},
        lambda t: {**t, "bias_0": t["bias_0"] * np.float32(NAN)},
        lambda t: {**t, "std": 0.0 * t["std"]},
        lambda t: {**t, "mean": t["mean"][:5]},
        lambda t: {**t, "bias_0": t["bias_0"][:5]},
        lambda t: {**t, "weight_0": np.zeros((), np.float32)},
    ],
    ids=["others", "no layers", "NaN", "no spread", "another input", "another layer", "a scalar"],
)
def test_weights_that_say_nothing_of_use_are_refused(file, change):
    changed = change(load_file(file))
    save_file(changed, file)
    refused(file)


@pytest.mark.parametrize(
    "raw", [b"", b"{", b"[]", b"null", b"\xff", b"[" * 100_000, b'{"observation": 5}'], ids=len
)
def test_a_sidecar_that_is_none_is_refused(file, raw):
    file.with_suffix(".json").write_bytes(raw)
    refused(file)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("observation", None), ("action", []), ("action", {"charm": 1}), ("level_quat", None),
        ("level_quat", [1, 2]), ("level_quat", [0, 0, 0, 0]), ("neutral_joint_pos", "low"),
        ("neutral_joint_pos", [1e999] * 12), ("neutral_joint_pos", [0.0] * 11),
    ],
)  # fmt: skip
def test_a_sidecar_that_makes_no_target_is_refused(file, key, value):
    manifest = json.loads(file.with_suffix(".json").read_text()) | {key: value}
    file.with_suffix(".json").write_text(json.dumps(manifest))
    refused(file)


def test_a_folder_in_place_of_weights_is_refused(file):
    file.unlink()
    file.mkdir()
    refused(file)
