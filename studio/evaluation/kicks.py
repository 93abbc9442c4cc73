"""Who survives a kick: the trunk's velocity is changed at once, in any direction.

0.5 m/s standing and 0.3 m/s walking, at nominal dynamics on clean references, once an episode at a
random moment between 1 and 6 s; the episode then goes on to its 10 s.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from studio.control.policy import MODELS
from studio.evaluation.contenders import contender
from studio.evaluation.options import PolicyOptions
from studio.evaluation.tracking import HELD_OUT, library
from studio.reference.intent import StateName
from studio.rl import rollouts
from studio.timing import CONTROL_HZ
from studio.training.machine import commit

KICK_M_S: dict[StateName, float] = {"stand": 0.5, "walk": 0.3}
COMPARED = ("pd_playback", "policy")
MOMENTS_S = (1.0, 6.0)


@dataclass(frozen=True, kw_only=True)
class Options(PolicyOptions):
    """Of `evaluate kicks`."""

    episodes: int = 256
    """Episodes a row."""


def run_kicks(options: Options = Options(), *, models: Path = MODELS) -> dict[str, Any]:
    """`{"rows": [...]}` per state and controller: the share of episodes `survived` to their end,
    kicked, and `survived_unkicked` of the same episodes without the kick."""
    episodes, seed = options.episodes, options.seed
    rows = []
    for state, size in KICK_M_S.items():
        bank = library(state, episodes, HELD_OUT + 1000 * seed + 500)
        for name in COMPARED:
            who = contender(name, state, models)
            if who is None:
                continue
            shares = []
            for kick in (size, 0.0):
                rng = np.random.default_rng([seed, 11])
                env = rollouts.evaluation_env(
                    bank,
                    episodes,
                    seed,
                    randomisation=0.0,
                    noise=0.0,
                    threads=options.threads,
                    settings=who.settings,
                )
                first, last = (round(CONTROL_HZ * moment) for moment in MOMENTS_S)
                when = rng.integers(first, last, episodes)
                angle = rng.uniform(0.0, 2.0 * np.pi, episodes)
                push = kick * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
                env.reset()
                alive = np.ones(episodes, dtype=bool)
                for step in range(env.bank.frames - 1):
                    now = np.flatnonzero(when == step)
                    env.world.push(now, push[now])
                    command = who.act(env)
                    alive &= ~env.step(command.action, command.target)[2]
                shares.append(float(alive.mean()))
            rows.append(
                {
                    "state": state,
                    "controller": name,
                    "seed": seed,
                    "episodes": episodes,
                    "commit": commit(),
                    "kick_m_s": size,
                    "survived": shares[0],
                    "survived_unkicked": shares[1],
                }
            )
    return {"rows": rows}
