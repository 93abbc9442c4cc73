"""The rivals by name: who is behind each, what each is given, and how it is fitted.

Every one takes a state's pairs and becomes that state's expert (`retarget.mapper.Expert`).
"""

import inspect
from collections.abc import Callable
from dataclasses import dataclass

from studio.reference.intent import StateName
from studio.retarget.baselines.dontcheva2003 import MIMICKED, Dontcheva2003
from studio.retarget.baselines.frames import Memoryless, Pairs, Targets
from studio.retarget.baselines.gmr import Gmr
from studio.retarget.baselines.kim2020 import Kim2020
from studio.retarget.baselines.seol2013 import Seol2013
from studio.retarget.baselines.simple import NearestPair, Ridge, StandStill
from studio.retarget.baselines.yamane2010 import KEY_POSES, Yamane2010
from studio.retarget.mapper import Expert


@dataclass(frozen=True, kw_only=True)
class Rival:
    """letter: in the paper's comparison, or "". given: what it is fitted to. fit: (state, pairs,
    seed) to an expert; raises StudioError for pairs that it cannot map."""

    letter: str
    title: str
    given: str
    fit: Callable[[StateName, Pairs, int], Expert]

    def says(self, what: str) -> str:
        """What its file says under "Source", "Limits" or such; "" where it says nothing."""
        module = inspect.getmodule(self.fit)
        paragraphs = ((module and module.__doc__) or "").split("\n\n")
        said = [" ".join(text.split()).partition(f"{what}: ")[2] for text in paragraphs]
        return next((text[:1].upper() + text[1:] for text in said if text), "")


RIVALS: dict[str, Rival] = {
    "stand_still": Rival(
        letter="",
        title="the neutral pose, whatever the person does",
        given="nothing",
        fit=lambda state, pairs, seed: Memoryless(StandStill(state)),
    ),
    "nearest_pair": Rival(
        letter="",
        title="the robot's frame of the most similar person",
        given="every pair",
        fit=lambda state, pairs, seed: Memoryless(NearestPair(pairs.triplet, Targets.of(pairs))),
    ),
    "ridge": Rival(
        letter="",
        title="one linear map",
        given="every pair",
        fit=lambda state, pairs, seed: Memoryless(Ridge(pairs.triplet, Targets.of(pairs))),
    ),
    "kim2020": Rival(
        letter="A",
        title="Kim et al. 2020: a cycle's phase, frequency and amplitude, in the plane",
        given="whole performances",
        fit=Kim2020.fit,
    ),
    "dontcheva2003": Rival(
        letter="B",
        title="Dontcheva et al. 2003: layered acting",
        given=f"{MIMICKED} mimicked clips",
        fit=Dontcheva2003.fit,
    ),
    "yamane2010": Rival(
        letter="C",
        title="Yamane et al. 2010: a shared Gaussian-process latent space",
        given=f"{KEY_POSES} key-pose pairs, no velocities",
        fit=Yamane2010.fit,
    ),
    "seol2013": Rival(
        letter="D",
        title="Seol et al. 2013: chosen features, classified mappings, coupled clips",
        given="example clips and ticked feature pairs",
        fit=Seol2013.fit,
    ),
    "gmr": Rival(
        letter="",
        title="after GMR, 2025: inverse kinematics of hands, feet and chest",
        given="one resting pose of a person",
        fit=Gmr.fit,
    ),
}
"""In the order of the table; "expert", ours, is not among them."""
