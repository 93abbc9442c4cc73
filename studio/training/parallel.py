"""Training over several processes or machines, as torchrun starts them: who we are, what is shared.

    torchrun --nproc-per-node 4 -m studio train policy --state walk

Every process has environments of its own, drawn from its own seed; gradients and the observation
normaliser are averaged by rsl-rl, the curriculum's stage is the first process's, and only that one
writes files. Over gloo: the networks are small, and no GPU is needed.
"""

import os
from dataclasses import dataclass

import torch
from torch import distributed

from studio.training.machine import cores

SEED_STEP = 7919
"""Between the seeds of two processes."""


@dataclass(frozen=True, kw_only=True)
class ProcessGroup:
    """rank: this process, from 0. size: how many there are."""

    rank: int = 0
    size: int = 1

    @property
    def is_main(self) -> bool:
        """The one that writes and decides."""
        return self.rank == 0

    @property
    def threads(self) -> int:
        """The cores of this machine that are this process's: torchrun may have started several."""
        return max(1, cores() // int(os.environ.get("LOCAL_WORLD_SIZE", "1")))

    @property
    def settings(self) -> dict[str, int] | None:
        """As rsl-rl reads them; None for a single process."""
        if self.size == 1:
            return None
        return {"global_rank": self.rank, "local_rank": self.rank, "world_size": self.size}

    def broadcast(self, value: float) -> float:
        """The first process's value, in all of them."""
        if self.size == 1:
            return value
        shared = torch.tensor([value], dtype=torch.float64)
        distributed.broadcast(shared, src=0)
        return float(shared[0])

    def average_gradients(self, parameters: list[torch.nn.Parameter]) -> None:
        """Each gradient becomes the mean of all processes'."""
        if self.size == 1:
            return
        grads = [p.grad for p in parameters if p.grad is not None]
        flat = torch.cat([g.reshape(-1) for g in grads])
        distributed.all_reduce(flat)
        flat /= self.size
        for grad, part in zip(grads, flat.split([g.numel() for g in grads]), strict=True):
            grad.copy_(part.view_as(grad))


SINGLE_PROCESS = ProcessGroup()


def join() -> ProcessGroup:
    """The process group torchrun started us in (its RANK and WORLD_SIZE); alone without it."""
    size = int(os.environ.get("WORLD_SIZE", "1"))
    if size == 1:
        return ProcessGroup()
    if not distributed.is_initialized():
        distributed.init_process_group("gloo")
    return ProcessGroup(rank=distributed.get_rank(), size=size)


def leave() -> None:
    """Close what `join` opened."""
    if distributed.is_initialized():
        distributed.destroy_process_group()
