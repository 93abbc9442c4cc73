"""The reader of the source: its time runs forward, however late a period is."""

from hypothesis import given, settings
from hypothesis import strategies as st

from studio.live.source_reader import SourceReader
from studio.mocap.human_tracker import HumanTracker
from studio.robot.a1 import CONTROL_DT
from studio.sources import open_source


@settings(deadline=None, max_examples=200)
@given(st.lists(st.tuples(st.floats(0.0, 4.0), st.booleans()), min_size=2, max_size=60))
def test_a_person_never_goes_back_in_time_when_periods_are_dropped(periods):
    """(periods too late, whether those that were missed are dropped then) at each deadline."""
    reader = SourceReader(open_source("operator:quiet"))
    tracker = HumanTracker(reuse=0.5, stale=0.5)
    deadline, times, shown = 0.0, [], []
    for late, dropped in periods:
        pose = reader.read(deadline + late * CONTROL_DT)
        if pose is not None:
            times.append(pose.t)
        tracker.see(pose)
        shown.append(tracker.t)
        missed = int(late)
        deadline += (1 + missed) * CONTROL_DT
        if dropped and missed:
            reader.slip(missed * CONTROL_DT)
    assert times == sorted(times)
    assert shown == sorted(shown)
    assert times
