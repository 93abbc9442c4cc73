"""Nonsense on a socket is answered, and closes nothing; a stop is a stop whatever else it says."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.errors import StudioError
from studio.web.page_messages import MAX_MESSAGE, Beat, StopSaid, page_message

DIGITS = "9" * 400
NONSENSE = [
    "", "{", "[]", "null", "7", "NaN", '"beat"', '{"type": 7}', '{"type": "fly"}', "{}",
    '{"type": "beat", "keys": 3}', '{"type": "beat", "keys": [1]}',
    '{"type": "beat", "keys": null}',
    '{"type": "beat", "sent": NaN}', '{"type": "beat", "sent": Infinity}',
    '{"type": "beat", "sent": 1e400}', f'{{"type": "beat", "sent": {DIGITS}}}',
    '{"type": "beat", "sent": true}', '{"type": "beat", "sent": "1"}',
    f'{{"type": "beat", "round_trip_ms": {DIGITS}}}', '{"type": "beat", "round_trip_ms": true}',
    '{"type": "beat", "round_trip_ms": -1}', '{"type": "beat", "visible": 1}',
    '{"type": "beat", "keys": ["\\ud800"]}', '{"type": "\\ud800"}',
    '{"type": "stop", "number": NaN}',
    '{"type": "stop", "number": "\\udc00"}', '{"\\ud800": 1}', "[" * 2000, '{"type": "beat"}]',
    " " * (MAX_MESSAGE + 1), '{"type": "beat", "type": "x"}', "\x00", '{"type": "be\x00at"}',
]  # fmt: skip
RAW = [b"\xff", b'{"type": "beat", "keys": ["\xed\xa0\x80"]}', b"\xf0\x28\x8c\x28", b"\x00" * 4000]
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(st.characters()),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(st.characters()), inner),
    max_leaves=8,
)
KEYS = st.sampled_from(("type", "keys", "visible", "sent", "round_trip_ms", "number"))
SAID = st.one_of(
    st.binary(max_size=200),
    st.text(st.characters(), max_size=200),
    JSON.map(json.dumps),
    st.dictionaries(KEYS, JSON | st.sampled_from(("beat", "stop"))).map(json.dumps),
)


@given(said=SAID)
def test_a_message_is_understood_or_refused_and_never_fatal(said):
    try:
        message = page_message(said)
    except StudioError:
        return
    assert isinstance(message, Beat | StopSaid)
    if isinstance(message, Beat):
        json.dumps([message.sent, message.round_trip_ms], allow_nan=False)
        assert type(message.sent) in (float, type(None))
        assert type(message.visible) is bool
    else:
        assert type(message.told) in (int, type(None))


@pytest.mark.parametrize("said", [*NONSENSE, *RAW], ids=lambda said: ascii(said)[:40])
def test_nonsense_is_refused(said):
    with pytest.raises(StudioError):
        page_message(said)


@pytest.mark.parametrize(
    ("number", "told"),
    [
        ("7", 7),
        ("true", None),
        ("7.0", None),
        (DIGITS, None),
        ('"7"', None),
        ("[{}]", None),
        ("1e400", None),
    ],
)
def test_a_stop_is_a_stop_and_only_a_number_is_told_back(number, told):
    message = page_message(f'{{"type": "stop", "number": {number}, "more": {DIGITS}}}')
    assert isinstance(message, StopSaid)
    assert message.told == told


@pytest.mark.parametrize("path", ["/api/control", "/api/human"])
def test_a_socket_outlives_all_nonsense_and_answers_each(studio_live, path):
    said = [*(text for text in NONSENSE if text.isprintable()), *RAW]
    if path == "/api/human":  # of a frame, too
        studio_live.client.post("/api/source", json={"source": "stream"})
        frame = '{"t": %s, "skeleton": %s, "positions": %s}'
        said += [
            frame % (DIGITS, '"studio"', "[]"),
            frame % ("true", '"\\ud800"', "[[0, 0, 0]]"),
            frame % ("0", '"\\ud800"', "[[NaN, 0, 0]]"),
            frame % ("0", '"studio"', f"[[{DIGITS}, 0, 0]]"),
            frame % ("0", '"' + "x" * 5000 + '"', '"\\udfff"'),
        ]
    with studio_live.ws(path) as ws:
        for message in said:
            ws.send(message)
        answers = []
        while len(answers) < len(said):
            answer = json.loads(ws.recv(timeout=60), parse_constant=pytest.fail)
            if "error" in answer:
                answers.append(answer["error"])
        assert all(answers)
        if path == "/api/control":
            ws.send(b'{"type": "stop", "number": 3}')  # binary counts
            while True:
                answer = json.loads(ws.recv(timeout=60))
                if answer["type"] == "stopped":
                    break
            assert (answer["number"], answer["ok"]) == (3, True)
