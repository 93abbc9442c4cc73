"""Nobody gets in by another name, from another page, or without the token."""

import httpx
import pytest
from websockets.exceptions import InvalidStatus

from studio.web.access import AccessConfig, host_allowed, origin_allowed, page_url
from studio.web.hosts import split_host

TOKEN = "test-token-0123456789"
LOCAL = AccessConfig(token=TOKEN, host="127.0.0.1", port=8080)

GOOD_HOSTS = ["127.0.0.1:{p}", "localhost:{p}", "LOCALHOST:{p}", "[::1]:{p}", "localhost"]
BAD_HOSTS = [
    "evil.example",
    "127.0.0.1.evil.example:{p}",
    "localhost.evil.example:{p}",
    "localhost.:{p}",
    "127.0.0.1:{p}.evil.example",
    "127.1:{p}",
    "127.0.0.2:{p}",
    "0.0.0.0:{p}",
    "2130706433:{p}",
    "evil@127.0.0.1:{p}",
    "127.0.0.1@evil.example",
    "[::1].evil.example:{p}",
    "[::2]:{p}",
    "localhost:{p}:80",
    "localhost:99999",
    "localhost:-1",
    "localhost/",
    "",
]
BAD_ORIGINS = [
    "null",
    "http://evil.example",
    "https://evil.example:{p}",
    "http://127.0.0.1.evil.example:{p}",
    "http://localhost.evil.example:{p}",
    "http://localhost:3000",
    "http://127.0.0.1",
    "file://",
    "chrome-extension://abcdef",
    "http://evil@127.0.0.1:{p}",
    "",
]


@pytest.mark.parametrize("host", GOOD_HOSTS)
def test_a_host_that_names_this_machine_is_served(studio_at, host):
    answer = studio_at.client.get("/api/state", headers={"Host": host.format(p=studio_at.port)})
    assert answer.status_code == 200


@pytest.mark.parametrize("host", BAD_HOSTS)
@pytest.mark.parametrize("path", ["/api/state", "/api/health", "/view/"])
def test_any_other_host_gets_421_whatever_the_token(studio_at, host, path):
    answer = studio_at.client.get(path, headers={"Host": host.format(p=studio_at.port)})
    assert answer.status_code in (421, 400) if host == "" else answer.status_code == 421


@pytest.mark.parametrize("origin", BAD_ORIGINS)
def test_a_foreign_origin_gets_403_by_http_and_by_socket(studio_at, origin):
    headers = {"Origin": origin.format(p=studio_at.port)}
    assert studio_at.client.get("/api/state", headers=headers).status_code == 403
    assert studio_at.client.post("/api/stop", headers=headers).status_code == 403
    headers["Authorization"] = f"Bearer {TOKEN}"
    for path in ("/api/human", "/api/ticks", "/api/control", "/view"):
        with pytest.raises(InvalidStatus) as refused:
            studio_at.ws(path, headers=headers)
        assert refused.value.response.status_code == 403
    assert studio_at.state()["stopped"] is False


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost"])
def test_our_own_origin_is_welcome_by_http_and_by_socket(studio_at, name):
    headers = {"Origin": f"http://{name}:{studio_at.port}"}
    assert studio_at.client.get("/api/state", headers=headers).status_code == 200
    headers["Authorization"] = f"Bearer {TOKEN}"
    with studio_at.ws("/api/ticks", headers=headers) as socket:
        assert socket.recv(timeout=5)


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example"])
def test_a_socket_to_another_host_gets_421(studio_at, host):
    import socket

    with socket.create_connection(("127.0.0.1", studio_at.port), timeout=5) as raw:
        raw.sendall(
            f"GET /api/ticks HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\n"
            "Connection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
            f"Sec-WebSocket-Version: 13\r\nAuthorization: Bearer {TOKEN}\r\n\r\n".encode()
        )
        assert raw.recv(4096).startswith(b"HTTP/1.1 421")


def test_two_hosts_in_one_request_are_refused():
    assert not host_allowed(["127.0.0.1:8080", "127.0.0.1:8080"], LOCAL)
    assert not host_allowed([], LOCAL)


