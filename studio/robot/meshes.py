"""Unitree's meshes to light ones any viewer can draw, as plain arrays, and where each link is.

`python -m studio.robot.meshes` fills the cache at set-up; without it the first use does.
Meshes are decimated, cut along sharp edges (so that smooth shading keeps them sharp) and turned
into their link's frame, with the URDF's mirroring of the hips applied.
"""

import hashlib
import logging
import os
import sys
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.files import whole
from studio.robot import a1

Array = NDArray[np.float64]
log = logging.getLogger(__name__)

TRIANGLES = {"trunk": 2800, "hip": 500, "thigh": 900, "thigh_mirror": 900, "calf": 700}
"""About how many triangles are left of each file; the originals have 9,000 to 29,000."""
CREASE = np.deg2rad(32.0)
"""Edges sharper than this are cut for shading, rad."""
OPENNESS = 3.0
"""Faces that show from fewer than this many of 64 directions are left out."""
COLORS = {"trunk": (62, 66, 74), "hip": (150, 158, 172), "thigh": (188, 195, 206)}
COLORS |= {"thigh_mirror": COLORS["thigh"], "calf": (44, 46, 51)}
"""The A1's livery, sRGB: Unitree's files carry one blue-grey for all but the trunk and calves."""


@dataclass(frozen=True, kw_only=True)
class LinkMesh:
    """A link's surface in its link's frame: vertices (V, 3) float32 m, faces (F, 3) uint32.

    color: sRGB of the whole link, 0 to 255.
    """

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]
    color: tuple[int, int, int]


@lru_cache(maxsize=1)
def link_meshes() -> dict[str, LinkMesh]:
    """A mesh for every link of a1.LINKS, from the cache where it is good, else made anew.

    Links with the same shape (the calves; the left and the right thighs) share the same arrays.
    """
    path = cache_file()
    try:
        return _load(path)
    except (OSError, KeyError, ValueError, EOFError, BadZipFile):
        log.info("preparing the robot's meshes (once)")
    meshes = build_meshes()
    try:
        _save(path, meshes)
    except OSError as error:
        log.warning("the meshes could not be cached in %s: %s", path.parent, error)
    return meshes


def cache_file() -> Path:
    """Where the meshes are kept: web_assets/cache beside the sources, else the user's cache."""
    root = Path(__file__).resolve().parents[2]
    if (root / "pyproject.toml").is_file():
        folder = root / "web_assets" / "cache"
    else:
        home = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
        folder = Path(home) / "a1-studio"
    recipe = repr((TRIANGLES, CREASE, OPENNESS, COLORS, "qem")).encode()
    return folder / f"a1_meshes_{hashlib.sha256(recipe).hexdigest()[:12]}.npz"


def build_meshes() -> dict[str, LinkMesh]:
    """Read, decimate and turn Unitree's meshes: about twenty seconds."""
    from studio.robot.description import load_urdf

    parts: dict[str, LinkMesh] = {name: _decimated(name) for name in TRIANGLES}
    turned: dict[tuple[str, bytes], LinkMesh] = {}
    out: dict[str, LinkMesh] = {}
    by_name = {link.name: link for link in load_urdf().links}
    for name in a1.LINKS:
        visual = by_name[name].visuals[0]
        shape = visual.geometry
        assert shape is not None
        assert shape.mesh is not None
        file = Path(shape.mesh.filename).stem
        origin = np.eye(4) if visual.origin is None else visual.origin
        key = file, np.round(origin, 9).tobytes()
        if key not in turned:
            part = parts[file]
            vertices = part.vertices @ origin[:3, :3].T + origin[:3, 3]
            turned[key] = LinkMesh(
                vertices=vertices.astype(np.float32),
                faces=part.faces,
                color=part.color,
            )
        out[name] = turned[key]
    return out


