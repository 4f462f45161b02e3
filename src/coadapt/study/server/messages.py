"""What page and server say to each other while a participant steers; JSON over a websocket.

The page says `Input` whenever the input changes, and the server answers `Stored` once that is safe
on disk. The server says `Step` when a decision is safe on disk, and the page draws it. No message
tells what the robot believes.
"""

from __future__ import annotations

from typing import Literal

import msgspec

from coadapt.study.session.events import Device

LONGEST_MESSAGE = 2048
"""Bytes of a message from a page."""


class Message(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    tag_field="type",
    forbid_unknown_fields=True,
    gc=False,  # many are made, and none can hold itself
):
    """A message."""


class Ready(Message, frozen=True, kw_only=True, tag="ready"):
    """From the page, at first and after every reconnection: it can draw. An attempt begins."""


class Input(Message, frozen=True, kw_only=True, tag="input"):
    """From the page: the input changed; see `coadapt.study.session.events.Pressed`."""

    input: int | None
    device: Device
    sequence: int
    page_time: float
    device_time: float | None = None


class Note(Message, frozen=True, kw_only=True, tag="note"):
    """From the page: something worth keeping, such as an error or a frame rate."""

    what: str
    value: float | None = None
    text: str = ""


class Ping(Message, frozen=True, kw_only=True, tag="ping"):
    """From the page: how long is the way? ``page_time`` comes back in a `Pong`."""

    page_time: float


class Goal(msgspec.Struct, frozen=True):
    """A goal as drawn: its name and its states."""

    name: str
    states: tuple[int, ...]


class Steering(msgspec.Struct, frozen=True):
    """An input as drawn: its name and where it points, ``(right, ahead)``."""

    name: str
    direction: tuple[float, float]


class Scene(Message, frozen=True, kw_only=True, tag="scene"):
    """From the server, first of all: what to draw.

    Attributes:
        kind, number, of: the stage, for example trial 2 of 3.
        positions: where each robot state lies, ``(right, ahead)``, in cells or metres.
        free: the pairs of neighbouring states, for drawing where the robot can go.
        goals: the goals, in the order of their indices.
        inputs: the inputs, in the order of their indices.
        turns, step: of the clock.
    """

    kind: Literal["practice", "trial"]
    number: int
    of: int
    positions: tuple[tuple[float, float], ...]
    free: tuple[tuple[int, int], ...]
    goals: tuple[Goal, ...]
    inputs: tuple[Steering, ...]
    turns: Literal["fixed", "wait"]
    step: float


class Begun(Message, frozen=True, kw_only=True, tag="begun"):
    """From the server: an attempt began, with the robot in ``state``."""

    attempt: int
    state: int


class Stored(Message, frozen=True, kw_only=True, tag="stored"):
    """From the server: the input with this ``sequence`` is safe."""

    sequence: int


class Step(Message, frozen=True, kw_only=True, tag="step"):
    """From the server: the robot goes from state ``state`` to ``reached``.

    Attributes:
        step: number in this attempt, from 0.
        input: the input it was decided with, or None.
    """

    step: int
    state: int
    reached: int
    input: int | None


class Over(Message, frozen=True, kw_only=True, tag="over"):
    """From the server: the attempt is over; ``goal`` is the index of the goal reached, or None."""

    goal: int | None


class Pong(Message, frozen=True, kw_only=True, tag="pong"):
    """From the server: the answer to a `Ping`."""

    page_time: float


class Refused(Message, frozen=True, kw_only=True, tag="refused"):
    """From the server, last of all: what was wrong. The page shows it and offers to reload."""

    reason: str


FromPage = Ready | Input | Note | Ping

FromServer = Scene | Begun | Stored | Step | Over | Pong | Refused

_ENCODER = msgspec.json.Encoder()
_DECODER: msgspec.json.Decoder[FromPage] = msgspec.json.Decoder(FromPage)


def encode_message(message: FromServer) -> bytes:
    """``message`` as JSON."""
    return _ENCODER.encode(message)


def decode_message(data: str | bytes) -> FromPage:
    """The page's message in ``data``.

    Raises:
        ValueError: if it is none, or too long.
    """
    if len(data) > LONGEST_MESSAGE:
        raise ValueError(f"a message of more than {LONGEST_MESSAGE:,} bytes")
    return _DECODER.decode(data)
