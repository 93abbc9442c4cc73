"""Getting in: a token that is kept, a page to sign in on, other programs' cookies, other names."""

import logging
import os
import shutil
import ssl
import stat
import subprocess
import threading
import time

import httpx
import pytest
from tls import tls_socket

from studio.client import Studio
from studio.errors import StudioError
from studio.options import ServeConfig
from studio.web.access import AccessConfig, host_allowed, origin_allowed, page_url
from studio.web.hosts import checked_names
from studio.web.serve import checked_tls, exposure, studio
from studio.web.tokens import FILE, kept_token

TOKEN = "test-token-0123456789"
HTML = {"Accept": "text/html,application/xhtml+xml"}


# The token ----------------------------------------------------------------------------------------


def test_a_folder_of_takes_keeps_its_token_which_nobody_else_may_read(tmp_path):
    token = kept_token(tmp_path / "new" / "sessions")
    file = tmp_path / "new" / "sessions" / FILE
    assert len(token) >= 32
    assert file.read_text() == token
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert kept_token(tmp_path / "new" / "sessions") == token
    assert kept_token(tmp_path / "other") != token
    assert [path.name for path in file.parent.iterdir()] == [FILE]


@pytest.mark.parametrize(
    "damage",
    [
        lambda file: file.chmod(0o644),
        lambda file: file.write_text("short"),
        lambda file: file.write_text("x" * 32 + "\r\nSet-Cookie: a=b"),
        lambda file: file.write_bytes(b"\xff" * 40),
        lambda file: (file.rename(file.with_name("real")), file.symlink_to(file.with_name("real"))),
    ],
)
def test_a_token_that_others_could_know_or_that_is_none_is_made_anew(tmp_path, damage):
    before = kept_token(tmp_path)
    damage(tmp_path / FILE)
    token = kept_token(tmp_path)
    assert token != before
    assert kept_token(tmp_path) == token
    assert stat.S_IMODE((tmp_path / FILE).lstat().st_mode) == 0o600


def test_where_nothing_can_be_written_the_token_is_for_one_run_and_that_is_said(tmp_path, caplog):
    (tmp_path / "file").touch()
    assert len(kept_token(tmp_path / "file" / "sessions")) >= 32
    assert "this run only" in caplog.text


# Cookies and the page to sign in on ---------------------------------------------------------------


@pytest.mark.parametrize(
    "others",
    [
        'a={"json": true, "b": [1, 2]}',
        "bad name=1",
        "x[y]=1; ;; =empty",
        'quoted="unclosed',
        "a,b@c=d; expires=never",
        "größe=1",
    ],
)
@pytest.mark.parametrize("first", [True, False])
def test_odd_cookies_of_other_programs_lock_nobody_out(studio_at, others, first):
    ours = f"a1_studio_{studio_at.port}={TOKEN}"
    cookie = f"{ours}; {others}" if first else f"{others}; {ours}"
    with httpx.Client(base_url=studio_at.base, trust_env=False) as browser:
        headers = [(b"Cookie", cookie.encode("latin-1"))]
        assert browser.get("/api/state", headers=headers).status_code == 200
        worse = [(b"Cookie", cookie.replace(TOKEN, TOKEN + "x").encode("latin-1"))]
        assert browser.get("/api/state", headers=worse).status_code == 401


def test_whoever_opens_the_page_without_the_token_can_sign_in(studio_at):
    with httpx.Client(base_url=studio_at.base, trust_env=False, headers=HTML) as browser:
        asked = browser.get("/")
        assert asked.status_code == 401
        assert asked.headers["content-type"].startswith("text/html")
        assert 'name="token"' in asked.text
        assert "is not the one" not in asked.text
        policy = asked.headers["content-security-policy"]
        assert "script-src" not in policy
        assert "default-src 'none'" in policy
        wrong = browser.get("/", params={"token": "<b>wrong</b>"})
        assert wrong.status_code == 401
        assert "is not the one" in wrong.text
        assert "<b>wrong" not in wrong.text
        right = browser.get("/", params={"token": f" {TOKEN} "})  # as the form sends it
        assert right.status_code == 303
        assert browser.get(right.headers["location"]).status_code == 200


def test_programs_and_parts_of_the_page_get_json_instead(studio_at):
    with httpx.Client(base_url=studio_at.base, trust_env=False) as stranger:
        for path, headers in (("/", {}), ("/view/", HTML), ("/api/state", HTML)):
            answer = stranger.get(path, headers=headers)
            assert answer.status_code == 401
            assert "token" in answer.json()["error"]


# Other names, other networks ----------------------------------------------------------------------


