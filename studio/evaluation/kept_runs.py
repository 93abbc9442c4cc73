"""Runs of a long table, over several processes, each kept: one that was cut off goes on."""

import hashlib
import json
import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from itertools import repeat
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from studio.control.policy import MODELS
from studio.files import fingerprint, write_whole

Job = TypeVar("Job")
Run = TypeVar("Run")


def kept_runs(
    run: Callable[[Job], Run],
    kind: type[Run],
    jobs: Sequence[Job],
    files: Sequence[Path | None],
    threads: int = 0,
) -> Iterator[Run]:
    """What `run`, a function of a module, makes of each job, in their order; or what its file says.

    kind: the dataclass that it makes. threads: processes to use; 0: one a core.
    """
    processes = min(threads or os.cpu_count() or 1, len(jobs))
    each = (repeat(run), repeat(kind), jobs, files)
    if processes <= 1:
        yield from map(_kept, *each)
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(processes, mp_context=context) as pool:
        yield from pool.map(_kept, *each)


def file_of(cache: Path | None, name: str, code: Sequence[str], job: Any) -> Path | None:
    """Where a job's run is kept: it changes with the code named, the models and the job (JSON)."""
    if cache is None:
        return None
    models = sorted(MODELS.parent.rglob("*.safetensors")) + sorted(MODELS.parent.rglob("*.json"))
    key = json.dumps([fingerprint(*code, *models), job])
    return cache / f"{name}-{hashlib.sha256(key.encode()).hexdigest()[:16]}.json"


def _kept(run: Callable[[Job], Run], kind: type[Run], job: Job, file: Path | None) -> Run:
    if file is not None and file.exists():
        return msgspec.json.decode(file.read_bytes(), type=kind)
    made = run(job)
    if file is not None:
        write_whole(file, json.dumps(asdict(made)), parents=True)  # type: ignore[call-overload]
    return made
