"""Where networks learn: the devices of this machine, by torch's names, and its threads."""

import contextlib
from collections.abc import Iterator

import torch

from studio.errors import StudioError


def devices() -> list[str]:
    """ "cpu", then the accelerator that torch finds here: as a whole, and one by one."""
    found = ["cpu"]
    accelerator = torch.accelerator.current_accelerator(check_available=True)
    if accelerator is not None:
        kind = accelerator.type
        found += [kind, *(f"{kind}:{i}" for i in range(torch.accelerator.device_count()))]
    return found


def check_device(name: str) -> None:
    """StudioError for a device that this machine, or this build of torch, does not have."""
    if name != "cpu" and name not in devices():
        raise StudioError(
            f"no device {name!r} here; this machine and its build of torch have: "
            f"{', '.join(devices())}"
        )


def random_states(device: str) -> dict[str, torch.Tensor]:
    """torch's RNG states, bytes (B,), by name: of the processor, and of the device that acts."""
    states = {"torch_random_state": torch.get_rng_state()}
    if device != "cpu":
        with torch.accelerator.device_index(torch.device(device).index):
            states["device_random_state"] = torch.get_device_module(device).get_rng_state()
    return states


def restore_random_states(device: str, states: dict[str, torch.Tensor]) -> None:
    """The reverse of `random_states`; a device whose RNG state was not saved keeps its own."""
    torch.set_rng_state(states["torch_random_state"])
    if device != "cpu" and "device_random_state" in states:
        with torch.accelerator.device_index(torch.device(device).index):
            torch.get_device_module(device).set_rng_state(states["device_random_state"])


@contextlib.contextmanager
def threads(count: int) -> Iterator[None]:
    """torch on so many threads of the processor; afterwards as before."""
    before = torch.get_num_threads()
    torch.set_num_threads(count)
    try:
        yield
    finally:
        torch.set_num_threads(before)
