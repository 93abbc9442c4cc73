"""How long the sections of one control period took, as a Tick tells it."""

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter


class SectionTimes(dict[str, float]):
    """ms of wall time by section: `with times("mapper"): …` adds one."""

    @contextmanager
    def __call__(self, section: str) -> Iterator[None]:
        start = perf_counter()
        yield
        self[section] = 1e3 * (perf_counter() - start)
