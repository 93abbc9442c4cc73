"""How the loop's thread and others meet: the latest value of something, and a bounded queue."""

import threading
from collections import deque
from typing import Generic, TypeVar

T = TypeVar("T")


class Latest(Generic[T]):
    """Holds the newest value; a slow reader misses values and slows nobody. Any thread."""

    def __init__(self) -> None:
        self._value: T | None = None
        self._version = 0
        self._changed = threading.Condition()

    def publish(self, value: T) -> None:
        """Replace the value and wake whoever waits."""
        with self._changed:
            self._value = value
            self._version += 1
            self._changed.notify_all()

    def get(self) -> T | None:
        """The newest value, or None before the first."""
        return self._value

    @property
    def version(self) -> int:
        """Number of values published so far."""
        return self._version

    def wait(self, after: int, timeout: float | None = None) -> tuple[int, T | None]:
        """(version, value) once version > `after`; the present ones when `timeout` s pass first."""
        with self._changed:
            self._changed.wait_for(lambda: self._version > after, timeout)
            return self._version, self._value


class BoundedQueue(Generic[T]):
    """First in, first out, at most `size` waiting: a full queue refuses. Any thread."""

    def __init__(self, size: int = 256) -> None:
        self._items: deque[T] = deque()
        self._size = size
        self._lock = threading.Lock()

    def put(self, item: T) -> bool:
        """Append; False (and nothing appended) when full."""
        with self._lock:
            if len(self._items) >= self._size:
                return False
            self._items.append(item)
            return True

    def drain(self) -> list[T]:
        """Everything waiting, in order; the queue is then empty. Never waits for an item."""
        with self._lock:
            items = list(self._items)
            self._items.clear()
            return items

    def __len__(self) -> int:
        return len(self._items)
