"""The styles table: each way of meaning "walk" driven through the whole flow to the same goals.

People whom no mapper has seen are asked for half a metre a second and for both turns. They watch
the robot, as people do, and march or circle more briskly until it does what they want.
"""

import logging
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import geometry, metrics
from studio.control.drive_command import PuppeteerConfig
from studio.control.staleness import stale_command
from studio.evaluation.behind import met
from studio.evaluation.options import TableOptions
from studio.options import STYLES, ControllerName, Style
from studio.puppeteer import Puppeteer
from studio.reference import gait
from studio.reference.intent import Intent
from studio.robot.a1 import CONTROL_DT
from studio.synthetic.impaired import walking
from studio.synthetic.operator import InteractiveOperator
from studio.synthetic.person import HELD_OUT_SEED
from studio.takes.tick import Tick
from studio.training.machine import commit

log = logging.getLogger(__name__)
Array = NDArray[np.float64]

QUIET_S, SETTLE_S, MEASURED_S = 1.0, 6.0, 10.0
"""s of standing, of getting under way, and of walking that counts."""
LOOK_S = 0.5
"""s between two looks at the robot."""
EASE = 0.15
"""Share of what is missing that the operator asks for in addition after each look."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """What is asked of a person. m_s, deg_s: goals; least: what counts as reached (same signs)."""

    name: str
    m_s: float
    deg_s: float
    least_m_s: float = 0.0
    least_deg_s: float = 0.0


CASES: tuple[Case, ...] = (
    Case(name="forward", m_s=0.58, deg_s=0.0, least_m_s=0.5),
    Case(name="left", m_s=0.3, deg_s=12.0, least_deg_s=8.0),
    Case(name="right", m_s=0.3, deg_s=-12.0, least_deg_s=-8.0),
)


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """One operator's attempt: means over what counts, asked and achieved."""

    asked_m_s: float
    asked_deg_s: float
    achieved_m_s: float
    achieved_deg_s: float
    survived: bool
    walk_share: float

    def reached(self, case: Case) -> bool:
        """Upright, and as fast and turning as far as the case wants at least."""
        side = np.sign(case.least_deg_s)
        turned = side * self.achieved_deg_s >= side * case.least_deg_s
        return bool(self.survived and self.achieved_m_s >= case.least_m_s and turned)


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate styles`."""

    episodes: int = 4
    """People who try each case."""
    style: Style | None = None
    """Only this way of meaning "walk" (default: each)."""
    controller: ControllerName | None = None
    """What turns the reference into an action (default: policy)."""


def run_styles(options: Options = Options()) -> dict[str, Any]:
    """A row per style and case, over `episodes` operators each. `style`: that one only."""
    seed, controller = options.seed, options.controller
    rows = []
    for each in STYLES if options.style is None else (options.style,):
        for case in CASES:
            outcomes = [attempt(each, case, seed + k, controller) for k in range(options.episodes)]
            rows.append(row(each, case, outcomes, seed) | {"controller": controller or "policy"})
            log.info("%s, %s: %s", each, case.name, rows[-1])
    return {"rows": rows}


def row(style: str, case: Case, outcomes: list[Outcome], seed: int) -> dict[str, Any]:
    """Means over the operators, and the least of them."""

    def mean(name: str) -> float:
        return float(np.mean([getattr(o, name) for o in outcomes]))

    side = np.sign(case.deg_s) or 1.0
    return {
        "case": f"{style}, {case.name}",
        "style": style,
        "goal": case.name,
        "seed": seed,
        "episodes": len(outcomes),
        "commit": commit(),
        "commanded_m_s": case.m_s,
        "achieved_m_s": mean("achieved_m_s"),
        "least_m_s": float(min(o.achieved_m_s for o in outcomes)),
        "commanded_deg_s": case.deg_s,
        "achieved_deg_s": mean("achieved_deg_s"),
        "least_deg_s": float(side * min(side * o.achieved_deg_s for o in outcomes)),
        "asked_m_s": mean("asked_m_s"),
        "asked_deg_s": mean("asked_deg_s"),
        "expert_walk_share": mean("walk_share"),
        "survived": all(o.survived for o in outcomes),
        "reached": sum(o.reached(case) for o in outcomes),
    }


def attempt(style: str, case: Case, seed: int, controller: str | None = None) -> Outcome:
    """One person of the held-out family drives the simulated robot to the case's goals."""
    operator = InteractiveOperator(seed=HELD_OUT_SEED + seed, style=style, family="held_out")
    puppeteer = met(operator, PuppeteerConfig(style=style, controller=controller, seed=seed))
    ticks, asked = [], []
    for tick, intent in driven(puppeteer, operator, case):
        ticks.append(tick)
        asked.append((intent.speed, intent.turn))
        if tick.fallen:
            break
    first = min(round((QUIET_S + SETTLE_S) / CONTROL_DT), len(ticks) - 2)
    forward, turned = motion(ticks[first:])
    speed, turn = np.mean(asked[first:], axis=0).tolist()
    return Outcome(
        asked_m_s=speed,
        asked_deg_s=float(np.degrees(turn)),
        achieved_m_s=forward,
        achieved_deg_s=float(np.degrees(turned)),
        survived=not ticks[-1].fallen,
        walk_share=float(np.mean([tick.expert == "walk" for tick in ticks[first:]])),
    )


def driven(
    puppeteer: Puppeteer, operator: InteractiveOperator, case: Case
) -> Iterator[tuple[Tick, Intent]]:
    """Ticks and what the operator means meanwhile: quiet, then towards the goals."""
    speed, turn = case.m_s, np.radians(case.deg_s)
    intent, seen = Intent(), []
    look = round(LOOK_S / CONTROL_DT)
    start = round(QUIET_S / CONTROL_DT)
    for k in range(start + round((SETTLE_S + MEASURED_S) / CONTROL_DT)):
        if k >= start and (k - start) % look == 0:
            # Before the robot walks there is nothing to see.
            if len(seen) > 2 * look and seen[-2 * look].state == "walk":
                forward, turned = motion(seen[-2 * look :])
                speed += EASE * (case.m_s - forward)
                turn += EASE * (np.radians(case.deg_s) - turned)
            speed = float(np.clip(speed, 0.1, gait.MAX_SPEED))
            turn = float(np.clip(turn, *np.radians([-15.0, 15.0]))) if case.deg_s else 0.0
            intent = walking(speed, turn)
            operator.set_intent(intent)
        tick = puppeteer.step(operator.read(k * CONTROL_DT), stale_command)
        seen.append(tick)
        yield tick, intent


def motion(ticks: list[Tick]) -> tuple[float, float]:
    """Mean speed (m/s) along the robot's own heading, and mean turn (rad/s)."""
    pos = np.array([tick.robot.base_pos[:2] for tick in ticks])
    yaw = np.unwrap(geometry.heading(np.array([tick.robot.base_quat for tick in ticks])))
    forward, _, turn = metrics.mean_velocity(pos, yaw, CONTROL_DT).tolist()
    return forward, turn
