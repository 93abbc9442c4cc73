"""Shapes, places and keys: what the view is made of, by numbers."""

from dataclasses import replace

import numpy as np
import pytest

from studio import geometry
from studio.errors import StudioError
from studio.human.pose import HumanPose
from studio.human.shape import BONES
from studio.human.skeleton import INDEX, NUM_JOINTS, PARENTS
from studio.live.commands import ReleaseControl, TakeControl
from studio.live.safety import Safety
from studio.puppeteer import Puppeteer
from studio.synthetic.operator import OperatorSource
from studio.web import shapes
from studio.web.follow import HUMAN_COLUMN, HUMAN_SCALE, SOLE, Follow, HumanPlace
from studio.web.guarded_viser import GuardedViser
from studio.web.keyboard import intent_of
from studio.web.page_control import PageControl
from studio.web.scene import StudioScene

DT = 1.0 / 30.0


@pytest.fixture
def person():
    """A standing person."""
    return OperatorSource("quiet", seed=1).read(0.0)


@pytest.mark.parametrize("mesh", [shapes.bone_mesh(), shapes.ball_mesh(), shapes.disc_mesh()])
def test_shapes_are_closed_and_face_outwards(mesh):
    triangles = mesh.vertices[mesh.faces].astype(np.float64)
    # Divergence theorem: a closed surface wound outwards has a positive volume,
    volume = np.einsum("ij,ij->i", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2]))
    assert volume.sum() / 6.0 > 0.0
    # and each edge is shared by two triangles in opposite directions.
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    forward = {tuple(edge) for edge in edges.tolist()}
    assert len(forward) == len(edges)
    assert forward == {(b, a) for a, b in forward}


def test_each_bone_runs_from_its_parent_to_its_joint(person):
    joints = person.joint_pos_w
    start, wxyz, scale = shapes.bone_transforms(joints)
    tip = start + geometry.quat_rotate(wxyz, np.array([0.0, 0.0, 1.0])) * scale[:, 2:]
    for bone, joint in enumerate(BONES):
        np.testing.assert_allclose(start[bone], joints[PARENTS[joint]], atol=1e-9)
        np.testing.assert_allclose(tip[bone], joints[joint], atol=1e-9)


def test_the_trunk_is_broad_across_the_hips(person):
    _, wxyz, _ = shapes.bone_transforms(person.joint_pos_w)
    across = person.joint_pos_w[INDEX["l_hip"]] - person.joint_pos_w[INDEX["r_hip"]]
    x = geometry.quat_rotate(wxyz[0], np.array([1.0, 0.0, 0.0]))
    assert abs(x @ geometry.normalize(across)) > 0.95


def test_bones_of_no_length_are_still_drawn():
    _, wxyz, scale = shapes.bone_transforms(np.zeros((NUM_JOINTS, 3)))
    assert np.isfinite(wxyz).all()
    assert np.isfinite(scale).all()


@pytest.mark.parametrize("yaw", [0.0, 1.0, 3.0, -2.0])
def test_the_person_is_placed_rigidly_facing_forward_on_the_floor(person, yaw):
    turned = geometry.quat_rotate(
        np.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)]), person.joint_pos_w
    ) + np.array([4.0, -7.0, 0.9])
    pose = HumanPose(t=0.0, joint_pos_w=turned, confidence=np.ones(NUM_JOINTS))
    placed = HumanPlace().place(pose, DT)
    # Distances are those of the person, times the scale: nothing is bent.
    a = np.linalg.norm(placed[:, None] - placed[None], axis=-1)
    b = np.linalg.norm(turned[:, None] - turned[None], axis=-1)
    np.testing.assert_allclose(a, HUMAN_SCALE * b, atol=1e-9)
    assert placed[:, 2].min() == pytest.approx(HUMAN_SCALE * SOLE)
    np.testing.assert_allclose(placed[INDEX["pelvis"], :2], HUMAN_COLUMN[:2], atol=1e-6)
    left = placed[INDEX["l_hip"]] - placed[INDEX["r_hip"]]
    assert left[1] > 0.9 * np.linalg.norm(left)  # facing +x, the left hip is at +y


def test_a_jump_shows_and_a_lower_floor_is_found_at_once(person):
    place = HumanPlace()
    place.place(person, DT)

    def lifted(z):
        shifted = person.joint_pos_w + np.array([0.0, 0.0, z])
        return HumanPose(t=0.0, joint_pos_w=shifted, confidence=np.ones(NUM_JOINTS))

    assert place.place(lifted(0.3), DT)[:, 2].min() > HUMAN_SCALE * 0.25
    assert place.place(lifted(-0.1), DT)[:, 2].min() == pytest.approx(HUMAN_SCALE * SOLE)


def test_the_view_follows_smoothly_and_jumps_with_a_reset():
    follow = Follow(0.25)
    np.testing.assert_allclose(follow.push(np.zeros(2), DT), 0.0)
    one = follow.push(np.array([0.3, 0.0]), DT)
    assert 0.0 < one[0] < 0.1
    np.testing.assert_allclose(follow.push(np.array([5.0, 5.0]), DT), 5.0)


