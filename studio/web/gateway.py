"""The one public port: page, API, sockets and the framed 3-D view, behind one door."""

import tempfile
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import FileResponse, HTMLResponse, JSONResponse
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.staticfiles import StaticFiles

import studio
from studio.files import FULL
from studio.live.command import misfit
from studio.live.loop import LiveLoop
from studio.live.runtime import RuntimeConfig
from studio.paths import package_folder
from studio.web.access import AccessConfig, AccessMiddleware
from studio.web.collect_api import collect_router
from studio.web.commands_api import commands_router
from studio.web.exports_api import exports_router
from studio.web.feed import TickFeed
from studio.web.files_api import files_router
from studio.web.guarded_viser import GuardedViser
from studio.web.health_api import health_router
from studio.web.hub import Hub
from studio.web.joint_map_api import joint_map_router
from studio.web.library_api import library_router
from studio.web.page_control import PageControl
from studio.web.phone_api import phone_router
from studio.web.relay import view_router
from studio.web.review_api import review_router
from studio.web.scenes_api import scenes_router
from studio.web.schema import with_messages
from studio.web.sockets import sockets_router
from studio.web.stop_order import StopAnswers
from studio.web.supervisor import Supervisor
from studio.web.takes_api import takes_router
from studio.web.train_api import train_router


def assets_folder() -> Path:
    """The page's files: beside the sources, or beside the package in an installation."""
    folder = package_folder("web_assets")
    if (folder / "index.html").is_file():
        return folder
    raise FileNotFoundError("web_assets/index.html is missing; install A1 Studio again")


def create_api(hub: Hub) -> FastAPI:
    """The API alone."""

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[dict[str, Any]]:
        import asyncio

        hub.feed.begin(asyncio.get_running_loop())
        yield {"stop_order": hub.stop_order}
        hub.feed.stop()
        hub.close()

    app = FastAPI(
        title="A1 Studio",
        version=studio.__version__,
        docs_url=None,
        redoc_url=None,
        openapi_url="/api/openapi.json",
        lifespan=lifespan,
    )
    app.add_middleware(StopAnswers, order=hub.stop_order)
    app.include_router(commands_router(hub))
    app.include_router(collect_router(hub))
    app.include_router(review_router(hub))
    app.include_router(library_router(hub))
    app.include_router(exports_router(hub))
    app.include_router(takes_router(hub))
    app.include_router(scenes_router(hub))
    app.include_router(train_router(hub))
    app.include_router(files_router(hub))
    app.include_router(health_router(hub))
    app.include_router(joint_map_router(hub))
    app.include_router(phone_router(hub))
    app.include_router(sockets_router(hub))
    plain_schema = app.openapi
    app.openapi = lambda: with_messages(plain_schema())  # type: ignore[method-assign]
    return app


def openapi() -> dict[str, Any]:
    """The API's schema without a server, as `a1-studio openapi` prints it: OpenAPI 3.1."""
    with tempfile.TemporaryDirectory(prefix="a1-studio-") as folder:
        loop = LiveLoop(RuntimeConfig(source="operator:quiet", sessions=Path(folder)))
        hub = Hub(
            loop=loop,
            access=AccessConfig(token="none", host="127.0.0.1", port=0),
            control=PageControl(loop.post, loop.beat, loop.silent),
            feed=TickFeed(loop.ticks),
            supervisor=Supervisor(loop, {}),
            sessions=Path(folder),
            scratch=Path(folder),
        )
        try:
            return create_api(hub).openapi()
        finally:
            hub.close()


def create_app(hub: Hub, inner: GuardedViser | None) -> AccessMiddleware:
    """The application (`app`), access checks outermost."""
    assets = assets_folder()
    app = create_api(hub)
    if inner is not None:
        app.include_router(view_router(inner))

    @app.get("/", include_in_schema=False)
    async def index() -> FileResponse:
        """The page."""
        return FileResponse(assets / "index.html", media_type="text/html")

    @app.get("/camera", include_in_schema=False)
    async def camera() -> FileResponse:
        """The page of a camera, on this machine or on a second one."""
        return FileResponse(assets / "camera.html", media_type="text/html")

    @app.get("/api/docs", include_in_schema=False)
    async def docs(request: Request) -> Any:
        """The schema: for people as a page, for programs as JSON."""
        if "text/html" in request.headers.get("accept", ""):
            return HTMLResponse((assets / "docs.html").read_text("utf-8"))
        return JSONResponse(app.openapi())

    for name in ("css", "js", "img", "samples", "vendor"):
        if (assets / name).is_dir():
            app.mount(f"/assets/{name}", StaticFiles(directory=assets / name), name=name)

    @app.exception_handler(HTTPException)
    async def refused(_: Request, error: HTTPException) -> JSONResponse:
        """Every refusal says why."""
        said: Any = error.detail
        said = said if isinstance(said, dict) else {"why": said, "error": said}
        return JSONResponse(said, error.status_code)

    @app.exception_handler(ClientDisconnect)
    async def left(_: Request, error: ClientDisconnect) -> JSONResponse:
        """Nobody is there to read it."""
        return JSONResponse({"why": "the sender left", "error": "the sender left"}, 400)

    @app.exception_handler(OSError)
    async def full(_: Request, error: OSError) -> JSONResponse:
        """A full disk, wherever it is met."""
        if error.errno not in FULL:
            raise error
        why = f"nothing was kept: {error.strerror}; make room, then try again"
        return JSONResponse({"why": why, "error": why}, 507)

    @app.exception_handler(RequestValidationError)
    async def malformed(_: Request, error: RequestValidationError) -> JSONResponse:
        """A body that does not fit: which field, and what it should be."""
        said = misfit(error.errors(), 1)
        return JSONResponse({"why": said, "error": said}, 422)

    sign_in = (assets / "sign_in.html").read_text("utf-8")
    return AccessMiddleware(app, hub.access, sign_in)
