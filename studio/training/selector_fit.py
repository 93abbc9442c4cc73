"""The selector's metric and prototypes: neighbourhood components over many people's frames.

In plain z-scores, idle arms and body shape outweigh the feet: people not seen in training are
mistaken. So z-scores are projected to a few dimensions by neighbourhood components analysis
(Goldberger et al. 2004) in which a frame's neighbours must be found among *other* people.
"""

from collections.abc import Callable

import numpy as np
import torch
from numpy.typing import NDArray

from studio.human.features import mirror_features
from studio.retarget.network import clipped_z, z_scores
from studio.retarget.selector import NAMES, Prototypes, SelectorConfig
from studio.training.selector_data import Frames, sequences

Array = NDArray[np.float64]

DIMENSIONS = 16
PROTOTYPES = 1998
"""At most 2,000 are searched live; a third for each state, so that none wins by numbers."""
STEPS, BATCH, RATE = 300, 576, 3e-3
NOISE = 0.2
"""Sigmas of noise on z-scores while the metric is learned."""


def fit_selector(
    style: str,
    seed: int,
    seconds: float,
    tick: Callable[[int], None] | None = None,
    family: str = "default",
) -> tuple[dict[str, NDArray], dict[str, float]]:
    """Prototypes (as tensors) from `seconds` of synthetic people, and scores on held-out ones.

    Scores: share of frames whose bare vote is right, overall and per state, on people of the
    held-out family.
    """
    frames = collect(np.random.default_rng([seed, 77]), seconds, style, family, tick)
    held = collect(np.random.default_rng([seed, 78]), 300.0, style, family="held_out")
    prototypes = fit_prototypes(frames, seed)
    return prototypes.tensors(), score(prototypes, held)


def collect(
    rng: np.random.Generator,
    seconds: float,
    style: str,
    family: str = "default",
    tick: Callable[[int], None] | None = None,
) -> Frames:
    """Labelled frames of many people."""
    parts: list[Frames] = []
    for part in sequences(rng, seconds, family=family, style=style):
        parts.append(part)
        if tick:
            tick(min(round(30.0 * len(parts)), int(seconds)))
    return Frames(
        triplet=np.concatenate([p.triplet for p in parts]),
        label=np.concatenate([p.label for p in parts]),
        person=np.concatenate([p.person for p in parts]),
    )


def fit_prototypes(frames: Frames, seed: int) -> Prototypes:
    """Metric and prototypes of frames; every fifth person is kept back for the p99 distance."""
    back = frames.person % 5 == 4
    known, new = frames.take(~back), frames.take(back)
    mean, scale = z_scores(known.triplet)
    project = learn_metric(known, mean, scale, seed)
    rng = np.random.default_rng([seed, 79])
    rows = np.concatenate(
        [
            rng.choice(np.flatnonzero(known.label == c), PROTOTYPES // len(NAMES))
            for c in range(len(NAMES))
        ]
    )
    bare = Prototypes(
        points=np.zeros((1, project.shape[1]), np.float32),
        label=known.label[rows],
        mean=mean.astype(np.float32),
        scale=scale.astype(np.float32),
        project=project.astype(np.float32),
        p99=1.0,
    )
    points = bare.embed(known.triplet[rows])
    fitted = Prototypes(**{**_fields(bare), "points": points})
    distance = np.array(
        [fitted.nearest(p, SelectorConfig().k)[1].mean() for p in fitted.embed(new.triplet[::7])]
    )
    return Prototypes(**{**_fields(fitted), "p99": float(np.percentile(distance, 99.0))})


def learn_metric(frames: Frames, mean: Array, scale: Array, seed: int) -> Array:
    """(3F, D) projection of z-scores by neighbourhood components, started from whitening.

    Minimises -log of the share of probability that softmax(-distance^2) gives to frames of the
    same state, over pairs of different people, half of them mirrored.
    """
    rng, generator = np.random.default_rng([seed, 80]), torch.Generator().manual_seed(seed)
    z = clipped_z(frames.triplet, mean, scale).astype(np.float32)
    m = clipped_z(mirror_features(frames.triplet), mean, scale).astype(np.float32)
    classes = [np.flatnonzero(frames.label == c) for c in range(len(NAMES))]
    within = sum(np.cov((z[rows] - z[rows].mean(0)).T) for rows in classes) / len(classes)
    power, axes = np.linalg.eigh(within + np.eye(z.shape[1]))
    white = axes @ np.diag(power**-0.5) @ axes.T
    spread = z[::7] @ white
    main = np.linalg.svd(spread - spread.mean(0), full_matrices=False)[2][:DIMENSIONS].T
    a = torch.tensor((0.7 * white @ main).astype(np.float32), requires_grad=True)
    optimizer = torch.optim.Adam([a], lr=RATE)
    for _ in range(STEPS):
        rows = np.concatenate([rng.choice(c, BATCH // len(classes)) for c in classes])
        batch = torch.from_numpy(np.where(rng.random(len(rows))[:, None] < 0.5, z[rows], m[rows]))
        e = (batch + NOISE * torch.randn(batch.shape, generator=generator)) @ a
        person = torch.from_numpy(frames.person[rows])
        label = torch.from_numpy(frames.label[rows])
        same_person = person[:, None] == person[None]
        square = (e * e).sum(1)
        d2 = square[:, None] + square[None] - 2.0 * e @ e.T
        log_p = torch.log_softmax((-d2).masked_fill(same_person, -1e9), dim=1)
        friend = (label[:, None] == label[None]) & ~same_person
        loss = -torch.logsumexp(log_p.masked_fill(~friend, -1e9), dim=1).mean()
        loss = loss + 1e-3 * a.square().sum()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    return a.detach().numpy().astype(np.float64)


def score(prototypes: Prototypes, frames: Frames) -> dict[str, float]:
    """Share of frames whose bare vote is right: overall, and per state."""
    k = SelectorConfig().k
    rows = slice(None, None, 5)
    label = frames.label[rows]
    votes = [
        np.bincount(prototypes.nearest(p, k)[0], minlength=len(NAMES)).argmax()
        for p in prototypes.embed(frames.triplet[rows])
    ]
    right = np.array(votes) == label
    return {
        "right": float(right.mean()),
        **{f"right_{n}": float(right[label == c].mean()) for c, n in enumerate(NAMES)},
    }


def _fields(p: Prototypes) -> dict[str, object]:
    return {name: getattr(p, name) for name in p.__dataclass_fields__}
