"""The gate: every frame that fits comes through as it is; everything else is FrameRejected."""

import contextlib
import json
import math

import numpy as np
import pytest
from human_frames import object_of
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from studio.errors import StudioError
from studio.human.pose import HumanPose
from studio.human.sensor_skeletons import SKELETONS
from studio.human.skeleton import INDEX, NEUTRAL
from studio.mocap.gate import BURST, MAX_RATE, FrameGate
from studio.mocap.raw_frame import MAX_BYTES, FrameRejected


class Clock:
    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def gate(clock: Clock) -> FrameGate:
    return FrameGate(clock=clock)


def frame(t: float = 0.0, positions: ArrayLike = NEUTRAL, **fields: object) -> dict:
    positions = np.asarray(positions).tolist()
    return {"t": t, "skeleton": "studio", "positions": positions, **fields}


def test_a_good_frame_comes_through_unchanged_as_text_bytes_or_object(clock):
    for form in (dict, json.dumps, lambda f: json.dumps(f).encode()):
        pose = FrameGate(clock=clock).check(form(frame(1.5)))
        assert pose.t == 1.5
        assert pose.joint_pos_w == pytest.approx(NEUTRAL)
        assert (pose.confidence == 1.0).all()


def test_a_pose_written_as_a_frame_reads_back_the_same(gate):
    rng = np.random.default_rng(0)
    confidence = rng.random(19)
    pose = HumanPose(t=2.0, joint_pos_w=NEUTRAL + rng.normal(size=(19, 3)) * 0.05,
                     confidence=confidence)  # fmt: skip
    back = gate.check(json.dumps(object_of(pose)))
    assert (back.joint_pos_w == pose.joint_pos_w).all()
    assert (back.confidence == confidence).all()


@pytest.mark.parametrize("name", sorted(SKELETONS))
def test_frames_of_every_skeleton_are_taken(gate, name):
    source = SKELETONS[name]
    raw = np.linalg.pinv(source.weights) @ NEUTRAL @ source.axes
    pose = gate.check({"t": 0, "skeleton": name, "positions": raw.tolist()})
    assert pose.joint_pos_w[INDEX["l_knee"]] == pytest.approx(NEUTRAL[INDEX["l_knee"]])


def test_unknown_fields_are_let_be_and_a_null_confidence_means_none(gate):
    gate.check(frame(confidence=None, sensor="lidar", frame_number=7))


def test_a_frame_that_shows_nobody_is_a_pose_with_no_confidence(gate):
    pose = gate.check(frame(positions=np.zeros((19, 3)), confidence=[0] * 19))
    assert not pose.confidence.any()


def spoilt(row: int, axis: int, value: float) -> list:
    positions = NEUTRAL.tolist()
    positions[row][axis] = value
    return positions


UNSEEN = {
    "null": [None, None, None],
    "no position at all": None,
    "nan": [math.nan] * 3,
}


@pytest.mark.parametrize("way", ["object", "text", "bytes"])
@pytest.mark.parametrize("said", sorted(UNSEEN))
@pytest.mark.parametrize("confidence", [None, [1.0] * 19])
def test_a_joint_without_a_place_is_not_seen_and_the_rest_is(gate, said, way, confidence):
    raw = frame(confidence=confidence)
    raw["positions"][INDEX["l_wrist"]] = UNSEEN[said]
    text = json.dumps(raw)  # Python's JSON has NaN
    pose = gate.check({"object": raw, "text": text, "bytes": text.encode()}[way])
    assert pose.confidence[INDEX["l_wrist"]] == 0.0
    seen = np.arange(19) != INDEX["l_wrist"]
    assert (pose.confidence[seen] == 1.0).all()
    assert (pose.joint_pos_w[seen] == NEUTRAL[seen]).all()
    assert np.isfinite(pose.joint_pos_w).all()


@pytest.mark.parametrize("unsure", [None, math.nan])
def test_a_confidence_that_is_none_means_not_seen(gate, unsure):
    confidence = [1.0] * 19
    confidence[3] = unsure
    pose = gate.check(json.dumps(frame(confidence=confidence)))
    assert pose.confidence.tolist() == [1.0] * 3 + [0.0] + [1.0] * 15


