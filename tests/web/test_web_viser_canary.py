"""What we rely on in viser 1.1 beyond its public interface: one of these fails when it moves."""

import asyncio
import dataclasses
import re
import socket

import msgspec
import numpy as np
import pytest
import viser
from viser import _messages
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from studio.web.guarded_viser import (
    SECRET_HEADER,
    GuardedViser,
    client_html,
    client_message_allowed,
)
from studio.web.scene_batch import Batch
from studio.web.shapes import ball_mesh


@pytest.fixture(scope="module")
def inner():
    """A guarded viser."""
    inner = GuardedViser()
    yield inner
    inner.stop()


def camera(**changes):
    """The one message a browser may send."""
    return {
        "type": "ViewerCameraMessage", "wxyz": [1.0, 0, 0, 0], "position": [1.0, 2, 3],
        "fov": 0.5, "near": 0.01, "far": 100.0, "image_height": 400, "image_width": 600,
        "look_at": [0.0, 0, 0], "up_direction": [0.0, 0, 1], **changes,
    }  # fmt: skip


def test_the_version_is_the_one_that_was_read():
    assert viser.__version__.startswith("1.1.")


def test_the_inner_server_listens_on_loopback_only(inner):
    assert inner.port > 0
    with socket.create_connection(("127.0.0.1", inner.port), timeout=2):
        pass
    sockets = inner.server._websock_server
    assert sockets._host == "127.0.0.1"


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {SECRET_HEADER: "guess"},
        {SECRET_HEADER: "SECRET", "Origin": "http://127.0.0.1"},
        {SECRET_HEADER: "SECRET", "Host": "evil.example"},
    ],
)
def test_nobody_but_the_relay_may_connect(inner, headers):
    headers = {key: inner.secret if v == "SECRET" else v for key, v in headers.items()}
    host = headers.pop("Host", None)

    async def attempt():
        async with connect(
            f"ws://127.0.0.1:{inner.port}",
            additional_headers=headers | ({"Host": host} if host else {}),
            subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item]
            proxy=None,
        ):
            pass

    with pytest.raises(InvalidStatus) as refused:
        asyncio.run(attempt())
    assert refused.value.response.status_code == 403


def test_a_secret_of_odd_bytes_is_refused_like_any_other(inner):
    with socket.create_connection(("127.0.0.1", inner.port), timeout=5) as raw:
        raw.sendall(
            f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{inner.port}\r\nUpgrade: websocket\r\n"
            "Connection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
            f"Sec-WebSocket-Version: 13\r\n{SECRET_HEADER}: ".encode()
            + b"\xe9\xff\r\n\r\n"
        )
        assert raw.recv(4096).startswith(b"HTTP/1.1 403")


def test_the_relay_may_connect_and_is_given_the_scene(inner):
    async def attempt():
        async with connect(
            f"ws://127.0.0.1:{inner.port}",
            additional_headers={SECRET_HEADER: inner.secret},
            subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item]
            proxy=None,
        ) as ws:
            return await asyncio.wait_for(ws.recv(), 5.0)

    assert len(asyncio.run(attempt())) > 100


def test_no_page_can_open_a_tunnel_to_the_outside(inner):
    handlers = inner.server._websock_server._incoming_handlers
    assert _messages.ShareUrlRequest not in handlers
    assert _messages.ShareUrlDisconnect not in handlers
    assert _messages.GuiUpdateMessage in handlers  # the table is still the one that is read


def test_a_camera_passes_and_nothing_else_does():
    encode = msgspec.msgpack.encode
    assert client_message_allowed(encode(camera()))
    assert not client_message_allowed(encode(camera(fov=float("nan"))))
    assert not client_message_allowed(encode(camera(position=[1.0, 2.0])))
    assert not client_message_allowed(encode(camera(wxyz=["1", 0, 0, 0])))
    assert not client_message_allowed(encode({**camera(), "callbacks": []}))
    assert not client_message_allowed(encode({**camera(), "note": "x" * 20_000}))
    for name in ("GuiUpdateMessage", "ShareUrlRequest", "RunJavascriptMessage", "GuiButtonHold"):
        assert not client_message_allowed(encode({"type": name, "uuid": "x", "updates": {}}))
    for raw in (b"", b"\xc1", b"\x93" * 4000, b"\x81", encode([1]), encode({"type": None})):
        assert not client_message_allowed(raw)


def test_the_cameras_fields_are_those_viser_reads():
    fields = {f.name for f in dataclasses.fields(_messages.ViewerCameraMessage)}
    assert fields - {"excluded_self_client"} == set(camera()) - {"type"}


def test_one_message_moves_a_batch_and_late_pages_get_the_newest(inner):
    buffer = inner.server._websock_server._broadcast_buffer
    batch = Batch(inner.server.scene, "/canary", ball_mesh(), 2, (255, 0, 0), scaled=True)
    before = buffer.message_counter
    for k in range(3):
        batch.move(np.full((2, 3), float(k)), np.tile([1.0, 0, 0, 0], (2, 1)), np.ones((2, 3)))
    assert buffer.message_counter == before + 3
    kept = [
        m
        for m in buffer.message_from_id.values()
        if isinstance(m, _messages.SceneNodeUpdateMessage) and m.name == "/canary"
    ]
    assert len(kept) == 1
    assert kept[0].updates["batched_positions"][0, 0] == 2.0
    assert set(kept[0].updates) <= {
        f.name for f in dataclasses.fields(_messages.BatchedMeshesProps)
    }


def test_the_client_is_one_file_that_starts_with_a_script_and_no_request():
    html = client_html()
    assert "<script" in html
    body = re.sub(r'data-p="[^"]*"', "", html)
    assert 'src="' not in re.sub(r'href="data:[^"]*"', "", body)
