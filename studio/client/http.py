"""A request → the studio's answer, or ClientError with its words; a connection each, any thread."""

import json
import shutil
import ssl
from http.client import HTTPConnection, HTTPException, HTTPResponse, HTTPSConnection
from pathlib import Path
from typing import Any, TypedDict
from urllib.parse import parse_qs, quote, urlsplit

from studio.errors import StudioError


class ClientError(StudioError):
    """The studio refused, or is not there. status: HTTP's, 0 where nothing answered."""

    def __init__(self, why: str, status: int = 0) -> None:
        super().__init__(why)
        self.status = status


class Options(TypedDict, total=False):
    """What an `Address` may be given besides: its own defaults where it is not."""

    timeout: float
    tls: ssl.SSLContext | None


class Address:
    """Where a studio is, from the URL that `a1-studio serve` prints.

    url: http://HOST:PORT/?token=TOKEN, or without the token where `token` gives it. timeout: s that
    an answer may take. tls: how certificates are checked (https); the system's way unless given.
    """

    def __init__(
        self,
        url: str,
        token: str | None = None,
        *,
        timeout: float = 30.0,
        tls: ssl.SSLContext | None = None,
    ) -> None:
        example = "such as http://127.0.0.1:8080/?token=TOKEN, which serve prints"
        try:
            parts = urlsplit(url)
            host, port = parts.hostname, parts.port
        except ValueError as error:
            raise ClientError(f"{url!r} is no URL ({error}); one is needed {example}") from None
        if parts.scheme not in ("http", "https") or not host:
            raise ClientError(f"{url!r} is no studio's URL; one is needed {example}")
        token = token or parse_qs(parts.query).get("token", [""])[0]
        if not token or not (token.isascii() and token.isprintable()):
            raise ClientError(f"the token is missing or damaged: give it, or a URL {example}")
        secure = parts.scheme == "https"
        self.host, self.port = host, port or (443 if secure else 80)
        self.timeout = timeout
        self.tls = (tls or ssl.create_default_context()) if secure else None
        self.headers = {"Authorization": f"Bearer {token}"}
        named = f"[{host}]" if ":" in host else host
        self._sockets = f"{'wss' if secure else 'ws'}://{named}:{self.port}"

    def socket(self, path: str) -> str:
        """The URL of a WebSocket."""
        return self._sockets + path

    @property
    def nobody(self) -> str:
        """What to say where nothing answers."""
        return f"nothing answers at {self.host}:{self.port}: start `a1-studio serve`"

    def ask(self, method: str, path: str, body: object = None) -> Any:
        """The JSON answered. Raises ClientError with the studio's `why`."""
        connection, answer = self._open(method, path, body)
        try:
            return json.loads(answer.read())
        except (OSError, HTTPException, ValueError) as error:
            raise ClientError(f"the answer to {path} broke off: {error}") from error
        finally:
            connection.close()

    def download(self, path: str, to: Path) -> Path:
        """Write what is answered into the file `to`; of a broken download nothing is left."""
        connection, answer = self._open("GET", path, None)
        part = to.with_name(to.name + ".part")
        try:
            with part.open("wb") as file:
                shutil.copyfileobj(answer, file)
                if answer.length:
                    raise ClientError(f"the download of {path} broke off")
            part.replace(to)
        except (OSError, HTTPException) as error:
            raise ClientError(f"{to} cannot be written: {error}") from error
        finally:
            part.unlink(missing_ok=True)
            connection.close()
        return to

    def _open(self, method: str, path: str, body: object) -> tuple[HTTPConnection, HTTPResponse]:
        if self.tls is not None:
            connection: HTTPConnection = HTTPSConnection(
                self.host, self.port, timeout=self.timeout, context=self.tls
            )
        else:
            connection = HTTPConnection(self.host, self.port, timeout=self.timeout)
        try:
            headers, content = self.headers, None
            if body is not None:
                headers = {**headers, "Content-Type": "application/json"}
                content = json.dumps(body).encode()
            connection.request(method, path, content, headers)
            answer = connection.getresponse()
            if answer.status >= 400:
                raise ClientError(reason(answer.read(), answer.status), answer.status)
        except TimeoutError as error:
            connection.close()
            raise ClientError(f"{path} was not answered within {self.timeout:g} s") from error
        except (OSError, HTTPException) as error:
            connection.close()
            raise ClientError(f"{self.nobody} ({error or type(error).__name__})") from error
        except BaseException:
            connection.close()
            raise
        return connection, answer


def reason(body: bytes, status: int) -> str:
    """Why something was refused, in the studio's words where there are any."""
    try:
        said = json.loads(body)
        why = said.get("why") or said.get("error")
    except (ValueError, AttributeError):
        why = None
    return str(why or f"refused with HTTP status {status}")


def take_path(name: str, *more: str) -> str:
    """/api/takes/NAME…"""
    return "/".join(("/api/takes", quote(name, safe=""), *more))
