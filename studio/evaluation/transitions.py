"""How safely each state is entered from the others, under Table I: PD playback and the policies.

Every episode begins in the period in which the goal's policy takes over, out of a random motion of
the source, and goes on in the goal for the rest of its 10 s.
"""

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from studio.control.policy import MODELS
from studio.evaluation.contenders import contender, path_of
from studio.evaluation.options import PolicyOptions
from studio.evaluation.tracking import CACHE, Job, Motions, compare
from studio.reference.intent import StateName
from studio.rl.bank import MotionBank, assemble, warp
from studio.rl.transitions import SOURCES, rests_on_legs, transition_motion
from studio.robot import a1

SECONDS = 10.0
COMPARED = ("pd_playback", "policy")


def transitions_from(source: StateName) -> Motions:
    """Draws a bank of transitions out of one state."""

    def draw(state: StateName, num: int, seed: int, _cache: Path | None = None) -> MotionBank:
        rng = np.random.default_rng([seed, 7])
        frames = round(SECONDS * a1.CONTROL_HZ) + 1
        motions = [
            warp(transition_motion(source, state, rng, SECONDS + 0.2), 1.0, frames)
            for _ in range(num)
        ]
        bank = assemble(state, (f"from_{source}",), motions, [1.0] * num)
        return replace(bank, leg_contact=rests_on_legs(state))

    draw.__name__ = f"from_{source}"
    return draw


@dataclass(frozen=True, kw_only=True)
class Options(PolicyOptions):
    """Of `evaluate transitions`."""

    episodes: int = 256
    """Episodes a row."""
    controllers: tuple[str, ...] = COMPARED
    """Which controllers; a policy that is not trained has no row."""


def run_transitions(
    options: Options = Options(),
    *,
    models: Path = MODELS,
    cache: Path | None = CACHE,
    progress: bool = True,
) -> dict[str, Any]:
    """`{"rows": [...]}` as `tracking` has them, a row per way between two states and controller.

    in_charge: the live controller lets this one do it.
    """
    settings = (options.episodes, options.seed, options.threads)
    rows = []
    for goal, sources in SOURCES.items():
        for source in sources:
            chosen = in_charge(goal, models)
            found = [contender(name, goal, models) for name in options.controllers]
            jobs: list[Job] = [(goal, who) for who in found if who is not None]
            motions = transitions_from(cast(StateName, source))
            done = compare(jobs, *settings, cache, progress, motions)
            rows += [
                {"from": source, "to": goal, "in_charge": row["controller"] == chosen, **row}
                for row in done
            ]
    return {"rows": rows}


def in_charge(goal: StateName, models: Path = MODELS) -> str:
    """Who enters a state live, as PolicyController has it: a policy trained to, or the PD."""
    sidecar = path_of("policy", goal, models).with_suffix(".json")
    trained = sidecar.exists() and json.loads(sidecar.read_text()).get("transitions", False)
    return "policy" if trained else "pd_playback"
