"""The studio's HTTP and socket contract → Python: frames in, ticks out, state, stop, takes.

Needs the standard library and `websockets`; a program that uses it may run on another machine.
"""

from studio.client.aio import AsyncFrames, AsyncStudio, AsyncTicks
from studio.client.http import ClientError
from studio.client.messages import Frame, State, Take, Tick
from studio.client.sync import Frames, Studio, Ticks

__all__ = [
    "AsyncFrames",
    "AsyncStudio",
    "AsyncTicks",
    "ClientError",
    "Frame",
    "Frames",
    "State",
    "Studio",
    "Take",
    "Tick",
    "Ticks",
]