def test_a_person_on_a_map_may_be_kilometres_from_its_origin(gate):
    far = NEUTRAL + [30_000.0, -2_000.0, 500.0]
    assert (gate.check(frame(positions=far)).joint_pos_w == far).all()


def nested(depth: int) -> list:
    out: list = []
    for _ in range(depth):
        out = [out]
    return out


GOOD = json.dumps(frame())
HOSTILE = {
    "nothing": ("", "truncated"),
    "no json": ("hello", "malformed"),
    "half a frame": (GOOD[: len(GOOD) // 2], "truncated"),
    "two frames": (GOOD + GOOD, "malformed"),
    "bad utf-8": (b"\xff\xfe\x00", "malformed"),
    "invalid utf-8 in a string": (b'{"t": 0, "skeleton": "\xff", "positions": []}', "utf-8"),
    "a lone surrogate": ('{"skeleton": "\ud800"}', "surrogates"),
    "null": ("null", "got `null`"),
    "a number": ("3", "got `int`"),
    "a list": ("[]", "got `array`"),
    "a python list": ([], "not list"),
    "none": (None, "not NoneType"),
    "an empty object": ("{}", "missing required field `t`"),
    "no positions": ('{"t": 0, "skeleton": "studio"}', "`positions`"),
    "t null": ({**frame(), "t": None}, "$.t"),
    "t text": ({**frame(), "t": "0"}, "$.t"),
    "t a list": ({**frame(), "t": [0]}, "$.t"),
    "t bool": ({**frame(), "t": True}, "$.t"),
    "t nan": (frame(math.nan), "no time"),
    "t infinite": (frame(math.inf), "no time"),
    "t huge": (frame(1e300), "no time"),
    "t a huge integer": ({**frame(), "t": 10**400}, "a frame is"),
    "t a huge integer in text": (GOOD.replace('"t": 0.0', '"t": ' + "9" * 5000), "a frame is"),
    "t in milliseconds since 1970": (frame(1.7e12), "seconds"),
    "NaN literal": (GOOD.replace('"t": 0.0', '"t": NaN'), "$.t"),
    "Infinity literal": (GOOD.replace('"t": 0.0', '"t": -Infinity'), "a frame is"),
    "unknown skeleton": ({**frame(), "skeleton": "kinect9"}, "k4abt, kinect2, mediapipe, studio"),
    "skeleton a number": ({**frame(), "skeleton": 3}, "$.skeleton"),
    "skeleton a list": ({**frame(), "skeleton": ["studio"]}, "$.skeleton"),
    "skeleton long": ({**frame(), "skeleton": "x" * 60_000}, "unknown skeleton"),
    "too few joints": (frame(positions=NEUTRAL[:-1]), "18 positions; skeleton studio has 19"),
    "too many joints": (frame(positions=[*NEUTRAL.tolist()] * 2), "38 positions"),
    "no joints": (frame(positions=[]), "0 positions"),
    "two coordinates": (frame(positions=NEUTRAL[:, :2]), "$.positions[0]"),
    "four coordinates": (frame(positions=np.ones((19, 4))), "$.positions[0]"),
    "flat positions": (frame(positions=NEUTRAL.ravel()), "$.positions[0]"),
    "ragged": ({**frame(), "positions": [[0, 0, 0], [0]] + [[0, 0, 0]] * 17}, "$.positions[1]"),
    "position nan": (frame(positions=spoilt(3, 1, math.nan)), "not finite"),
    "position null in part": ({**frame(), "positions": [[None, 0, 0]] * 19}, "not finite"),
    "no position known": (frame(positions=np.full((19, 3), math.nan)), "no joint has a place"),
    "positions all null": ({**frame(), "positions": [None] * 19}, "no joint has a place"),
    "position infinite": (frame(positions=spoilt(3, 1, -math.inf)), "not finite"),
    "position 1e999": (GOOD.replace("[[0.0", "[[1e999", 1), "out of range"),
    "position far": (frame(positions=spoilt(3, 1, 1.1e5)), "beyond 100000 m"),
    "one joint far": (frame(positions=spoilt(3, 1, 101.0)), "from its middle"),
    "position text": ({**frame(), "positions": [["a", 0, 0]] * 19}, "$.positions[0][0]"),
    "positions an object": ({**frame(), "positions": {"0": [0, 0, 0]}}, "$.positions"),
    "position a huge integer": ({**frame(), "positions": [[10**400, 0, 0]] * 19}, "a frame is"),
    "millimetres": (frame(positions=NEUTRAL * 50), "metres"),
    "a doll": (frame(positions=NEUTRAL * 0.05), "metres"),
    "all in one point": (frame(positions=np.ones((19, 3))), "metres"),
    "confidence short": (frame(confidence=[1.0] * 18), "18 confidences"),
    "confidence negative": (frame(confidence=[-0.1] * 19), "negative"),
    "confidence infinite": (frame(confidence=[math.inf] * 19), "not finite"),
    "confidence text": (frame(confidence="high"), "$.confidence"),
    "nested junk": ('{"t":' + "[" * 30_000 + "]" * 30_000 + "}", "a frame is"),
    "nested objects": ('{"a":' * 10_000 + "1" + "}" * 10_000, "a frame is"),
    "nested python": ({**frame(), "positions": nested(5_000)}, "a frame is"),
    "too long": (GOOD + " " * MAX_BYTES, f"at most {MAX_BYTES}"),
    "a megabyte": ("[" * 1_000_000, "1000000 bytes"),
    "keys that are no text": ({1: 2, None: 3}, "a frame is"),
}  # fmt: skip


@pytest.mark.parametrize("what", sorted(HOSTILE))
def test_a_frame_that_does_not_fit_is_refused_counted_and_harms_nothing(gate, clock, what):
    raw, message = HOSTILE[what]
    gate.check(frame(-0.1))
    clock.now += 0.1
    with pytest.raises(FrameRejected) as e:
        gate.check(raw)
    assert message in str(e.value)
    assert len(str(e.value)) < 400
    assert "\n" not in str(e.value)
    assert isinstance(e.value, StudioError)
    assert (gate.accepted, gate.rejected) == (1, 1)
    clock.now += 0.1
    assert gate.check(frame(0.1)).t == 0.1  # the next good one passes


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.sampled_from(["t", "skeleton", "positions", "confidence", "x"]), inner)
    ),
    max_leaves=12,
)
number = st.floats() | st.integers(-(10**30), 10**30)


