"""What every room's tests share: where real motion clips are looked for, a quiet environment."""

import os
from pathlib import Path

import pytest

# One BLAS thread, as in the live loop: tests measure what is shipped.
os.environ.setdefault("OMP_NUM_THREADS", "1")

REPO = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def clips() -> Path:
    """The folder of real human motion; tests that want it skip, saying so, where it is absent."""
    for folder in (os.environ.get("A1_STUDIO_CLIPS"), REPO.parent / "shared" / "clips"):
        if folder and Path(folder).is_dir():
            return Path(folder)
    pytest.skip("no real clips: set $A1_STUDIO_CLIPS to a folder of them")
