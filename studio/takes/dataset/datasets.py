"""Takes to data set versions: pairs as one Parquet file, named by what they were made from.

A version is the hash of the tapes, the edits that matter (with the lag as it was taken out, which
a session's other takes may have told) and the code that makes pairs; the same takes of the same
session give the same version, wherever and whenever. Versions are never changed: that the manifest
gives its version, and the table the hash of the contents in it, is checked on loading.

    sessions/datasets/VERSION/pairs.parquet, manifest.json
"""

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from studio import __version__
from studio.errors import StudioError, unknown_name
from studio.files import fingerprint, opened, whole
from studio.reference.intent import STATES
from studio.takes.dataset.manifest import read_manifest
from studio.takes.dataset.pairs import Pairs, settled, take_pairs, walked_in, why_none
from studio.takes.dataset.pairs_file import content_hash, read_table, schema, statistics, table_of
from studio.takes.edit.edits import Edits
from studio.takes.names import check_name
from studio.takes.record.meta import TAPE
from studio.takes.session_library import SessionLibrary

DATASETS, TABLE, MANIFEST = "datasets", "pairs.parquet", "manifest.json"
FORMAT_VERSION = 1
_CODE = (
    "geometry", "rhythm", "timing", "human", "reference", "robot", "takes/align", "takes/columns",
    "takes/dataset/pairs", "takes/edit", "takes/record", "takes/untrusted", "takes/take",
    "takes/tick",
)  # fmt: skip
_EDITS = ("trim", "cuts", "lag", "warp", "keep", "label")
_TAKE = ("name", "tape", "edits")
_MADE_FROM = ("format_version", "code", "states", "style")


@dataclass(frozen=True, kw_only=True)
class DataSet:
    """A version, read and checked. arrays: as `pairs.SHAPES`, (N, …) float32; take (N,) index into
    manifest["takes"]; state (N,) index into STATES; tick (N,)."""

    version: str
    manifest: dict[str, Any]
    arrays: dict[str, NDArray[Any]]

    def __len__(self) -> int:
        return len(self.arrays["tick"])

    def of(self, state: str) -> dict[str, NDArray[Any]]:
        """The rows of one state: `arrays` cut to its n frames. StudioError for an unknown state."""
        if state not in STATES:
            raise unknown_name("state", state, STATES)
        rows = self.arrays["state"] == STATES.index(state)
        return {name: value[rows] for name, value in self.arrays.items()}


def build(
    library: SessionLibrary,
    names: Sequence[str] | None = None,
    *,
    states: Iterable[str] = STATES,
    style: str = "march",
) -> DataSet:
    """The data set of these takes (without names: of all that were kept), made or found again.

    style: which human motion means walking. Raises StudioError for an unknown take or state, one
    that cannot be read, walking in another style, and when there is no pair in them.
    """
    states = sorted(set(states))
    for state in states:
        if state not in STATES:
            raise unknown_name("state", state, STATES)
    if names is None:
        names = [info.name for info in library.list() if info.kept]
        if not names:
            raise StudioError("no take is kept yet: keep some, or name those to use")
    names = sorted(set(names))
    known = {name: settled(library, name) for name in names}
    if "walk" in states:
        _same_style(style, {n: walked_in(library, n, edits) for n, (edits, _) in known.items()})
    made_from = {
        "format_version": FORMAT_VERSION,
        "code": code_version(),
        "states": states,
        "style": style,
        "takes": [_take_key(library, name, edits) for name, (edits, _) in known.items()],
    }
    version = _version(made_from)
    folder = library.root / DATASETS / version
    if not (folder / MANIFEST).exists():
        _write(library, folder, made_from, version, known)
    return load(library.root, version)


def load(root: Path, version: str) -> DataSet:
    """A version of a sessions folder; StudioError when it is unknown, incomplete or was changed."""
    folder = Path(root) / DATASETS / check_name(version, "data set version")
    if not folder.is_dir():
        known = ", ".join(m["version"] for m in versions(root)[-8:]) or "none yet"
        raise StudioError(f"unknown data set version {version!r}; known: {known}")
    again = "delete its folder and build it again"
    try:
        manifest = read_manifest(folder / MANIFEST, FORMAT_VERSION)
        if manifest["format_version"] != FORMAT_VERSION:
            raise StudioError(
                f"data set {version} has format {manifest['format_version']}, this studio reads"
                f" {FORMAT_VERSION}: {again}"
            )
        made_from = {key: manifest[key] for key in _MADE_FROM} | {
            "takes": [{key: row[key] for key in _TAKE} for row in manifest["takes"]]
        }
        arrays = read_table(folder / TABLE)
    except (OSError, KeyError, ValueError, pa.ArrowException) as e:
        raise StudioError(f"data set {version} cannot be read ({e}): {again}") from e
    if _version(made_from) != version:
        raise StudioError(f"the manifest of data set {version} was changed: {again}")
    if content_hash(arrays) != manifest.get("content"):
        raise StudioError(f"data set {version} is not what its manifest says: {again}")
    return DataSet(version=version, manifest=manifest, arrays=arrays)


