"""Which states there is too little to learn of: asked before a training, and by the training."""

from collections.abc import Iterable, Mapping

from studio.retarget.store import ruled

MIN_PAIRS = 60
"""Pairs to learn from, two seconds: with less a state keeps the shipped expert."""
HELD_OUT = 0.2
"""Share of a state's pairs."""
WHOLE_TAKES = 5
"""From so many takes on whole ones are held out, else the end of each."""

Counts = Mapping[str, Mapping[str, int]]
"""Pairs by state and take."""


def held_takes(takes: int) -> int:
    """Of so many takes the last ones that are held out whole; 0 where the end of each is."""
    return max(1, round(HELD_OUT * takes)) if takes >= WHOLE_TAKES else 0


def learnt_of(pairs: int) -> int:
    """Of a take's pairs, how many from its start are learnt from where its end is held out."""
    return round((1.0 - HELD_OUT) * pairs)


def learnt(by_take: Mapping[str, int]) -> int:
    """Of a state's pairs by take, how many are learnt from."""
    names = sorted(name for name, pairs in by_take.items() if pairs)
    if held := held_takes(len(names)):
        return sum(by_take[name] for name in names[:-held])
    return sum(learnt_of(by_take[name]) for name in names)


def left_out(counts: Counts, states: Iterable[str], style: str) -> dict[str, str]:
    """Of these states those that would not be trained, and why, in a few words."""
    out = {}
    for state in states:
        by_take = counts.get(state, {})
        if ruled(state, style):
            out[state] = f"read by rule in style {style}"
        elif not any(by_take.values()):
            out[state] = "no take shows it"
        elif (enough := learnt(by_take)) < MIN_PAIRS:
            out[state] = f"{enough} pairs to learn from, {MIN_PAIRS} are needed"
    return out
