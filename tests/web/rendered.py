"""What the 3-D view draws, read back from three.js, and how far it is from a tick."""

import numpy as np
import pytest

from studio import geometry
from studio.robot import a1
from studio.robot.kinematics import link_frames_w
from studio.web.follow import HUMAN_SCALE

# What three.js draws: for each batch, the instances' matrices in the view's own frame (z up).
RENDERED = """() => {
  const m = document.querySelector('#view').contentWindow.__viserMutable;
  const root = m.nodeRefFromName[''];
  const out = {};
  for (const [name, node] of Object.entries(m.nodeRefFromName)) {
    if (!/^\\/(human|reference|robot)\\/[^/]+$/.test(name) || !node) continue;
    node.traverse((mesh) => {
      if (!mesh.getMatrixAt || !mesh.instancesCount) return;
      mesh.updateWorldMatrix(true, false);
      const toView = root.matrixWorld.clone().invert().multiply(mesh.matrixWorld);
      out[name] = Array.from({ length: mesh.instancesCount }, (_, i) =>
        toView.clone().multiply(mesh.getMatrixAt(i).clone()).elements.slice());
    });
  }
  return out;
}"""


def parts(matrices) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) and wxyz (n, 4) of column-major matrices (n, 16), scale taken out."""
    m = np.array(matrices).reshape(-1, 4, 4).transpose(0, 2, 1)
    turn = m[:, :3, :3] / np.linalg.norm(m[:, :3, :3], axis=1, keepdims=True)
    return m[:, :3, 3], geometry.quat_from_matrix(turn)


def robot_error(rendered, name, pose) -> float:
    """Largest distance, m or rad, between the drawn links and those of a tick's pose.

    The world is shifted along the floor to follow the robot; everything else must agree.
    """
    pos, quat = link_frames_w(
        np.array(pose["base_pos"]), np.array(pose["base_quat"]), np.array(pose["joint_pos"])
    )
    links = iter_links(rendered, name)
    drawn_pos = np.array([links[link][0] for link in a1.LINKS])
    drawn_quat = np.array([links[link][1] for link in a1.LINKS])
    shift = drawn_pos[0] - pos[0]
    assert shift[2] == pytest.approx(0.0, abs=0.2)
    shift[2] = 0.0
    distance = np.linalg.norm(drawn_pos - pos - shift, axis=-1).max()
    return max(float(distance), float(geometry.quat_angle(drawn_quat, quat).max()))


def iter_links(rendered, name) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Each link's drawn position and orientation: a batch's name is its first link's."""
    from studio.robot.meshes import link_meshes

    meshes = link_meshes()
    out = {}
    for node, matrices in rendered.items():
        if not node.startswith(f"/{name}/") or node.split("/")[-1] not in meshes:
            continue
        first = meshes[node.split("/")[-1]]
        links = [
            link
            for link, mesh in meshes.items()
            if np.array_equal(mesh.vertices, first.vertices)
            and np.array_equal(mesh.faces, first.faces)
        ]
        pos, quat = parts(matrices)
        assert len(links) == len(pos), node
        out |= {link: (pos[i], quat[i]) for i, link in enumerate(links)}
    return out


def human_error(rendered, human) -> float:
    """Largest distance, m in the view, after the turn about z and the shift that fit best."""
    drawn, _ = parts(rendered["/human/joints"])
    joints = HUMAN_SCALE * np.array(human["positions"])
    a, b = joints - joints.mean(0), drawn - drawn.mean(0)
    yaw = np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a[:, :2] * b[:, :2]).sum())
    turned = geometry.quat_rotate(np.array([np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)]), a)
    return float(np.linalg.norm(turned - b, axis=-1).max())


def errors(rendered, tick) -> np.ndarray:
    """(3,) of the person, the reference and the robot."""
    return np.array(
        [
            human_error(rendered, tick["human"]),
            robot_error(rendered, "reference", tick["reference"]),
            robot_error(rendered, "robot", tick["robot"]),
        ]
    )


def closest(rendered, ticks) -> dict:
    """The tick whose person is nearest to the drawn one: a robot may rest, a person never does."""
    return min(ticks, key=lambda tick: human_error(rendered, tick["human"]))
