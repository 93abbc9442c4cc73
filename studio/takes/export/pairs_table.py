"""The training pairs of a take to one Parquet file, as data set versions hold them."""

from pathlib import Path

import msgspec
import pyarrow.parquet as pq

from studio.errors import StudioError
from studio.human.features import FEATURE_NAMES
from studio.reference.intent import STATES
from studio.robot import a1
from studio.takes.dataset.datasets import code_version
from studio.takes.dataset.pairs import take_pairs, why_none
from studio.takes.dataset.pairs_file import table_of
from studio.takes.library import SessionLibrary
from studio.takes.take import Take


def write_pairs(take: Take, path: Path) -> None:
    """Columns of `datasets.schema`; the file's metadata names them. StudioError without a pair."""
    library = SessionLibrary(take.path.parent)
    found = take_pairs(library, take.name)
    if not len(found):
        raise StudioError(why_none(library, take.name))
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