@pytest.mark.parametrize(
    ("keys", "state", "field", "sign"),
    [
        ("W", "walk", "speed", 1), ("WA", "walk", "turn", 1), ("D", "walk", "turn", -1),
        ("C", "stand", "crouch", 1), ("", "stand", "speed", 0),
    ],
)  # fmt: skip
def test_keys_mean_what_the_help_says(keys, state, field, sign):
    intent = intent_of(frozenset(keys))
    assert intent.state == state
    assert np.sign(getattr(intent, field)) == sign


def test_tilt_keys_have_the_signs_of_an_intent():
    # roll > 0 leans right, pitch > 0 bends forward, yaw > 0 twists left
    np.testing.assert_array_equal(np.sign(intent_of(frozenset({"E", "↑", "←"})).tilt), 1)
    np.testing.assert_array_equal(np.sign(intent_of(frozenset({"Q", "↓", "→"})).tilt), -1)
    np.testing.assert_array_equal(intent_of(frozenset({"Q", "E"})).tilt, 0)


def test_standing_lifts_one_paw_and_sitting_both():
    assert intent_of(frozenset("FG")).reach.sum() == 1.0
    assert intent_of(frozenset("FGX")).reach.sum() == 2.0


def test_unknown_keys_mean_nothing():
    intent = intent_of(frozenset({"Escape", "<script>", "Ω"}))
    assert (intent.state, intent.speed, intent.turn, intent.crouch) == ("stand", 0.0, 0.0, 0.0)
    assert not intent.tilt.any()
    assert not intent.reach.any()


class TestDesk:
    """Who drives, on a clock turned by hand."""

    def setup_method(self):
        self.now, self.sent, self.beats = 0.0, [], []
        self.safety = Safety(armed=True)
        self.control = PageControl(
            self.send, self.hear, lambda page: self.safety.silent(page, self.now)
        )

    def send(self, command):
        """As the loop does it, at its next tick."""
        self.sent.append(command)
        if isinstance(command, TakeControl):
            self.safety.take_control(command.page, self.now)

    def hear(self, page):
        self.beats.append(page)
        self.safety.beat(page, self.now)

    def beat(self, page):
        self.control.beat(page.name, visible=True, keys=frozenset(), round_trip_ms=1.0)

    def test_the_first_page_drives_and_only_its_heartbeats_count(self):
        a, b = self.control.join(), self.control.join()
        self.beat(a)
        self.beat(b)
        assert self.sent == [TakeControl(page=a.name)]
        assert self.beats == [a.name]
        assert self.control.refusal(a.name) == ""
        assert self.control.refusal(None) == ""  # a script is no page
        assert "Take control" in self.control.refusal(b.name)

    def test_a_page_that_comes_after_a_lost_one_drives(self):
        a = self.control.join()
        self.control.leave(a.name)
        b = self.control.join()
        assert self.control.holder == b.name
        assert ReleaseControl(page=a.name) not in self.sent  # lost is not given up

    def test_a_silent_page_keeps_control_until_the_robot_stands_for_want_of_it(self):
        a = self.control.join()
        self.now = 0.3
        self.control.join()
        assert self.control.holder == a.name
        self.now = 0.6
        c = self.control.join()
        assert self.control.holder == c.name

    def test_giving_up_is_said_to_the_loop(self):
        a = self.control.join()
        self.control.act("release", a.name)
        assert self.sent[-1] == ReleaseControl(page=a.name)
        assert self.control.holder is None
        with pytest.raises(StudioError, match="nobody"):
            self.control.act("release", a.name)
        with pytest.raises(StudioError, match="take"):
            self.control.act("juggle", a.name)
        with pytest.raises(StudioError, match="open pages"):
            self.control.act("take", "page-x")


@pytest.mark.parametrize("away", [False, True])
def test_what_is_in_a_robots_world_is_drawn_where_the_robot_is(away):
    inner = GuardedViser()
    try:
        scene = StudioScene(inner.server, mirror=lambda: not away)
        tick = Puppeteer().step(OperatorSource("quiet", seed=1).read(0.0))
        moved = replace(tick.robot, base_pos=tick.robot.base_pos + np.array([7.0, -3.0, 0.0]))
        tick = replace(tick, robot=moved, mode="collect" if away else "live")
        scene.update(tick, DT)
        handles = inner.server.scene._handle_from_node_name
        world = handles["/robot/world"]
        base = world.position + geometry.quat_rotate(world.wxyz, moved.base_pos)
        buffer = inner.server._websock_server._broadcast_buffer
        (drawn,) = (
            m.updates["batched_positions"][0]
            for m in buffer.message_from_id.values()
            if getattr(m, "name", "") == "/robot/trunk" and hasattr(m, "updates")
        )
        np.testing.assert_allclose(base, drawn, atol=1e-6)
        assert (world.wxyz[0] == 0.0) == away
    finally:
        inner.stop()
