"""Every style of walking: its experts keep their contract, and its walk moves the reference."""

import numpy as np
import pytest
from canonical_people import NEUTRAL_Q

from studio import geometry
from studio.errors import StudioError
from studio.human.calibration import calibrate
from studio.human.features import FEATURE_DIM
from studio.options import STYLES
from studio.reference import gait
from studio.reference.marching import Bout, march_track
from studio.retarget.experts import EXPERTS
from studio.retarget.retargeter import Retargeter
from studio.retarget.store import load_experts
from studio.robot.a1 import CONTROL_DT, JOINT_LOWER, JOINT_UPPER
from studio.synthetic import Person, play
from studio.synthetic import signals as sig

CADENCE, SECONDS, FROM = 1.5, 7.0, 120


def walked(style, acted, turn_deg=0.0, lift=0.7, seed=1):
    """(speed m/s, turn deg/s, expert shares) of the reference from FROM on, of one walk."""
    track = march_track(
        "walk",
        SECONDS,
        [Bout(half_strides=24, cadence=CADENCE, lift=lift, turn=np.radians(turn_deg))],
    )
    person = Person.sample(np.random.default_rng(seed), sensor="mocap", style=acted).still()
    quiet = play(np.zeros((30, sig.NUM)), person, seed, "quiet").clip
    clip = play(sig.of_track(track), person, seed, "walk").clip
    retargeter = Retargeter.load(style, calibrate([quiet[i] for i in range(0, 30, 5)]))
    said = [retargeter.step(clip[i]) for i in range(len(clip))][FROM:]
    place = np.array([r.reference.base_pos[:2] for r in said])
    yaw = np.unwrap(geometry.heading(np.array([r.reference.base_quat for r in said])))
    step = np.diff(place, axis=0)
    span = CONTROL_DT * len(step)
    forward = np.sum(np.cos(yaw[1:]) * step[:, 0] + np.sin(yaw[1:]) * step[:, 1]) / span
    shares = {e: np.mean([r.expert == e for r in said]) for e in (*EXPERTS, "unknown")}
    return forward, np.degrees(yaw[-1] - yaw[0]) / span, shares


def acts(style):
    return "circles" if style == "circles" else "march"


@pytest.mark.parametrize("style", STYLES)
def test_every_style_has_an_expert_for_every_state_and_keeps_the_limits(style):
    experts = load_experts(style)
    triplet = np.concatenate([NEUTRAL_Q, np.zeros(2 * FEATURE_DIM)])
    for state in EXPERTS:
        said = experts.mappers[state].begin()(triplet)
        assert said.joint_pos.shape == (12,)
        assert said.rates.shape == (36,)
        assert np.all((said.joint_pos >= JOINT_LOWER) & (said.joint_pos <= JOINT_UPPER))
        assert np.all((said.contact_prob >= 0.0) & (said.contact_prob <= 1.0))
        assert np.linalg.norm(said.base_quat) == pytest.approx(1.0, abs=1e-6)
        batch = experts.mappers[state](np.stack([triplet, triplet]))
        assert batch.joint_pos.shape == (2, 12)
    assert experts.style == style


@pytest.mark.parametrize("style", STYLES)
def test_the_walk_of_every_style_moves_the_reference_at_the_speed_meant(style):
    speed, turn, shares = walked(style, acts(style))
    meant = float(gait.march_speed(CADENCE, 0.7))  # 0.59 m/s
    assert shares["walk"] > 0.95
    assert 0.6 * meant < speed < 1.5 * meant
    assert abs(turn) < 2.0


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("asked", [12.0, -12.0])
def test_the_walk_of_every_style_turns_to_the_side_meant(style, asked):
    _, turn, _ = walked(style, acts(style), turn_deg=asked)
    assert 3.0 < np.sign(asked) * turn < 16.0


@pytest.mark.parametrize(("style", "acted"), [("march", "circles"), ("circles", "march")])
def test_a_motion_that_walks_in_another_style_does_not_walk_in_this_one(style, acted):
    speed, _, shares = walked(style, acted)
    assert shares["walk"] < 0.05
    assert abs(speed) < 0.05


def test_styles_share_standing_and_sitting_and_say_so_by_their_sidecars():
    march = load_experts("march")
    for style in ("circles", "semantic"):
        other = load_experts(style)
        for state in ("stand", "sit"):
            assert other.sidecars[state] == march.sidecars[state]
    assert load_experts("circles").sidecars["walk"]["config"]["style"] == "circles"
    assert load_experts("circles").sidecars["selector"]["config"]["style"] == "circles"


def test_an_unknown_style_is_refused_with_the_known_ones():
    with pytest.raises(StudioError, match="circles"):
        load_experts("waltz")
