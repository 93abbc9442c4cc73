"""A phone as the camera: invited once, over TLS, with less than the token's rights, sent away."""

import json
import os
import socket as sockets
import ssl
import stat
import threading
import time
from types import SimpleNamespace

import httpx
import numpy as np
import pytest
from conftest import PATIENCE, TOKEN
from cryptography import x509
from tls import tls_socket
from websockets.exceptions import ConnectionClosed, InvalidStatus

from studio.errors import StudioError
from studio.options import ServeConfig
from studio.web import phone_certificate
from studio.web.phone import INVITED_S, MOST, Phones, may
from studio.web.phone_certificate import FILE, address_for, certificate
from studio.web.second_server import FewAtOnce
from studio.web.serve import studio

PIXEL = "Mozilla/5.0 (Linux; Android 16; Pixel 9) Chrome/140"
HTML = {"Accept": "text/html", "User-Agent": PIXEL}


@pytest.fixture(scope="module")
def invited(tmp_path_factory):
    """A studio with a door for phones, on loopback; the certificate it made is trusted here."""
    config = ServeConfig(
        source="operator:quiet", port=0, token=TOKEN, phone="127.0.0.1", phone_port=0,
        sessions=tmp_path_factory.mktemp("sessions"),
    )  # fmt: skip
    with studio(config) as (server, listener, url):
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        deadline = time.monotonic() + PATIENCE
        while not server.started:
            assert time.monotonic() < deadline
            time.sleep(0.02)
        trust = ssl.create_default_context(cafile=str(config.sessions / FILE))
        headers = {"Authorization": f"Bearer {TOKEN}"}
        base = url.partition("/?")[0]
        with httpx.Client(base_url=base, headers=headers, trust_env=False) as client:
            yield SimpleNamespace(client=client, trust=trust, sessions=config.sessions)
        server.should_exit = True
        thread.join(timeout=10.0)
        assert not thread.is_alive()


@pytest.fixture
def phone(invited):
    """The browser of a phone that has just scanned the code."""
    for one in invited.client.get("/api/phone").json()["phones"]:
        invited.client.post("/api/phone", json={"action": "send_away", "name": one["name"]})
    url = invited.client.get("/api/phone").json()["url"]
    base = url.partition("/camera")[0]
    with httpx.Client(base_url=base, headers=HTML, verify=invited.trust, trust_env=False) as phone:
        phone.follow_redirects = True
        page = phone.get(url)
        assert page.status_code == 200, page.text
        assert page.url.path == "/camera"
        assert not page.url.query
        yield phone


def socket(invited, phone, path: str):
    cookies = "; ".join(f"{name}={value}" for name, value in phone.cookies.items())
    url = f"wss://{phone.base_url.host}:{phone.base_url.port}{path}"
    return tls_socket(url, {"Cookie": cookies}, invited.trust)


def test_an_invitation_is_good_once(invited, phone):
    used = invited.client.get("/api/phone").json()["url"]
    with httpx.Client(headers=HTML, verify=invited.trust, trust_env=False) as another:
        assert another.get(used).status_code == 303
        another.cookies.clear()
        again = another.get(used)
        assert again.status_code == 401
        assert "take a new code" in again.text
    assert invited.client.get("/api/phone").json()["url"] != used
    assert phone.get("/camera").status_code == 200  # who came before stays


def test_a_phone_has_the_camera_and_the_stop_and_nothing_else(invited, phone):
    assert phone.get("/assets/js/webcam.js").status_code == 200
    assert phone.get("/api/state").json()["source"]
    assert phone.post("/api/stop").json()["stopped"] is True
    assert phone.post("/api/reset").status_code == 200
    for method, path in (
        ("GET", "/"), ("GET", "/api/takes"), ("GET", "/api/phone"), ("POST", "/api/phone"),
        ("POST", "/api/takes/start"), ("POST", "/api/train"), ("GET", "/view/"),
        ("GET", "/api/ticks"), ("POST", "/camera"), ("GET", "/assets/../api/takes"),
        ("DELETE", "/api/takes/x"), ("POST", "/assets/js/webcam.js"),
    ):  # fmt: skip
        answer = phone.request(method, path)
        assert answer.status_code == 403, (method, path, answer.text)
    for path in ("/api/ticks", "/api/control", "/view/"):
        with pytest.raises(InvalidStatus) as refused, socket(invited, phone, path):
            pass
        assert refused.value.response.status_code == 403, path