def test_a_name_that_was_allowed_is_served_and_no_other():
    names = checked_names(["studio.example.org", "192.168.1.20", "fe80::1", "[fe80::2]"])
    config = AccessConfig(token=TOKEN, host="0.0.0.0", port=8080, names=names)
    for host in ("studio.example.org", "STUDIO.example.org:8080", "192.168.1.20:8080",
                 "[fe80::1]:8080", "[fe80::2]", "localhost:8080"):  # fmt: skip
        assert host_allowed([host], config), host
    for host in ("example.org", "studio.example.org.evil.org", "192.168.1.21:8080", "[fe80::3]"):
        assert not host_allowed([host], config), host
    assert page_url(config) == f"http://studio.example.org:8080/?token={TOKEN}"
    # Behind a proxy that speaks TLS on the usual port and passes the Host on.
    assert origin_allowed(["https://studio.example.org"], "studio.example.org", config)
    assert not origin_allowed(["https://evil.org"], "studio.example.org", config)


@pytest.mark.parametrize(
    "name",
    ["http://x.org", "x.org:80", "x.org/", "*.x.org", "", "a b", "x..org", "[x]", "[fe80::1]:80"],
)
def test_what_is_no_bare_name_is_refused(name):
    with pytest.raises(StudioError, match="bare name"):
        checked_names([name])


def test_listening_beyond_this_machine_says_what_is_exposed_and_to_whom():
    config = AccessConfig(token=TOKEN, host="0.0.0.0", port=8080)
    said = exposure(config)
    for word in ("every network", "NOT encrypted", "--cert", "--allow-host", "deletes takes"):
        assert word in said
    named = AccessConfig(token=TOKEN, host="::", port=8080, names=("x.org",), secure=True)
    assert "NOT encrypted" not in exposure(named)
    assert "x.org" in exposure(named)


@pytest.fixture(scope="module")
def certificate(tmp_path_factory):
    """A certificate for localhost and its key, of today."""
    if shutil.which("openssl") is None:
        pytest.skip("no openssl to make a certificate with")
    folder = tmp_path_factory.mktemp("tls")
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2",
         "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost",
         "-keyout", "key.pem", "-out", "cert.pem"],
        cwd=folder, check=True, capture_output=True,
    )  # fmt: skip
    return folder


@pytest.mark.parametrize(
    ("cert", "key", "says"),
    [
        ("cert.pem", None, "together"),
        (None, "key.pem", "together"),
        ("cert.pem", "missing.pem", "missing.pem"),
        ("key.pem", "cert.pem", "PEM"),
    ],
)
def test_a_certificate_that_cannot_be_used_is_an_error_that_says_why(certificate, cert, key, says):
    path = lambda name: None if name is None else certificate / name  # noqa: E731
    with pytest.raises(StudioError, match=says):
        checked_tls(ServeConfig(cert=path(cert), key=path(key)))


def test_https_and_its_sockets_are_served_with_a_certificate(certificate, tmp_path, caplog):
    config = ServeConfig(
        source="operator:quiet",
        port=0,
        token=TOKEN,
        sessions=tmp_path / "sessions",
        cert=certificate / "cert.pem",
        key=certificate / "key.pem",
        allow_host=("localhost",),
        host="0.0.0.0",
    )
    trust = ssl.create_default_context(cafile=certificate / "cert.pem")
    with caplog.at_level(logging.WARNING), studio(config) as (server, listener, url):
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        port = listener.getsockname()[1]
        assert url == f"https://localhost:{port}/?token={TOKEN}"
        with httpx.Client(verify=trust, trust_env=False, timeout=30.0) as browser:
            while not server.started:
                time.sleep(0.05)
            arrived = browser.get(url)
            assert arrived.status_code == 303
            assert "; Secure" in arrived.headers["set-cookie"]
            assert browser.get(f"https://localhost:{port}/").status_code == 200
        authorised = {"Authorization": f"Bearer {TOKEN}"}
        with tls_socket(f"wss://localhost:{port}/api/control", authorised, trust) as ws:
            ws.send(b'{"type": "stop", "number": 3}')
            while '"stopped"' not in (said := str(ws.recv(20.0))) or '"number"' not in said:
                pass
        # Often: with a thread that reads and another that writes, one in 60 was never answered.
        for _ in range(250):
            with Studio(url, timeout=10.0, tls=trust).ticks() as ticks:
                ticks.next(10.0)
        server.should_exit = True
        thread.join(20.0)
    assert "every network" in caplog.text


def test_a_new_start_finds_the_token_and_leaves_nothing_behind(tmp_path):
    config = ServeConfig(source="operator:quiet", port=0, sessions=tmp_path / "sessions")
    with studio(config) as (_, _, first):
        pass
    with studio(config) as (_, _, second):
        pass
    assert first.partition("token=")[2] == second.partition("token=")[2]
    assert os.listdir(tmp_path / "sessions") == [FILE]