@st.composite
def nearly(draw) -> dict:
    """A good frame with a few of its numbers replaced and maybe a field spoilt."""
    out = frame(draw(number), NEUTRAL, confidence=[1.0] * 19)
    for _ in range(draw(st.integers(0, 3))):
        out["positions"][draw(st.integers(0, 18))][draw(st.integers(0, 2))] = draw(number)
        out["confidence"][draw(st.integers(0, 18))] = draw(number)
    for key in draw(st.sets(st.sampled_from(sorted(out)), max_size=1)):
        out[key] = draw(json_values)
    return out


@settings(max_examples=120, deadline=None)
@given(st.lists(json_values | nearly() | st.text() | st.binary(), max_size=4), st.booleans())
@example([frame(1e-320)], True)
def test_whatever_comes_in_a_pose_or_a_rejection_comes_out(raws, as_text):
    gate = FrameGate(live=False)
    for raw in raws:
        if as_text and not isinstance(raw, (str, bytes)):
            raw = json.dumps(raw)
        try:
            pose = gate.check(raw)
        except FrameRejected:
            continue
        assert np.isfinite(pose.joint_pos_w).all()
        assert ((pose.confidence >= 0) & (pose.confidence <= 1)).all()
    assert gate.accepted + gate.rejected == len(raws)


@settings(max_examples=200, deadline=None)
@given(st.integers(0, len(GOOD)), st.integers(0, 30), st.binary(max_size=10))
def test_a_damaged_frame_is_a_pose_or_a_rejection(at, cut, junk):
    data = GOOD.encode()
    gate = FrameGate(live=False)
    try:
        pose = gate.check(data[:at] + junk + data[at + cut :])
    except FrameRejected:
        return
    assert np.isfinite(pose.joint_pos_w).all()


