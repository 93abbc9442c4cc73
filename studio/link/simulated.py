"""A link over a line that delays, jitters and loses, to a robot's side in this process: for tables.

Everything but the line is as by UDP: the same datagrams, checks and watchdog, on simulated time.
"""

import heapq
from dataclasses import dataclass, replace

import numpy as np

from studio import geometry
from studio.control.controllers import PolicyController
from studio.link.engine import Engine, MujocoEngine
from studio.link.link import Level, Order
from studio.link.remote import RemoteLink
from studio.link.robot_policy import RobotPolicy
from studio.link.robot_server import RobotServer
from studio.link.robot_side import RobotSide
from studio.reference.stances import NEUTRAL
from studio.robot.a1 import CONTROL_DT
from studio.robot.pose import RobotPose, RobotState
from studio.sim.prop_world import PropWorld
from studio.sim.world import World

_STUDIO = ("127.0.0.1", 0)
_STATES_EVERY: dict[Level, int] = {"targets": 1, "references": 4}
"""Steps between two states that are sent. Nobody acts on them where policies are at the robot: 60 a
second tell as much as 240, for less work."""


@dataclass(frozen=True, kw_only=True)
class Line:
    """One way. delay, jitter: s; each datagram takes `delay` and up to `jitter` more, so that some
    overtake others. loss: share of them that never arrive."""

    delay: float = 0.0
    jitter: float = 0.0
    loss: float = 0.0


class Channel:
    """Datagrams on their way. The same seed, the same fate."""

    def __init__(self, line: Line, rng: np.random.Generator) -> None:
        self._line, self._rng = line, rng
        self._heap: list[tuple[float, int, bytes]] = []
        self._count = 0

    def send(self, datagram: bytes, now: float) -> None:
        """At `now`, s."""
        line, rng = self._line, self._rng
        if line.loss and rng.random() < line.loss:
            return
        late = line.delay + (line.jitter * rng.random() if line.jitter else 0.0)
        self._count += 1
        heapq.heappush(self._heap, (now + late, self._count, datagram))

    def arrived(self, now: float) -> list[bytes]:
        """Those that are there by `now`, in the order in which they came."""
        out = []
        while self._heap and self._heap[0][0] <= now + 1e-9:
            out.append(heapq.heappop(self._heap)[2])
        return out


class SimulatedLink(RemoteLink):
    """Its robot lives in a world of the studio's, and begins standing. One thread."""

    def __init__(
        self,
        line: Line,
        level: Level,
        seed: int = 0,
        *,
        policy: RobotPolicy | None = None,
        engine: Engine | None = None,
    ) -> None:
        """policy: on the robot's side (default: the shipped ones). engine: its body (default: that
        of the world which is entered)."""
        super().__init__(f"{level} over a simulated line", level)
        self._line, self._seed = line, seed
        self._policy = policy or RobotPolicy(PolicyController())
        self._world: World | None = None
        self._time, self._states_every = 0.0, _STATES_EVERY[level]
        self.simulated = engine is None
        if engine is not None:
            engine.place(NEUTRAL["stand"])
            self._begin(engine)
            self.side.set_down()

    def enter(self, world: World) -> None:
        """The robot lives in this world."""
        self._world = world
        self._begin(MujocoEngine(world))

    def _begin(self, engine: Engine) -> None:
        rng = np.random.default_rng([self._seed, 23])
        self._up, self._down = Channel(self._line, rng), Channel(self._line, rng)
        self.side = RobotSide(engine.dt, self._policy)
        self.server, self.engine = RobotServer(engine, self.side), engine
        self._steps = round(CONTROL_DT / engine.dt)
        self._meet()

    @property
    def world(self) -> World:
        """Where the robot lives. StudioError for one with an engine of its own."""
        return super().world if self._world is None else self._world

    def exchange(self, order: Order) -> RobotState:
        """One control period of the robot's side, and what has arrived from there by its end."""
        super().exchange(order)
        touched: set[tuple[str, str]] = set()
        for k in range(self._steps):
            for datagram in self._up.arrived(self._time):
                self.server.hear(datagram, _STUDIO, self._time)
            sent = self.server.step(self._time)
            self._time += self.engine.dt
            if sent is not None and (k + 1) % self._states_every == 0:
                self._down.send(sent[0], self._time)
            if isinstance(self._world, PropWorld):
                touched |= self._world.touched
        if isinstance(self._world, PropWorld):
            self._world.touched = frozenset(touched)
        return self.sense()

    def place(self, pose: RobotPose) -> RobotState:
        """Standing where `pose` is and faces, its line empty. An engine of its own stays."""
        if not self.simulated:
            return self.sense()
        at = geometry.quat_from_yaw(pose.yaw)
        self.engine.place(replace(NEUTRAL["stand"], base_pos=pose.base_pos, base_quat=at))
        self.side.set_down()
        self._up.arrived(np.inf)
        self._down.arrived(np.inf)
        self._meet()
        return self.sense()

    def _meet(self) -> None:
        """Both know each other, as before a drive begins."""
        self._time += 1.0
        answer = self.server.hear(self._greeting(), _STUDIO, self._time)
        assert answer is not None
        self._see(answer)

    def _send(self, datagram: bytes) -> None:
        self._up.send(datagram, self._time)

    def _receive(self) -> list[bytes]:
        return self._down.arrived(self._time)

    def _now(self) -> float:
        return self._time
