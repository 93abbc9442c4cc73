"""The selector: votes, hysteresis, unknown, lock."""

import numpy as np
import pytest

from studio.errors import StudioError
from studio.retarget.selector import NAMES, Prototypes, Selector, SelectorConfig, TripletFilter

STAND, WALK, SIT = (np.array(v, dtype=float) for v in ((1, 0, 0), (0, 1, 0), (0, 0, 1)))


def clusters() -> Prototypes:
    """Twenty prototypes of each state around (0, 0), (10, 0) and (0, 10)."""
    rng = np.random.default_rng(0)
    centers = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]])
    points = (centers[:, None] + rng.normal(scale=0.3, size=(3, 20, 2))).reshape(-1, 2)
    return Prototypes(
        points=points.astype(np.float32),
        label=np.repeat(np.arange(3), 20),
        mean=np.zeros(2, np.float32),
        scale=np.ones(2, np.float32),
        project=np.eye(2, dtype=np.float32),
        p99=0.5,
    )


@pytest.fixture
def selector() -> Selector:
    return Selector(clusters())


def decide(selector: Selector, share: np.ndarray, times: int, distance: float = 0.0) -> list[str]:
    return [selector.decide(share, distance).expert for _ in range(times)]


def test_first_vote_is_taken_at_once(selector: Selector):
    assert selector.step(np.array([0.1, 4.1])).expert == "sit"
    selector.reset()
    assert selector.step(np.array([3.9, 0.0])).expert == "walk"


def test_votes_are_shares_of_the_neighbours(selector: Selector):
    votes = selector.step(np.array([4.0, 0.0])).votes
    assert votes == {"stand": 0.0, "walk": 1.0, "sit": 0.0}


def test_selector_keeps_expert_when_votes_tie(selector: Selector):
    decide(selector, STAND, 1)
    assert set(decide(selector, np.array([0.5, 0.5, 0.0]), 50)) == {"stand"}


def test_selector_keeps_expert_below_the_margin_and_switches_at_it(selector: Selector):
    decide(selector, STAND, 1)
    assert set(decide(selector, np.array([0.45, 0.55, 0.0]), 50)) == {"stand"}
    assert decide(selector, np.array([0.4, 0.6, 0.0]), 8)[-1] == "walk"


def test_a_lead_must_hold_for_eight_frames_in_a_row(selector: Selector):
    decide(selector, STAND, 1)
    assert decide(selector, WALK, 8) == ["stand"] * 7 + ["walk"]
    decide(selector, STAND, 7)
    decide(selector, WALK, 1)
    assert set(decide(selector, STAND, 7)) == {"walk"}


def test_a_lead_that_changes_hands_starts_anew(selector: Selector):
    decide(selector, STAND, 1)
    decide(selector, WALK, 7)
    assert decide(selector, SIT, 8) == ["stand"] * 7 + ["sit"]


def test_far_from_the_training_data_is_unknown_and_keeps_the_expert(selector: Selector):
    decide(selector, WALK, 1)
    assert decide(selector, SIT, 9, distance=3.0) == ["walk"] * 7 + ["unknown"] * 2
    choice = selector.decide(SIT, 3.0)
    assert choice.expert == "unknown"
    assert choice.active == "walk"
    assert decide(selector, WALK, 8, distance=0.5)[-1] == "walk"


def test_distance_is_measured_in_the_training_datas_99th_percentile(selector: Selector):
    # The ten nearest of a tight cluster 3 away: about 3 / 0.5 = 6.
    assert 5.0 < selector.step(np.array([0.0, -3.0])).distance < 7.0


def test_lock_overrides_what_is_active_but_not_what_the_votes_decide(selector: Selector):
    decide(selector, STAND, 1)
    selector.set_lock("sit")
    choices = [selector.decide(WALK, 0.0) for _ in range(20)]
    assert {c.active for c in choices} == {"sit"}
    assert choices[-1].expert == "walk"
    assert selector.decide(WALK, 9.0).active == "sit"
    selector.set_lock(None)
    assert selector.decide(WALK, 0.0).active == "walk"


def test_an_unknown_lock_lists_the_states(selector: Selector):
    with pytest.raises(StudioError, match=", ".join(sorted(NAMES))):
        selector.set_lock("fly")


def test_a_switch_takes_no_longer_than_450_ms_filter_included():
    config = SelectorConfig()
    low_pass = TripletFilter(3.0, 1 / 30)
    low_pass.step(np.array([0.0]))
    frames = next(i for i in range(1, 30) if low_pass.step(np.array([1.0]))[0] > 0.75)
    assert (frames + config.hold) / 30 <= 0.45


def test_filter_starts_at_its_first_value_and_passes_a_constant():
    low_pass = TripletFilter(3.0, 1 / 30)
    for _ in range(3):
        np.testing.assert_allclose(low_pass.step(np.array([2.0, -1.0])), [2.0, -1.0])


def test_prototypes_survive_a_round_trip_through_tensors():
    p = clusters()
    q = Prototypes.from_tensors(p.tensors())
    np.testing.assert_array_equal(p.points, q.points)
    assert q.p99 == p.p99
    assert list(q.label) == list(p.label)