def some_frame(rng: np.random.Generator, t: float) -> bytes:
    """A frame of somebody: one in two whole, the others with numbers, fields or bytes spoilt."""
    moved = NEUTRAL + 0.02 * rng.standard_normal(NEUTRAL.shape)
    said = frame(round(t, 4), moved.round(4), confidence=[1.0] * 19)
    kind = rng.integers(8)
    if kind == 4:
        for _ in range(rng.integers(1, 4)):
            value = WILD[rng.integers(len(WILD))]
            said["positions"][rng.integers(19)][rng.integers(3)] = value
    elif kind == 5:
        said[("t", "skeleton", "positions", "confidence")[rng.integers(4)]] = WILD[
            rng.integers(len(WILD))
        ]
    raw = bytearray(json.dumps(said).encode())
    if kind == 6:
        for _ in range(rng.integers(1, 5)):
            raw[rng.integers(len(raw))] = rng.integers(256)
    elif kind == 7:
        at = rng.integers(len(raw))
        raw[at : at + rng.integers(64)] = rng.bytes(int(rng.integers(8)))
    return bytes(raw)


WILD = (math.nan, math.inf, -math.inf, 1e308, -1e5, 1e-320, 7, None, "x", [], {}, [[0.0]], True)


@pytest.mark.parametrize(
    "count", [3_000, pytest.param(100_000, marks=pytest.mark.slow)], ids=["some", "many"]
)
def test_of_any_number_of_frames_only_people_come_through(gate, clock, count):
    rng, last = np.random.default_rng(2), None
    for k in range(count):
        clock.now += 1.0 / 60
        try:
            pose = gate.check(some_frame(rng, k / 60))
        except FrameRejected:
            continue
        seen = pose.confidence > 0.0
        assert np.isfinite(pose.joint_pos_w).all()
        assert ((pose.confidence >= 0.0) & (pose.confidence <= 1.0)).all()
        if last is not None and clock.now - last[0] < 0.1:
            both = seen & (last[1].confidence > 0.0)
            step = np.linalg.norm(pose.joint_pos_w - last[1].joint_pos_w, axis=1)[both]
            assert step.max(initial=0.0) <= 20.0 * max(pose.t - last[1].t, 1 / 30) + 1e-6
        last = clock.now, pose
    assert gate.accepted + gate.rejected == count
    assert 0.4 * count < gate.accepted < 0.9 * count


def test_time_runs_forward_only(gate, clock):
    gate.check(frame(5.0))
    for t in (5.0, 4.9, -100.0):
        clock.now += 0.03
        with pytest.raises(FrameRejected, match="time runs forward"):
            gate.check(frame(t))
    clock.now += 0.03
    gate.check(frame(5.1))


def test_time_may_not_run_ahead_of_the_clock(gate, clock):
    gate.check(frame(0.0))
    clock.now += 0.03
    with pytest.raises(FrameRejected, match="ahead"):
        gate.check(frame(1e6))
    clock.now += 0.03
    gate.check(frame(0.06))


def test_a_file_may_pause_for_as_long_as_it_likes():
    gate = FrameGate(live=False)
    gate.check(frame(0.0))
    assert gate.check(frame(3600.0)).t == 3600.0


def test_a_frame_that_was_long_on_its_way_is_refused(gate, clock):
    for k in range(30):
        gate.check(frame(k / 30))
        clock.now += 1 / 30
    clock.now += 1.5
    with pytest.raises(FrameRejected, match="late"):
        gate.check(frame(1.0))
    gate.check(frame(2.4))  # a fresh one is welcome


@pytest.mark.parametrize("pace", [0.02, 0.05, 0.1, 0.3])
def test_a_sender_whose_time_runs_slow_or_fast_is_no_late_one(gate, clock, pace):
    for k in range(200):
        gate.check(frame(k / 30))
        clock.now += pace


def test_of_a_backlog_only_the_frames_of_the_last_second_are_taken(gate, clock):
    for k in range(30):
        gate.check(frame(k / 30))
        clock.now += 1 / 30
    clock.now += 2.5  # the network stood still; now 75 frames come at once
    taken = []
    for k in range(30, 105):
        clock.now += 0.009  # as fast as the rate cap lets them
        with contextlib.suppress(FrameRejected):
            taken.append(gate.check(frame(k / 30)).t)
    # frame k comes at 3.5 + .009 (k - 29) s; at most 1 + .3 s late (the leak) from k = 80 on
    assert taken[0] == pytest.approx(80 / 30)
    assert taken[-1] == pytest.approx(104 / 30)


