"""Props in the view: one batch a shape, moved only where they move, gone with their scene."""

import numpy as np
import pytest

from studio import geometry
from studio.link.link import Order
from studio.options import SCENES
from studio.reference.stances import NEUTRAL
from studio.scenes.registry import scene as scene_of
from studio.scenes.stage import Stage
from studio.web import shapes
from studio.web.guarded_viser import GuardedViser
from studio.web.scene_props import Props


@pytest.fixture(scope="module")
def inner():
    """A guarded viser."""
    inner = GuardedViser()
    yield inner
    inner.stop()


def shown(stage: Stage):
    poses = stage.prop_poses()
    return None if poses is None else (stage.scene, poses)


def newest(inner, name: str) -> dict:
    buffer = inner.server._websock_server._broadcast_buffer
    updates = [
        m.updates
        for m in buffer.message_from_id.values()
        if getattr(m, "name", "") == name and hasattr(m, "updates")
    ]
    return updates[-1]


@pytest.mark.parametrize(
    "mesh",
    [shapes.box_mesh(), shapes.cylinder_mesh(), shapes.rod_mesh(), shapes.capsule_mesh(1, 2)],
)
def test_shapes_of_props_face_outwards(mesh):
    triangles = mesh.vertices[mesh.faces].astype(np.float64)
    middle = mesh.vertices.mean(axis=0)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    out = np.einsum("ij,ij->i", normal, triangles.mean(axis=1) - middle)
    area = np.linalg.norm(normal, axis=-1)
    assert (out[area > 1e-9] > 0.0).all()


def test_what_hangs_is_tied_to_its_hook():
    along = np.array([[0.0, 0.0, 2.0], [1.0, 0.0, 0.0], [0.3, -0.4, 0.5]])
    turned = geometry.quat_rotate(shapes.quat_along(along), np.tile([0.0, 0.0, 1.0], (3, 1)))
    np.testing.assert_allclose(turned, geometry.normalize(along), atol=1e-12)


@pytest.mark.parametrize("name", SCENES)
def test_every_scene_can_be_drawn(inner, name):
    props = Props(inner.server.scene)
    stage = Stage(name)
    stage.reset(NEUTRAL["stand"])
    props.update(shown(stage))
    parts = sum(len(prop.parts()) for prop in scene_of(name).props)
    handles = inner.server.scene._handle_from_node_name
    drawn = [
        h for n, h in handles.items() if n.startswith("/robot/world/props/") and "strings" not in n
    ]
    assert sum(len(h.batched_positions) for h in drawn) == parts
    props.update(None)
    assert not [n for n in handles if n.startswith("/robot/world/props")]


def test_a_box_is_drawn_where_it_is_and_sent_only_while_it_moves(inner):
    props, stage = Props(inner.server.scene), Stage("push")
    stage.reset(NEUTRAL["stand"])
    world = stage.world
    for _ in range(30):  # it comes to rest
        stage.step(Order(target=NEUTRAL["stand"].joint_pos))
    still = shown(stage)
    props.update(still)
    at = newest(inner, "/robot/world/props/moving_0")["batched_positions"]
    np.testing.assert_allclose(at[:, :2], np.tile(world.position("box")[:2], (2, 1)), atol=1e-4)
    assert at[0, 2] > at[1, 2]  # on its foot
    counter = inner.server._websock_server._broadcast_buffer
    before = counter.message_counter
    props.update(still)
    assert counter.message_counter == before
    world.put("box", (2.0, 0.3, 0.2))
    props.update(shown(stage))
    at = newest(inner, "/robot/world/props/moving_0")["batched_positions"]
    np.testing.assert_allclose(at[0, :2], [2.0, 0.3], atol=1e-6)
    props.update(None)


def test_poses_are_a_snapshot_of_the_scenes_bodies():
    stage = Stage("greeting", seed=3)
    stage.reset(NEUTRAL["stand"])
    poses = stage.prop_poses()
    assert poses is not None
    names = [prop.name for prop in stage.scene.bodied]
    assert names == ["target", "high", "ball"]
    target = names.index("target")
    np.testing.assert_allclose(poses.pos[target], stage.world.position("target"))
    string = poses.hooks[target] - poses.pos[target]
    assert string[2] == pytest.approx(0.6 + 0.09)
    kept = poses.pos.copy()
    stage.world.put("ball", (1.0, 1.0, 1.0))
    np.testing.assert_array_equal(poses.pos, kept)
    assert Stage("free").prop_poses() is None