def versions(root: Path) -> list[dict[str, Any]]:
    """The manifests of all versions, the newest last; damaged ones are left out."""
    found = []
    for path in (Path(root) / DATASETS).glob(f"*/{MANIFEST}"):
        try:
            manifest = read_manifest(path, FORMAT_VERSION)
            found.append((manifest.get("made", ""), manifest))
        except (OSError, ValueError):
            continue
    return [manifest for _, manifest in sorted(found, key=lambda row: row[0])]


def code_version() -> str:
    """A hash of the sources that decide what a pair is."""
    return fingerprint(*_CODE)[:16]


def _version(made_from: Mapping[str, Any]) -> str:
    return hashlib.sha256(msgspec.json.encode(made_from, order="deterministic")).hexdigest()[:16]


def _same_style(style: str, walked: Mapping[str, str | None]) -> None:
    """StudioError where somebody walks in another style than `style`."""
    others = {name: own for name, own in walked.items() if own not in (None, style)}
    if not others:
        return
    first = next(iter(others.values()))
    names = [name for name, own in others.items() if own == first]
    some = ", ".join(names[:8]) + (f" and {len(names) - 8} more" if len(names) > 8 else "")
    raise StudioError(
        f"walking is in style {first}, not {style}, in {some}: train with --style {first}, or leave"
        " these takes out"
    )


def _take_key(library: SessionLibrary, name: str, known: Edits) -> dict[str, Any]:
    folder, edits = library.folder(name), asdict(known)
    try:
        with opened(folder / TAPE) as file:
            tape = hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise StudioError(f"take {name} has no tape to read: {error.strerror}") from error
    return {"name": name, "tape": tape, "edits": {key: edits[key] for key in _EDITS}}


def _write(
    library: SessionLibrary,
    folder: Path,
    made_from: dict[str, Any],
    version: str,
    known: Mapping[str, tuple[Edits, str]],
) -> None:
    """Take by take, so that memory holds one; a temporary folder, renamed when it is whole."""
    rows = []
    try:
        with whole(folder, parents=True) as temporary:
            temporary.mkdir()
            with pq.ParquetWriter(temporary / TABLE, schema(), compression="zstd") as writer:
                for number, take in enumerate(made_from["takes"]):
                    found = take_pairs(library, take["name"], known[take["name"]])
                    use = np.isin(found.state, [STATES.index(s) for s in made_from["states"]])
                    if use.any():
                        writer.write_table(table_of(found, number, use))
                    rows.append(_about(found, use))
            arrays = read_table(temporary / TABLE)
            if not len(arrays["tick"]):
                raise StudioError(_why_none(library, list(known), made_from["states"]))
            manifest = made_from | {
                "version": version,
                "made": datetime.now().astimezone().isoformat(timespec="seconds"),
                "studio_version": __version__,
                "content": content_hash(arrays),
                "count": len(arrays["tick"]),
                "takes": [a | b for a, b in zip(made_from["takes"], rows, strict=True)],
                "statistics": statistics(arrays),
            }
            (temporary / MANIFEST).write_bytes(
                msgspec.json.format(msgspec.json.encode(manifest), indent=2)
            )
    except OSError as error:
        raise StudioError(f"the data set was not written: {error.strerror}") from error


def _why_none(library: SessionLibrary, names: list[str], states: list[str]) -> str:
    if any(len(take_pairs(library, name)) for name in names):
        return f"there is no pair of {', '.join(states)} in these takes: ask for other states"
    more = f" (and none in {len(names) - 1} more)" if len(names) > 1 else ""
    return why_none(library, names[0]) + more


def _about(found: Pairs, use: NDArray[np.bool_]) -> dict[str, Any]:
    counts = {s: int(np.sum(found.state[use] == i)) for i, s in enumerate(STATES)}
    return {"pairs": int(use.sum()), "by_state": counts, "lag": found.lag, "aligned": found.aligned}