def _decimated(name: str) -> LinkMesh:
    import trimesh

    from studio.robot.decimate import decimate
    from studio.robot.description import a1_folder

    raw = trimesh.load_scene(str(a1_folder() / "meshes" / f"{name}.dae")).to_mesh()
    mesh = trimesh.Trimesh(raw.vertices, raw.faces, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=5)
    mesh.update_faces(mesh.nondegenerate_faces() & mesh.unique_faces())
    # Screws, shafts and inner walls would eat most of the triangles: only what shows is kept.
    mesh.update_faces(_openness(np.asarray(mesh.vertices), np.asarray(mesh.faces)) > OPENNESS)
    mesh.remove_unreferenced_vertices()
    points, faces = decimate(np.asarray(mesh.vertices), np.asarray(mesh.faces), TRIANGLES[name])
    light = trimesh.Trimesh(points, faces, process=True)
    light.update_faces(light.nondegenerate_faces())
    shaded = trimesh.graph.smooth_shade(light, angle=CREASE)
    return LinkMesh(
        vertices=np.asarray(shaded.vertices, dtype=np.float32),
        faces=np.asarray(shaded.faces, dtype=np.uint32),
        color=COLORS[name],
    )


def _openness(vertices: Array, faces: NDArray, directions: int = 64) -> Array:
    """From how many of `directions` around the link each face shows, (F,) (a share of its area).

    Depth buffers of points strewn over the faces, looked at from a Fibonacci sphere.
    """
    cell, skin = 8e-4, 1.2e-3
    rng = np.random.default_rng(0)
    corners = vertices[faces]
    edge_u, edge_v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * np.linalg.norm(np.cross(edge_u, edge_v), axis=-1)
    count = np.maximum(3, np.ceil(2.0 * area / cell**2)).astype(int)
    face = np.repeat(np.arange(len(faces)), count)
    u, v = rng.random((2, len(face)))
    u, v = np.where(u + v > 1.0, (1.0 - u, 1.0 - v), (u, v))
    points = corners[face, 0] + u[:, None] * edge_u[face] + v[:, None] * edge_v[face]
    step = np.arange(directions) + 0.5
    polar, around = np.arccos(1.0 - 2.0 * step / directions), np.pi * (1.0 + 5.0**0.5) * step
    sines = np.sin(polar)
    views = np.stack([np.cos(around) * sines, np.sin(around) * sines, np.cos(polar)], axis=-1)
    seen = np.zeros(len(faces))
    for view in views:
        side = geometry.normalize(np.cross(view, np.eye(3)[np.argmin(np.abs(view))]))
        plane = np.stack([side, np.cross(view, side)], axis=-1)
        pixel = np.floor(points @ plane / cell).astype(int)
        pixel -= pixel.min(axis=0)
        key = pixel[:, 0] * (pixel[:, 1].max() + 1) + pixel[:, 1]
        depth = points @ view
        front = np.full(key.max() + 1, -np.inf)
        np.maximum.at(front, key, depth)
        shows = depth > front[key] - skin
        seen += np.bincount(face[shows], minlength=len(faces))
    return seen / count


def _save(path: Path, meshes: dict[str, LinkMesh]) -> None:
    shapes: list[LinkMesh] = []
    index = []
    for mesh in meshes.values():
        if not any(mesh is known for known in shapes):
            shapes.append(mesh)
        index.append(next(i for i, known in enumerate(shapes) if known is mesh))
    arrays: dict[str, NDArray] = {"index": np.array(index)}
    for i, mesh in enumerate(shapes):
        arrays |= {
            f"vertices_{i}": mesh.vertices,
            f"faces_{i}": mesh.faces,
            f"color_{i}": np.array(mesh.color),
        }
    with whole(path, parents=True) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]


def _load(path: Path) -> dict[str, LinkMesh]:
    with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
        index = data["index"].tolist()
        if len(index) != a1.NUM_LINKS:
            raise ValueError("not a cache of the A1's meshes")
        shapes = [
            LinkMesh(
                vertices=data[f"vertices_{i}"],
                faces=data[f"faces_{i}"],
                color=tuple(data[f"color_{i}"].tolist()),
            )
            for i in range(max(index) + 1)
        ]
    return {name: shapes[i] for name, i in zip(a1.LINKS, index)}


if __name__ == "__main__":
    logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stderr)
    total = sum(len(mesh.faces) for mesh in link_meshes().values())
    log.info("robot meshes ready: %d triangles in %s", total, cache_file())
