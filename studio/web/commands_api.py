"""State and commands over HTTP: a route for each command that has a path, made of its declaration.

A request is answered once the loop has applied it.
"""

import inspect
from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import APIRouter, Depends, HTTPException, Request, Response
from fastapi import Body as InBody
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from pydantic import Field, create_model

from studio.errors import StudioError
from studio.live.command import Body, misfit
from studio.live.commands import COMMANDS, CollectAction, Command, StartTake, StopTake
from studio.takes.as_json import plain
from studio.takes.session_library import SessionLibrary
from studio.web.answers import Judged, State, answers
from studio.web.answers_takes import Started, Stopped
from studio.web.hub import Hub, OffThread, refused


class ControlBody(Body):
    """take, ask, release, hand_over (to another page) or keep (from those who ask).

    No `Command`: which page drives is the gateway's to know, before any command reaches the loop.
    """

    page: str = Field(max_length=64)
    action: str = "take"
    to: str | None = Field(default=None, max_length=64)


class CommandRoute(APIRoute):
    """A command that is not applied is answered 409 with `why`, one that does not fit included."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """FastAPI's own, with its refusal turned into ours."""
        handler = super().get_route_handler()

        async def handled(request: Request) -> Response:
            try:
                return await handler(request)
            except RequestValidationError as error:
                raise refused(misfit(error.errors(), 1)) from error
            except HTTPException as error:
                if error.status_code != 400:
                    raise
                raise refused("the body is no JSON in UTF-8") from error

        return handled


ANSWERS: dict[type[Command], Any] = {
    StartTake: Started, StopTake: Stopped, CollectAction: Judged,
}  # fmt: skip
"""What a command is answered that is not answered the state."""


def commands_router(hub: Hub) -> APIRouter:
    """Everything that asks the loop for something, and what it is doing."""
    router = APIRouter(prefix="/api")
    library = SessionLibrary(hub.sessions)
    off_thread = OffThread(hub.workers, 404)

    async def known_take(name: str) -> None:
        """404 for a take that is not there."""
        await off_thread(library.folder, name)

    @router.get("/state", tags=["studio"], **answers(State))
    async def state() -> Response:
        """What the studio is doing, and why nothing moves if nothing does."""
        return Response(hub.state_json(), media_type="application/json")

    for command in COMMANDS:
        if command.path:
            router.add_api_route(
                f"/{command.path}",
                endpoint(hub, command),
                methods=["POST"],
                name=command.path.rpartition("/")[2],
                description=inspect.getdoc(command),
                tags=[command.tag],
                dependencies=[Depends(known_take)] if "{name}" in command.path else [],
                route_class_override=CommandRoute if command.misfit_status == 409 else None,
                **answers(ANSWERS.get(command, State), *refusals(command)),
            )

    @router.post("/control", tags=["studio"], **answers(State, 409, 422))
    async def control(body: ControlBody) -> dict[str, Any]:
        """A page takes, hands over or gives up control."""
        try:
            hub.control.act(body.action, body.page, body.to)
        except StudioError as error:
            raise refused(str(error)) from error
        return hub.state()

    return router


def refusals(command: type[Command]) -> list[int]:
    """The statuses with which asking for a command may be refused."""
    found = {409, command.misfit_status} if body_of(command) else {409}
    return sorted(found | {404} if "{name}" in command.path else found)


def body_of(command: type[Command]) -> type[Body] | None:
    """The body that asks for a command: its fields, but for those from elsewhere; None if none."""
    fields: dict[str, Any] = {
        name: (field.annotation, field)
        for name, field in command.model_fields.items()
        if name != command.sender and f"{{{name}}}" not in command.path
    }
    if not fields or len(fields) == len(command.model_fields):
        return command if fields else None
    return create_model(f"{command.__name__}Body", __base__=Body, **fields)


def endpoint(hub: Hub, command: type[Command]) -> Callable[..., Coroutine[Any, Any, dict]]:
    """The function that FastAPI calls for a command."""
    body_type = body_of(command)

    async def ask(request: Request, body: Body | None) -> dict[str, Any]:
        if not isinstance(body, command):
            more = {**request.path_params, **(dict(body) if body is not None else {})}
            if command.sender:
                more[command.sender] = request.headers.get("x-studio-page", "api")
            body = command(**more)
        result = await hub.apply(body, request)
        return plain(body.answer(hub.state(), result.data))

    if body_type is None:

        async def without(request: Request) -> dict[str, Any]:
            return await ask(request, None)

        return without
    required = any(field.is_required() for field in body_type.model_fields.values())
    wanted = body_type if required else body_type | None
    default = InBody(... if required else None)

    async def with_body(request: Request, body: wanted = default) -> dict[str, Any]:  # type: ignore[valid-type]
        return await ask(request, body)

    return with_body
