"""Every controller of the registry, and the policies' place in it."""

import shutil

import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

from studio.control import controllers
from studio.control.action import ActionConfig
from studio.control.controllers import (
    CONTROLLERS,
    ControllerInput,
    PolicyController,
    default_controller,
    open_controller,
)
from studio.control.observation import ObservationConfig
from studio.control.observation_frame import level_quat
from studio.control.policy import MODELS, Policy, manifest_of, save_policy
from studio.errors import StudioError
from studio.reference.intent import STATES, StateName
from studio.reference.motion import with_velocity
from studio.reference.stances import NEUTRAL
from studio.robot.pose import ReferencePose, RobotState
from studio.sim.world import World


def a_policy(state: StateName, push: float = 0.1, **facts) -> Policy:
    """A policy that adds push * scale to every joint of the reference, whatever it sees."""
    dim = ObservationConfig().dim
    zero = np.zeros((12, dim), np.float32)
    tensors = {
        "mean": np.zeros(dim, np.float32),
        "std": np.ones(dim, np.float32),
        "weight_0": zero,
        "bias_0": np.full(12, push, np.float32),
    }
    manifest = manifest_of(
        state,
        ObservationConfig(),
        ActionConfig(),
        np.array(level_quat(state)),
        NEUTRAL[state].joint_pos,
        **facts,
    )
    return Policy(tensors, manifest)


def policies_of_every_state(**changes: Policy) -> dict[StateName, Policy]:
    policies: dict[StateName, Policy] = {state: a_policy(state) for state in STATES}
    policies.update(changes)  # type: ignore[arg-type]
    return policies


@pytest.fixture
def standing() -> tuple[ReferencePose, RobotState]:
    return with_velocity(NEUTRAL["stand"], NEUTRAL["stand"]), World().reset(NEUTRAL["stand"])


def at(
    standing: tuple[ReferencePose, RobotState], state: StateName, on_the_way=False
) -> ControllerInput:
    reference, robot = standing
    return ControllerInput(reference=reference, robot=robot, state=state, in_transition=on_the_way)


def test_every_controller_gives_twelve_finite_angles_in_every_state(
    standing: tuple[ReferencePose, RobotState],
):
    for name in CONTROLLERS:
        if name == "policy" and not controllers.trained():
            continue  # its own tests follow
        controller = open_controller(name)
        assert controller.name == name
        for state in STATES:
            controller.reset(at(standing, state))
            for in_transition in (False, True):
                action = controller.act(at(standing, state, in_transition))
                assert action.shape == (12,)
                assert np.isfinite(action).all()


def test_the_default_is_policy_once_trained_and_pd_playback_until_then(monkeypatch, tmp_path):
    monkeypatch.setattr(controllers, "MODELS", tmp_path)
    assert default_controller() == "pd_playback"
    with pytest.raises(StudioError, match="train policy"):
        open_controller("policy")
    for state in STATES:
        (tmp_path / f"{state}.safetensors").touch()
        (tmp_path / f"{state}.json").touch()
    assert default_controller() == "policy"


def test_an_unknown_controller_is_answered_with_the_known_ones():
    with pytest.raises(StudioError, match="stand_still"):
        controllers.open_controller("telekinesis")


def test_a_policys_residual_is_added_to_the_reference(standing: tuple[ReferencePose, RobotState]):
    reference, _ = standing
    controller = PolicyController(policies_of_every_state())
    action = controller.act(at(standing, "stand", False))
    # 0.1 * scale 0.25 = 0.025 rad on every joint
    np.testing.assert_allclose(action, reference.joint_pos + 0.025, atol=1e-6)


def test_the_destinations_policy_acts_in_a_transition_only_if_it_was_trained_on_them(
    standing: tuple[ReferencePose, RobotState],
):
    reference, _ = standing
    policies = policies_of_every_state(sit=a_policy("sit", transitions=True))
    controller = PolicyController(policies)
    np.testing.assert_array_equal(controller.act(at(standing, "walk", True)), reference.joint_pos)
    into_sit = controller.act(at(standing, "sit", True))
    np.testing.assert_allclose(into_sit, reference.joint_pos + 0.025, atol=1e-6)


def test_a_policy_that_takes_over_begins_with_a_history_of_the_present(
    standing: tuple[ReferencePose, RobotState],
):
    policies = policies_of_every_state()
    controller = PolicyController(policies)
    for _ in range(5):
        controller.act(at(standing, "stand", False))
    controller.act(at(standing, "walk", False))
    history = policies["walk"].history
    np.testing.assert_allclose(history.z[0], np.tile(history.z[0, -1], (4, 1)))


def test_a_sidecar_may_say_that_no_place_is_held_and_one_that_is_is_refused(tmp_path):
    """As those of up to 0.1 do."""
    policy = Policy.load("walk")
    observation = {**policy.manifest["observation"], "place_gain": 0.0}
    path = tmp_path / "walk.safetensors"
    save_policy(path, policy._tensors, {**policy.manifest, "observation": observation})
    assert Policy.load(path).observation == policy.observation
    observation["place_gain"] = 1.0
    save_policy(path, policy._tensors, {**policy.manifest, "observation": observation})
    with pytest.raises(StudioError, match=r"walk\.safetensors cannot be read: it holds its place"):
        Policy.load(path)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda tensors: {**tensors, "weight_0": np.full_like(tensors["weight_0"], np.nan)},
        lambda tensors: {**tensors, "mean": tensors["mean"][:-1], "std": tensors["std"][:-1]},
        lambda tensors: {**tensors, "bias_0": tensors["bias_0"][:3]},
        lambda tensors: {k: v for k, v in tensors.items() if k != "std"},
    ],
)
def test_a_policy_that_answers_nonsense_is_refused_with_its_file(tmp_path, spoil):
    shutil.copy(MODELS / "walk.json", tmp_path / "walk.json")
    save_file(spoil(load_file(MODELS / "walk.safetensors")), tmp_path / "walk.safetensors")
    with pytest.raises(StudioError, match=r"walk\.safetensors cannot be read"):
        Policy.load(tmp_path / "walk.safetensors")