def test_every_route_but_health_asks_for_the_token(studio_at):
    paths = studio_at.client.get("/api/openapi.json").json()["paths"]
    assert len(paths) > 15
    with httpx.Client(base_url=studio_at.base, trust_env=False) as stranger:
        for path, methods in paths.items():
            for method in methods:
                url = path.replace("{name}", "x")
                for headers in ({}, {"Authorization": "Bearer wrong"}, {"Cookie": "a1_studio=x"}):
                    status = stranger.request(method, url, headers=headers).status_code
                    assert status == (200 if path == "/api/health" else 401), (method, path)
        for path in (
            "/",
            "/view/",
            "/assets/js/app.js",
            "/api/docs",
            "/nowhere",
            "/?token=wrong",
            "/camera",
            "/camera?token=wrong",
        ):
            assert stranger.get(path).status_code == 401, path
    for path in ("/api/human", "/api/ticks", "/api/control", "/view", "/api/health"):
        with pytest.raises(InvalidStatus) as refused:
            studio_at.ws(path, headers={})
        assert refused.value.response.status_code == 401


def test_the_printed_url_sets_a_strict_cookie_and_leaves_the_address_bar(studio_at):
    with httpx.Client(base_url=studio_at.base, trust_env=False) as browser:
        answer = browser.get(f"/?token={TOKEN}")
        assert answer.status_code == 303
        assert answer.headers["location"] == "/"
        cookie = answer.headers["set-cookie"]
        assert f"a1_studio_{studio_at.port}=" in cookie
        assert "HttpOnly" in cookie
        assert "SameSite=Strict" in cookie
        page = browser.get("/")  # the client kept the cookie
        assert page.status_code == 200
        assert "A1 Studio" in page.text
        assert TOKEN not in page.text
        cookies = {"Cookie": f"a1_studio_{studio_at.port}={TOKEN}"}
        with studio_at.ws("/api/ticks", headers=cookies) as socket:
            assert socket.recv(timeout=5)


def test_the_cameras_page_is_opened_with_the_token_on_a_second_device(studio_at):
    with httpx.Client(base_url=studio_at.base, trust_env=False) as browser:
        asked = browser.get("/camera", headers={"Accept": "text/html"})
        assert asked.status_code == 401
        assert "<form" in asked.text
        answer = browser.get(f"/camera?token={TOKEN}")
        assert answer.status_code == 303
        assert answer.headers["location"] == "/camera"
        assert browser.get("/camera").status_code == 200


def test_only_the_pose_models_worker_may_compile_webassembly(studio_at):
    def policy(path: str) -> str:
        return studio_at.client.get(path).headers["content-security-policy"]

    for path in ("/", "/camera", "/assets/js/webcam.js", "/assets/js/webcam-model.js"):
        assert "wasm" not in policy(path), path
    rules = policy("/assets/js/webcam-worker.js").split("; ")
    assert rules == [
        "default-src 'none'", "script-src 'self' 'wasm-unsafe-eval'", "connect-src 'self'",
    ]  # fmt: skip


def test_pages_may_load_and_connect_to_nothing_but_us(studio_at):
    for path in ("/", "/view/"):
        policy = studio_at.client.get(path).headers["content-security-policy"]
        rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
        assert rules["default-src"] == "'none'"
        assert rules["connect-src"].split()[0] == "'self'"
        assert "'unsafe-eval'" not in policy
        assert "http" not in policy
        assert rules["frame-ancestors"] == "'self'"
    assert "'unsafe-inline'" not in studio_at.client.get("/").headers["content-security-policy"]


def test_a_query_that_redirects_the_view_elsewhere_is_dropped(studio_at):
    answer = studio_at.client.get("/view/?websocket=ws://evil.example")
    assert answer.status_code == 303
    assert answer.headers["location"] == "/view/"


@pytest.mark.parametrize(
    ("value", "parsed"),
    [
        ("localhost:80", ("localhost", 80)),
        ("[::1]:8080", ("[::1]", 8080)),
        ("[::1]", ("[::1]", None)),
        ("a", ("a", None)),
        ("a:", None),
        ("a:b", None),
        (":80", None),
        ("a:٣", None),  # a digit, but not of ASCII
    ],
)
def test_hosts_are_split_or_refused(value, parsed):
    assert split_host(value) == parsed


def test_the_address_given_as_host_is_served_too():
    config = AccessConfig(token=TOKEN, host="192.168.7.5", port=8080)
    assert host_allowed(["192.168.7.5:8080"], config)
    assert not host_allowed(["192.168.7.6:8080"], config)
    assert origin_allowed(["http://192.168.7.5:8080"], "192.168.7.5:8080", config)
    assert page_url(config) == f"http://192.168.7.5:8080/?token={TOKEN}"


def test_a_forwarded_port_is_its_own_origin():
    # ssh -L 9000:127.0.0.1:8080: the browser says localhost:9000 in both headers.
    assert origin_allowed(["http://localhost:9000"], "localhost:9000", LOCAL)
    assert not origin_allowed(["http://localhost:9000"], "localhost:8080", LOCAL)
