"""The training pairs of a take to one Parquet file, as data set versions hold them."""

from pathlib import Path

import msgspec
import pyarrow.parquet as pq

from studio.errors import StudioError
from studio.human.features import FEATURE_NAMES
from studio.reference.intent import STATES
from studio.robot import a1
from studio.takes.dataset.datasets import code_version, table_of
from studio.takes.dataset.pairs import take_pairs
from studio.takes.library import SessionLibrary
from studio.takes.take import Take


def write_pairs(take: Take, path: Path) -> None:
    """Columns of `datasets.schema`; the file's metadata names them. StudioError without a pair."""
    found = take_pairs(SessionLibrary(take.path.parent), take.name)
    if not len(found):
        raise StudioError(f"take {take.name} has no pairs: nobody was seen, or all is cut")
    about = {
        "take": take.name,
        "label": found.label,
        "lag": found.lag,
        "aligned": found.aligned,
        "code": code_version(),
        "states": STATES,
        "features": FEATURE_NAMES,
        "joints": a1.JOINTS,
        "fps": a1.CONTROL_HZ,
    }
    table = table_of(found, 0).replace_schema_metadata({"a1_studio": msgspec.json.encode(about)})
    pq.write_table(table, path, compression="zstd")