def test_a_phone_chooses_no_source_but_itself_and_no_mode_but_live_and_idle(invited, phone):
    for path, body in (
        ("/api/source", {"source": "take:x"}), ("/api/source", {"source": "vmc:0.0.0.0:0"}),
        ("/api/source", {"source": "frames:/etc/passwd"}), ("/api/mode", {"mode": "replay"}),
        ("/api/mode", {"mode": "collect"}), ("/api/source", {"source": "webcam", "source2": "x"}),
        ("/api/source", ["webcam"]), ("/api/source", None),
    ):  # fmt: skip
        assert phone.post(path, json=body).status_code == 403, body
    assert (
        phone.post("/api/source", content=b'{"source":"webcam","source":"take:x"}').status_code
        == 403
    )
    assert phone.post("/api/stop", content=b"x" * 5000).status_code == 403
    assert phone.post("/api/source", json={"source": "webcam"}).status_code == 200
    assert phone.post("/api/mode", json={"mode": "idle"}).status_code == 200
    invited.client.post("/api/source", json={"source": "operator:quiet"})


def test_who_is_sent_away_while_asking_is_not_answered(invited, phone):
    host, port = phone.base_url.host, phone.base_url.port
    cookies = "; ".join(f"{name}={value}" for name, value in phone.cookies.items())
    head = (
        f"POST /api/mode HTTP/1.1\r\nHost: {host}:{port}\r\nCookie: {cookies}\r\n"
        "Content-Type: application/json\r\nContent-Length: 15\r\n\r\n"
    )
    with (
        sockets.create_connection((host, port), timeout=PATIENCE) as plain,
        invited.trust.wrap_socket(plain, server_hostname=host) as tls,
    ):
        tls.sendall(head.encode() + b'{"mode"')
        time.sleep(0.2)
        for one in invited.client.get("/api/phone").json()["phones"]:
            invited.client.post("/api/phone", json={"action": "send_away", "name": one["name"]})
        tls.sendall(b':"live"}')
        assert b" 401 " in tls.recv(4096).partition(b"\r\n")[0]


def test_half_made_connections_leave_the_studio_its_descriptors(invited, phone):
    host, port = phone.base_url.host, phone.base_url.port
    before = len(os.listdir("/proc/self/fd"))
    silent = [sockets.create_connection((host, port), timeout=PATIENCE) for _ in range(200)]
    try:
        assert invited.client.post("/api/stop").status_code == 200
        # Both ends are this process's: what the studio keeps is what is beyond ours.
        kept = len(os.listdir("/proc/self/fd")) - before - len(silent)
        assert kept <= FewAtOnce.most_each
    finally:
        for one in silent:
            one.close()
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            assert phone.get("/camera").status_code == 200
            break
        except httpx.TransportError:  # until the studio has seen that they left
            assert time.monotonic() < deadline
            time.sleep(0.1)
    invited.client.post("/api/reset")


def test_without_an_invitation_there_is_no_way_in_and_the_token_is_none(invited, phone):
    with httpx.Client(base_url=phone.base_url, verify=invited.trust, trust_env=False) as stranger:
        assert stranger.get("/camera").status_code == 401
        assert stranger.get(f"/camera?token={TOKEN}").status_code == 401
        assert stranger.get("/camera?invite=guess").status_code == 401
        assert stranger.get("/camera?invite=a&invite=b").status_code == 401
        bearer = {"Authorization": f"Bearer {TOKEN}"}
        assert stranger.get("/api/state", headers=bearer).status_code == 401
        cookie = {"Cookie": next(f"{k}=x" for k in phone.cookies)}
        assert stranger.get("/api/state", headers=cookie).status_code == 401
        assert stranger.get("/camera", headers={"Host": "evil.example"}).status_code == 421
        evil = {"Origin": "https://evil.example"}
        assert stranger.get("/camera", headers=evil).status_code == 403
    # Nor does a phone's cookie open the studio's own door.
    value = next(iter(phone.cookies.values()))
    with httpx.Client(base_url=invited.client.base_url, trust_env=False) as thief:
        name = f"a1_studio_{invited.client.base_url.port}"
        assert thief.get("/api/takes", headers={"Cookie": f"{name}={value}"}).status_code == 401


def test_its_frames_drive_are_counted_and_end_when_it_is_sent_away(invited, phone):
    pose = np.random.default_rng(0).normal(size=(33, 3)).round(3).tolist()
    assert phone.post("/api/source", json={"source": "webcam"}).status_code == 200
    with socket(invited, phone, "/api/human") as ws:
        before = phone.get("/api/state").json()["counters"]["frames"]
        for k in range(30):
            frame = {"t": 10.0 + k / 30, "skeleton": "mediapipe", "positions": pose}
            ws.send(json.dumps({**frame, "confidence": [0.9] * 33}))
            time.sleep(0.01)
        (shown,) = invited.client.get("/api/phone").json()["phones"]
        assert shown["name"].startswith("Android")
        assert shown["frames_per_s"] > 0.0
        state = phone.get("/api/state").json()
        assert state["counters"]["frames"] > before
        left = invited.client.post(
            "/api/phone", json={"action": "send_away", "name": shown["name"]}
        ).json()
        assert left["phones"] == []
        with pytest.raises(ConnectionClosed):
            ws.recv(timeout=PATIENCE)
    assert phone.get("/api/state").status_code == 401
    gone = invited.client.post("/api/phone", json={"action": "send_away", "name": "Android 99"})
    assert gone.status_code == 409
    assert "Android 99" in gone.json()["why"]
    invited.client.post("/api/source", json={"source": "operator:quiet"})


