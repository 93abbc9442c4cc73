"""Everything a training run needs to go on as if it had never stopped, in one file without pickle.

Tensors go into a safetensors file; the rest (step counts, curriculum, random state) is JSON in
its header. A checkpoint is written whole or not at all.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file

from studio.errors import StudioError
from studio.files import whole


def save(path: Path, tensors: dict[str, torch.Tensor], facts: dict[str, Any]) -> None:
    """Write tensors of any shape by name and JSON-able facts to `path`. Raises OSError."""
    kept = {k: v.detach().cpu().contiguous().clone() for k, v in tensors.items()}
    with whole(path, parents=True) as scratch:
        save_file(kept, scratch, metadata={"facts": json.dumps(facts)})


def load(path: Path) -> tuple[dict[str, torch.Tensor], dict[str, Any]]:
    """Tensors, in the shapes they were saved in, and facts of `path`.

    Raises StudioError if it is missing or damaged.
    """
    try:
        with safe_open(path, framework="pt") as file:
            facts = json.loads((file.metadata() or {})["facts"])
            return {name: file.get_tensor(name) for name in file.keys()}, facts  # noqa: SIM118
    except FileNotFoundError as error:
        raise StudioError(f"no checkpoint {path}; start without --resume") from error
    except (SafetensorError, KeyError, ValueError) as error:
        raise StudioError(
            f"checkpoint {path} cannot be read ({error}); remove it to start afresh"
        ) from error


def flatten_optimizer(optimizer: torch.optim.Optimizer) -> dict[str, torch.Tensor]:
    """Adam's state by parameter number, each in its shape: optimizer.N.exp_avg and so on."""
    state = optimizer.state_dict()["state"]
    return {
        f"optimizer.{n}.{key}": torch.as_tensor(value)
        for n, entry in state.items()
        for key, value in entry.items()
    }


def restore_optimizer(optimizer: torch.optim.Optimizer, tensors: dict[str, torch.Tensor]) -> None:
    """The reverse of flatten_optimizer, shape by shape; learning rates are left as they are."""
    state: dict[int, dict[str, torch.Tensor]] = {}
    for name, value in tensors.items():
        if name.startswith("optimizer."):
            _, number, key = name.split(".", 2)
            state.setdefault(int(number), {})[key] = value
    whole = optimizer.state_dict()
    whole["state"] = state
    optimizer.load_state_dict(whole)


def random_state(rng: np.random.Generator) -> dict[str, Any]:
    """JSON-able state of a numpy generator."""
    return json.loads(json.dumps(rng.bit_generator.state))
