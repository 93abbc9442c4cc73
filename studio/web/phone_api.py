"""The phone that is the camera: the invitation to show it, and who has come."""

from typing import Literal

from fastapi import APIRouter
from pydantic import Field

from studio.errors import StudioError
from studio.live.command import Body
from studio.web.answers import answers
from studio.web.hub import Hub, refused
from studio.web.phone import PhoneState, off


class PhoneBody(Body):
    """invite: a new invitation, the one before is no good any more. send_away: the phone named."""

    action: Literal["invite", "send_away"]
    name: str = Field(default="", max_length=60)


def phone_router(hub: Hub) -> APIRouter:
    """GET and POST /api/phone."""
    router = APIRouter(prefix="/api/phone", tags=["studio"])

    def state() -> PhoneState:
        return off() if hub.phones is None else hub.phones.state()

    @router.get("", **answers(PhoneState))
    async def phone() -> PhoneState:
        """The invitation, as a URL and as a QR code, and the phones that have come."""
        return state()

    @router.post("", **answers(PhoneState, 409, 422))
    async def change(body: PhoneBody) -> PhoneState:
        """Invite anew, or send a phone away."""
        if hub.phones is None:
            raise refused(off()["why"])
        try:
            if body.action == "invite":
                hub.phones.invite()
            else:
                hub.phones.send_away(body.name)
        except StudioError as error:
            raise refused(str(error)) from error
        return state()

    return router
