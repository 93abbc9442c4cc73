"""VMC packets (OSC over UDP) → human poses: the source `vmc[:PORT]`.

The protocol by which apps that move virtual characters tell of them: https://protocol.vmc.info. A
frame's bones may come in any number of packets, of which some are lost or late; the next
/VMC/Ext/T ends the frame.
"""

import logging
import math
import socket
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from studio.errors import StudioError
from studio.human.pose import HumanPose
from studio.human.posture import SEEN
from studio.human.skeleton import NUM_JOINTS
from studio.mocap.osc import MAX_PACKET, read_packet
from studio.mocap.raw_frame import FrameRejected
from studio.mocap.source import Source
from studio.mocap.source_report import SourceReport, report_on
from studio.mocap.stream import StreamSource
from studio.mocap.vmc_avatar import VMC, Avatar

log = logging.getLogger(__name__)
HOST, PORT = "127.0.0.1", 39539
"""Where apps send to unless told; other machines are heard only where the address is asked for."""
OK, TIME, ROOT, BONE = (f"/VMC/Ext/{word}" for word in ("OK", "T", "Root/Pos", "Bone/Pos"))
WANTED = frozenset(address.encode() for address in (OK, TIME, ROOT, BONE))
BYTES, BYTES_AT_ONCE, PACKET = 1e6, 256e3, 32
"""Bytes a second that are looked at, and at once; a packet counts as so many more. An avatar of
55 bones, each in a packet of its own, takes 0.8 MB at 120 frames a second."""
SILENCE = 1.0
"""s after which another sender is heard; until then there is one."""
_WAKE = 0.2


class VmcSource(StreamSource):
    """A thread of its own hears packets; `read` is the loop's, as of `StreamSource`.

    address: [HOST:]PORT to listen at, None for loopback's usual one. StudioError where that cannot
    be had. host, port: where it listens.
    """

    def __init__(
        self,
        name: str = "vmc",
        address: str | None = None,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__(name, clock=clock)
        self._socket = listen(*parsed(address))
        self.host, self.port = self._socket.getsockname()
        self._avatar = Avatar()
        self._loaded = True
        self._sender: tuple[Any, float] = (None, -math.inf)
        self._budget, self._refilled = BYTES_AT_ONCE, clock()
        self._seen = np.zeros(NUM_JOINTS, dtype=bool)
        self._closed = threading.Event()
        self._faults: set[type[Exception]] = set()
        threading.Thread(target=self._hear, name="vmc", daemon=True).start()

    def push(self, raw: object) -> None:
        """Refused: its frames come by UDP."""
        Source.push(self, raw)

    def new_sender(self) -> None:
        """Whoever opens a WebSocket does not send to this source."""

    @property
    def report(self) -> SourceReport:
        """On the bones heard of in the newest frame."""
        with self._lock:
            seen, refused = self._seen, self._refused
        where = (f"hears VMC at UDP {self.host}:{self.port}",)
        return report_on(VMC, seen=seen, refused=refused, notes=where)

    def close(self) -> None:
        """The thread ends, and with it the socket."""
        self._closed.set()
        super().close()

    def _hear(self) -> None:
        with self._socket:
            while not self._closed.is_set():
                try:
                    packet, sender = self._socket.recvfrom(MAX_PACKET + 1)
                except TimeoutError:
                    continue
                except OSError as error:  # what an earlier answer of ours met, on some systems
                    log.debug("vmc: %s", error)
                    continue
                try:
                    self._take_packet(packet, sender)
                except FrameRejected as error:
                    self._refuse(str(error))
                except Exception as error:  # our own mistake: a thread that ended would be deaf
                    if type(error) not in self._faults:
                        self._faults.add(type(error))
                        log.exception("a VMC packet could not be taken")
                    self._refuse("it could not be taken: the studio's own fault, see its log")

    def _take_packet(self, packet: bytes, sender: Any) -> None:
        now = self._clock()
        self._spend(len(packet) + PACKET, now)
        messages = read_packet(packet, WANTED)
        known, at = self._sender
        if not messages:
            return
        if sender != known:
            if now - at <= SILENCE:
                raise FrameRejected(
                    f"another sender ({sender[0]}:{sender[1]}) sends, too: stop one"
                )
            self._avatar.clear()
            self._loaded = True
            super().new_sender()
        self._sender = sender, now
        for address, arguments in messages:
            try:
                self._take_message(address, arguments)
            except FrameRejected as error:
                self._refuse(str(error))

    def _spend(self, cost: int, now: float) -> None:
        """Beyond its rate a socket is not read: what more there is, the system throws away."""
        self._budget += BYTES * (now - self._refilled)
        self._budget, self._refilled = min(BYTES_AT_ONCE, self._budget) - cost, now
        if self._budget < 0.0:
            self._closed.wait(-self._budget / BYTES)
            raise FrameRejected(f"more than {BYTES / 1e6:g} MB a second: send fewer frames")

    def _take_message(self, address: str, arguments: Sequence[Any]) -> None:
        if address in (ROOT, BONE):
            name, numbers = arguments[0] if arguments else None, arguments[1:]
            if not isinstance(name, str) or any(isinstance(n, str) for n in numbers):
                raise FrameRejected(f"{address}: a name and numbers are needed")
            if address == ROOT:
                self._avatar.set_root(numbers)
            else:
                self._avatar.set_bone(name, numbers)
        elif not arguments or isinstance(arguments[0], str):
            raise FrameRejected(f"{address}: a number is needed")
        elif address == TIME:
            self._end_frame(float(arguments[0]))
        else:
            self._loaded = arguments[0] != 0
            if not self._loaded:
                self._avatar.clear()

    def _end_frame(self, t: float) -> None:
        joints = self._avatar.end_frame()
        if joints is None or not self._loaded:
            return
        joint_pos_w, confidence = VMC.to_canonical(*joints)
        pose = HumanPose(t=t, joint_pos_w=joint_pos_w, confidence=confidence)
        self._admit(self._gate.check_pose, pose)
        with self._lock:
            self._seen = confidence >= SEEN


def parsed(address: str | None) -> tuple[str, int]:
    """Host and port of [HOST:]PORT; StudioError where it is neither."""
    host, _, port = (address or str(PORT)).rpartition(":")
    if not (port.isascii() and port.isdecimal() and int(port) < 65_536):
        raise StudioError(
            f"{address!r} is no port: write vmc, vmc:{PORT}, or vmc:0.0.0.0:{PORT} to hear others"
        )
    return host or HOST, int(port)


def listen(host: str, port: int) -> socket.socket:
    """A UDP socket there; StudioError where there is none to be had."""
    heard = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        # The same source chosen again takes over from the one before.
        heard.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        heard.bind((host, port))
        heard.settimeout(_WAKE)
    except OSError as error:
        heard.close()
        raise StudioError(
            f"cannot listen at UDP {host}:{port} ({error.strerror}): stop what listens there, or "
            "write vmc:PORT and have your app send to that port"
        ) from error
    return heard
