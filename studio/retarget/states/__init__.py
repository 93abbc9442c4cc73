"""The experts, one file each."""

from studio.reference.intent import StateName
from studio.retarget.states.expert import ExpertSpec
from studio.retarget.states.sit import SIT
from studio.retarget.states.stand import STAND
from studio.retarget.states.walk import WALK

EXPERTS: dict[StateName, ExpertSpec] = {"stand": STAND, "walk": WALK, "sit": SIT}
"""In the order in which votes are counted and shown."""

__all__ = ["EXPERTS", "SIT", "STAND", "WALK", "ExpertSpec"]
