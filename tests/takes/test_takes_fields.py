"""Tick's fields stand in one place: what is added there is on the tape and in all that is read."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from make_ticks import make_ticks
from mcap.reader import make_reader

from studio.takes import columns as table
from studio.takes.record import codec
from studio.takes.record.recorder import Recorder
from studio.takes.tick import FIELDS, STREAMS, Tick, fields_in

WITH_MORE = '''
"""A studio whose Tick has two fields more, in a process of its own."""
import importlib.util, json, sys
from dataclasses import replace
from pathlib import Path

spec = importlib.util.find_spec("studio.takes.tick")
text = Path(spec.origin).read_text()
last = "    counters: dict[Name, Count] = field(default_factory=dict)\\n"
assert text.count(last) == 1
more = (
    "    balance: PerJoint = field(default_factory=lambda: np.full(12, 7.0))\\n"
    '    mood: Name = "calm"\\n'
)
module = importlib.util.module_from_spec(spec)
sys.modules["studio.takes.tick"] = module
exec(compile(text.replace(last, last + more), spec.origin, "exec"), module.__dict__)

import numpy as np
from make_ticks import make_ticks
from studio.evaluation.drive_report import trace_line
from studio.live.replay import Replay
from studio.takes.columns import columns
from studio.takes.export.formats import export
from studio.takes.record.recorder import Recorder
from studio.takes.take import read_take
from studio.takes.as_json import tick_json
from studio.live.tick_message import TickMessage
from pydantic import TypeAdapter

root, older = Path(sys.argv[1]), Path(sys.argv[2])
recorder = Recorder(root)
name = recorder.start("more")
ticks = [replace(t, balance=np.arange(12) + t.index, mood=f"m{t.index % 3}") for t in make_ticks(9)]
for tick in ticks:
    recorder.append(tick)
recorder.close()

def seen(balance, mood):
    return [np.asarray(balance).tolist(), mood]

take = read_take(root / name)
data = columns(root / name)
npz = np.load(export(take, "npz", root / "more.npz"))
shown = json.loads(tick_json(ticks[5]))
declared = TypeAdapter(TickMessage).validate_python(shown)
trace = trace_line(ticks[5])
replay = Replay("more", data)
replay.seek(t=5 / 30)
again = replay.step()
old = read_take(older).ticks[5]
row = columns(older).rows[5]
print(json.dumps({
    "tape": seen(take.ticks[5].balance, take.ticks[5].mood),
    "columns": seen(data.rows["balance"][5], data.names[data.rows["mood"][5]]),
    "json": seen(shown["balance"], shown["mood"]),
    "schema": seen(declared["balance"], declared["mood"]),
    "trace": seen(trace["balance"], trace["mood"]),
    "npz": seen(npz["balance"][5], str(npz["mood"][5])),
    "replay": seen(again.balance, again.mood),
    "older take": seen(old.balance, old.mood),
    "older columns": seen(row["balance"], columns(older).names[row["mood"]]),
}))
'''


def test_a_field_added_to_tick_is_everywhere_and_older_takes_are_still_read(tmp_path: Path):
    recorder = Recorder(tmp_path / "older")
    older = tmp_path / "older" / recorder.start("older")
    for tick in make_ticks(9):
        recorder.append(tick)
    recorder.close()
    assert len(table.columns(older)) == 9  # built without the new fields: to be built anew
    done = subprocess.run(
        [sys.executable, "-c", WITH_MORE, str(tmp_path / "new"), str(older)],
        capture_output=True, text=True, cwd=Path(__file__).parent,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    seen = json.loads(done.stdout)
    defaults = {name: seen.pop(name) for name in ("older take", "older columns")}
    assert set(seen) == {"tape", "columns", "json", "schema", "trace", "npz", "replay"}
    for form, found in seen.items():
        assert found == [[5.0 + i for i in range(12)], "m2"], form
    for form, found in defaults.items():
        assert found == [[7.0] * 12, "calm"], form


def test_what_a_form_leaves_out_are_fields_that_there_are():
    from studio.takes.tick import LEFT_OUT

    known = {f"{field.stream}.{field.attr}" for field in FIELDS}
    for form, names in LEFT_OUT.items():
        assert names <= known, form
    assert {f.attr for f in fields_in("tape", "tick")} | set(STREAMS[:3]) == set(
        Tick.__dataclass_fields__
    )


def test_the_tape_keeps_what_takes_of_the_first_version_hold():
    """By the same names, or those takes could no longer be read."""
    tick = next(iter(make_ticks(1)))
    kept = {k: json.loads(v) for k, v in codec.messages(tick, person=True).items()}
    tape = Path(__file__).parents[2] / "sessions" / "example-cmu-march" / "tape.mcap"
    seen = set()
    with tape.open("rb") as file:
        for _, channel, message in make_reader(file).iter_messages():
            stream = channel.topic.removeprefix("/")
            assert set(json.loads(message.data)) <= set(kept[stream]), stream
            seen.add(stream)
    assert seen == set(STREAMS)


def test_a_row_of_the_table_is_the_tick_but_for_what_it_leaves_out(tmp_path: Path):
    recorder = Recorder(tmp_path)
    folder = tmp_path / recorder.start("rows")
    ticks = list(make_ticks(40))
    for tick in ticks:
        recorder.append(tick)
    recorder.close()
    rows = table.columns(folder)
    for i in (0, 7, 39):
        back = table.tick_of(rows, i, ticks[i].human)
        for field in FIELDS:
            if field.stream == "human" or not field.within("columns"):
                continue
            ours, theirs = ticks[i], back
            if field.stream != "tick":
                ours, theirs = getattr(ours, field.stream), getattr(theirs, field.stream)
            ours, theirs = getattr(ours, field.attr), getattr(theirs, field.attr)
            if field.shape is None:
                assert ours == theirs or abs(ours - theirs) < 1e-9, field
            else:
                np.testing.assert_allclose(ours, theirs, atol=1e-6)