def test_a_stop_over_tls_holds_against_a_release_before_it(invited, phone):
    assert phone.post("/api/reset").status_code == 200
    seen = phone.get("/api/state").json()["stops"]
    assert phone.post("/api/stop").json()["stopped"] is True
    late = phone.post("/api/reset", headers={"X-Studio-Stops": str(seen)})
    assert late.status_code == 409, late.text
    assert phone.post("/api/reset").status_code == 200


def test_a_studio_without_the_option_says_how_to_get_a_phone(studio_live):
    said = studio_live.client.get("/api/phone").json()
    assert said["on"] is False
    assert "--phone" in said["why"]
    assert studio_live.client.post("/api/phone", json={"action": "invite"}).status_code == 409
    bad = studio_live.client.post("/api/phone", json={"action": "dance"})
    assert bad.status_code == 422


# Without a server --------------------------------------------------------------------------------


def test_an_invitation_is_renewed_when_its_time_is_over_and_the_first_phone_makes_room():
    now = [0.0]
    phones = Phones("https://192.168.1.20:8443/", clock=lambda: now[0])
    first = phones.invitation
    now[0] = INVITED_S - 1.0
    assert phones.invitation == first
    token = first.partition("invite=")[2]
    now[0] = INVITED_S
    assert phones.accept(token, PIXEL) is None
    assert phones.invitation != first
    for _ in range(MOST + 2):
        assert phones.accept(phones.invitation.partition("invite=")[2], PIXEL) is not None
    assert [p.name for p in phones.phones] == [f"Android {k}" for k in range(3, MOST + 3)]
    assert phones.accept("\udcff", PIXEL) is None


def test_the_code_says_the_invitation():
    """Read back by a decoder of the picture's own modules would need a camera: the data is ours."""
    phones = Phones("https://192.168.1.20:8443/")
    state = phones.state()
    assert state["qr"].startswith("data:image/svg+xml")
    assert state["url"] == phones.invitation


@pytest.mark.parametrize("path", ["/api/human/", "/api/stop/../takes", "/assets", "//assets/x", ""])
def test_paths_that_only_look_allowed_are_not(path):
    assert not may("http", "GET", path)
    assert not may("http", "POST", path)


def test_a_certificate_is_kept_until_the_address_changes_or_others_could_read_it(tmp_path):
    file = certificate(tmp_path, "192.168.1.20")
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    made = file.read_bytes()
    assert certificate(tmp_path, "192.168.1.20").read_bytes() == made
    names = x509.load_pem_x509_certificate(made).extensions
    names = names.get_extension_for_class(x509.SubjectAlternativeName).value
    assert [str(a) for a in names.get_values_for_type(x509.IPAddress)] == ["192.168.1.20"]
    moved = certificate(tmp_path, "10.0.0.7").read_bytes()
    assert moved != made
    file.chmod(0o644)
    assert certificate(tmp_path, "10.0.0.7").read_bytes() != moved
    good = file.read_bytes()
    file.write_bytes(good[good.index(b"-----BEGIN CERT") :])  # without its key
    file.chmod(0o600)
    assert b"PRIVATE KEY" in certificate(tmp_path, "10.0.0.7").read_bytes()
    file.unlink()
    os.mkfifo(file, 0o600)
    assert b"PRIVATE KEY" in certificate(tmp_path, "10.0.0.7").read_bytes()
    file.write_bytes(b"\xff no certificate")
    file.chmod(0o600)
    assert b"BEGIN CERTIFICATE" in certificate(tmp_path, "::1").read_bytes()


def test_one_that_ends_within_a_day_is_made_anew(tmp_path, monkeypatch):
    monkeypatch.setattr(phone_certificate, "DAYS", 0.5)
    short = certificate(tmp_path, "10.0.0.7").read_bytes()
    assert certificate(tmp_path, "10.0.0.7").read_bytes() != short


@pytest.mark.parametrize(
    "said",
    [
        "0.0.0.0",
        "::",
        "0:0:0:0:0:0:0:0",
        "224.0.0.1",
        "255.255.255.255",
        "phone",
        "",
        "192.168.1.20:8443",
    ],
)
def test_an_address_that_no_phone_can_open_is_refused(said):
    with pytest.raises(StudioError, match=r"192\.168\.1\.20"):
        address_for(said)


def test_an_address_is_written_as_browsers_write_it():
    assert address_for("FE80:0:0:0:0:0:0:1") == "fe80::1"
    assert address_for("::ffff:192.168.1.20") == "192.168.1.20"
