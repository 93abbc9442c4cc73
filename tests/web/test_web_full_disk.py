"""A disk that is full is said, wherever it is met: 507 with why, and the studio goes on."""

import errno
import os

import pytest
from starlette import requests

from studio.web import files_api, import_api


def full(*_, **__):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


class FullForm:
    """What a form is read with, where its files do not fit into the temporary folder."""

    def __init__(self, *_, **__):
        pass

    async def parse(self):
        full()


def drop(client):
    return client.post("/api/files", params={"name": "a.bvh"}, content=b"HIERARCHY")


def send(client):
    return client.post("/api/takes/import", files={"files": ("a.bvh", b"HIERARCHY")})


@pytest.mark.parametrize(
    ("ask", "where", "what"),
    [
        (drop, files_api, "_store"),
        (send, import_api, "_store"),
        (send, requests, "MultiPartParser"),
    ],
    ids=["a dropped file", "an import", "its form"],
)
def test_a_full_disk_is_507_with_why(studio_live, monkeypatch, ask, where, what):
    with monkeypatch.context() as patched:
        patched.setattr(where, what, FullForm if what == "MultiPartParser" else full)
        answer = ask(studio_live.client)
    assert answer.status_code == 507, answer.text
    assert "No space left on device" in answer.json()["why"]
    assert ask(studio_live.client).status_code == 422  # it is read again, and is no BVH