def test_a_sender_whose_clock_paused_is_taken_again(gate, clock):
    gate.check(frame(1000.0))
    clock.now += 4.9
    with pytest.raises(FrameRejected):
        gate.check(frame(3.0))
    clock.now += 0.2
    assert gate.check(frame(3.0)).t == 3.0  # nothing good for five seconds: begun anew
    clock.now += 60.0
    assert gate.check(frame(3.03)).t == 3.03


def test_a_huge_jump_is_refused_and_a_person_elsewhere_is_taken_after_a_while(gate, clock):
    gate.check(frame(0.0))
    clock.now += 1 / 30
    with pytest.raises(FrameRejected, match="jumps at 150 m/s"):
        gate.check(frame(1 / 30, NEUTRAL + [5.0, 0.0, 0.0]))
    clock.now += 0.5
    gate.check(frame(0.5, NEUTRAL + [5.0, 0.0, 0.0]))  # 10 m/s


def test_a_jump_of_a_joint_that_is_not_seen_is_no_jump(gate, clock):
    gate.check(frame(0.0))
    clock.now += 1 / 30
    confidence = [1.0] * 19
    confidence[INDEX["l_wrist"]] = 0.0
    gate.check(frame(1 / 30, spoilt(INDEX["l_wrist"], 0, 50.0), confidence=confidence))


def test_jitter_at_a_high_rate_is_no_jump(gate, clock):
    rng = np.random.default_rng(0)
    for k in range(100):
        gate.check(frame(k / 100, NEUTRAL + rng.normal(scale=0.03, size=(19, 3))))
        clock.now += 0.01


def test_the_skeleton_may_not_change_within_a_stream(gate, clock):
    gate.check(frame(0.0))
    source = SKELETONS["k4abt"]
    positions = np.linalg.pinv(source.weights) @ NEUTRAL @ source.axes
    k4abt = {"t": 1.0, "skeleton": "k4abt", "positions": positions.tolist()}
    with pytest.raises(FrameRejected, match="changed from studio to k4abt: open a new connection"):
        gate.check(k4abt)
    gate.reset()
    assert gate.check(k4abt).t == 1.0
    assert gate.rejected == 1


def test_a_flood_of_a_thousand_frames_a_second_is_capped_and_counted(gate, clock):
    for k in range(3000):
        clock.now += 0.001
        with contextlib.suppress(FrameRejected):
            gate.check(frame(k / 1000))
    assert gate.accepted == pytest.approx(BURST + 3.0 * MAX_RATE, abs=2)
    assert gate.rejected == 3000 - gate.accepted
    clock.now += 1.0
    gate.check(frame(4.0))


def test_a_new_sender_does_not_refill_the_rate_cap(gate):
    for k in range(int(BURST)):
        gate.check(frame(k / 1000))
    gate.reset()
    with pytest.raises(FrameRejected, match="frames a second"):
        gate.check(frame(1.0))


def test_a_pose_made_inside_passes_the_same_checks(gate, clock):
    def pose(t: float, joints=NEUTRAL, confidence=None) -> HumanPose:
        confidence = np.ones(19) if confidence is None else confidence
        return HumanPose(t=t, joint_pos_w=joints, confidence=confidence)

    first = pose(0.0)
    assert gate.check_pose(first) is first
    nan = NEUTRAL.copy()
    nan[4, 1] = math.nan
    bad = {
        "not finite": pose(0.1, nan),
        "negative": pose(0.1, confidence=-np.ones(19)),
        "no time": pose(math.nan),
        "forward": pose(0.0),
        "jumps": pose(0.01, NEUTRAL + 5.0),
        "metres": pose(0.1, NEUTRAL * 0.01),
        "HumanPose is needed": {"t": 0.1},
    }
    for message, given_pose in bad.items():
        with pytest.raises(FrameRejected, match=message):
            gate.check_pose(given_pose)  # type: ignore[arg-type]
    assert (gate.accepted, gate.rejected) == (1, len(bad))
