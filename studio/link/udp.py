"""A robot by UDP: `udp:HOST:PORT`. Nothing in it ever waits but the first look."""

import socket
import time
from contextlib import suppress
from pathlib import Path

from studio.errors import StudioError
from studio.files import open_regular
from studio.link import wire
from studio.link.link import Level, RobotLink
from studio.link.remote import RemoteLink

FIRST_STATE = 3.0
"""s to wait for a robot's first state."""
AT_ONCE = 512
"""Datagrams that are read in a row: a second of a fast robot."""
LOOPBACK = frozenset({"127.0.0.1", "localhost"})
SHORTEST_SECRET = 16
"""Bytes."""


class UdpLink(RemoteLink):
    """One thread."""

    def __init__(self, host: str, port: int, level: Level, secret: bytes = b"") -> None:
        """Waits for the robot's first state. StudioError where none comes."""
        super().__init__(f"udp:{host}:{port}", level, secret)
        checked_exposure(host, secret)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.setblocking(False)
            self._socket.connect((host, port))
            self._first_state()
        except (OSError, StudioError) as error:
            self._socket.close()
            if isinstance(error, StudioError):
                raise
            raise StudioError(f"{self.name} cannot be reached: {error}") from error

    def close(self) -> None:
        """Let go of it: it comes to rest by its own watchdog."""
        self._socket.close()

    def _first_state(self) -> None:
        end = self._now() + FIRST_STATE
        while self._report is None:
            if self._now() > end:
                raise StudioError(
                    f"no robot answers at {self.name}: start one with `a1-studio robot`, with the "
                    "same secret where there is one"
                )
            self._hello()
            time.sleep(0.05)
            for datagram in self._receive():
                self._see(datagram)

    def _send(self, datagram: bytes) -> None:
        with suppress(OSError):  # nobody listens there now: silence says so
            self._socket.send(datagram)

    def _receive(self) -> list[bytes]:
        out: list[bytes] = []
        while len(out) < AT_ONCE:
            try:
                out.append(self._socket.recv(wire.LARGEST + 1))
            except ConnectionRefusedError:
                continue  # an answer to what was sent: nobody listened there then
            except OSError:
                break
        return out

    def _now(self) -> float:
        return time.monotonic()


def open_link(spec: str, level: Level, secret: Path | None = None) -> RobotLink | None:
    """The robot that `--robot` names; None for the simulated one of this process.

    StudioError for a spec that is none, a secret that cannot be used, or a robot that is silent.
    """
    if spec == "sim":
        return None
    kind, _, rest = spec.partition(":")
    host, _, port = rest.rpartition(":")
    if kind != "udp" or not host or not port.isdecimal() or not 0 < int(port) < 65536:
        raise StudioError(f"unknown robot {spec!r}; known: sim, udp:HOST:PORT")
    return UdpLink(host, int(port), level, read_secret(secret))


def read_secret(path: Path | None) -> bytes:
    """The bytes of a file, without white space around them; none without a file. StudioError where
    it cannot be read or is too short to keep anybody out."""
    if path is None:
        return b""
    try:
        with open_regular(path, 4096) as file:
            secret = file.read().strip()
    except OSError as error:
        raise StudioError(f"cannot read the secret {path}: {error.strerror}") from error
    if len(secret) < SHORTEST_SECRET:
        raise StudioError(f"the secret in {path} is under {SHORTEST_SECRET} bytes: make it longer")
    return secret


def checked_exposure(host: str, secret: bytes) -> None:
    """StudioError where a robot would listen to, or be driven over, a network without a secret."""
    if host not in LOOPBACK and not secret:
        raise StudioError(
            f"{host} is beyond this machine: anybody there could drive the robot; give both sides "
            "a secret (a1-studio robot --secret FILE, and --robot-secret FILE)"
        )
