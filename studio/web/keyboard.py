"""Held keys to an Intent: the keyboard sets what the hand-driven operator means, nothing else."""

import numpy as np

from studio.reference.intent import Intent

SPEED, FAST = 0.4, 0.75
"""m/s with W, and with Shift."""
TURN = np.deg2rad(13.0)
"""rad/s with A or D."""
TILT = np.deg2rad([17.0, 17.0, 20.0])
"""rad of roll, pitch and yaw."""
CADENCE, FAST_CADENCE, LIFT = 0.75, 1.1, 0.7
KEYS = frozenset("WADQECXFG") | {"Shift", "↑", "↓", "←", "→"}


def intent_of(keys: frozenset[str]) -> Intent:
    """What the page's held keys ask for; unknown keys mean nothing. Signs as in Intent."""
    held = {key.upper() if len(key) == 1 else key for key in keys} & KEYS

    def axis(positive: str, negative: str) -> float:
        return float(positive in held) - float(negative in held)

    tilt = TILT * np.array([axis("E", "Q"), axis("↑", "↓"), axis("←", "→")])
    reach = np.array([float("G" in held), float("F" in held)])
    turn = axis("A", "D")
    if "W" in held or turn:
        fast = "Shift" in held
        return Intent(
            state="walk",
            task="keyboard",
            speed=(FAST if fast else SPEED) if "W" in held else 0.0,
            turn=TURN * turn,
            cadence=FAST_CADENCE if fast else CADENCE,
            lift=LIFT,
        )
    if "X" in held:
        return Intent(state="sit", task="keyboard", tilt=0.5 * tilt, reach=reach)
    if reach.sum() > 1.0:
        reach = np.array([0.0, 1.0])  # standing, one front leg has to stay on the floor
    return Intent(state="stand", task="keyboard", tilt=tilt, reach=reach, crouch=float("C" in held))
