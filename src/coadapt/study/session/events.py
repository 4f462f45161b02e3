"""What can happen in a session. The stored events of a session are all there is to know of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, get_args

import msgspec

from coadapt.study.session.plan import Stage

Device = Literal["keyboard", "gamepad", "touch", "switch"]
"""What a participant steers with; ``switch``: one switch, with scanning."""

Answer = int | str | None
"""A point of a scale or a choice, from 1; a text; or nothing."""

Belief = tuple[tuple[float, ...], ...]
"""``[A][M]`` over adaptability and mode."""


class Happening(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    tag_field="event",
    forbid_unknown_fields=True,
    gc=False,  # many are made, and none can hold itself
):
    """Something that happened. When is stored beside it, by the clock of the server."""


class Opened(Happening, frozen=True, kw_only=True, tag="opened"):
    """Somebody came by a link. ``parameters``: those of the link that the study keeps."""

    parameters: dict[str, str]


class Read(Happening, frozen=True, kw_only=True, tag="read"):
    """A page was read and left."""

    stage: Stage


class Checked(Happening, frozen=True, kw_only=True, tag="checked"):
    """The preflight was passed.

    Attributes:
        device: what the participant steers with.
        width, height: of the window, in CSS pixels.
        latency: median round trip between page and server, in seconds.
        browser: what it calls itself.
        pad: what the gamepad calls itself, or "".
    """

    device: Device
    width: int
    height: int
    latency: float
    browser: str
    pad: str = ""


class Consented(Happening, frozen=True, kw_only=True, tag="consented"):
    """The participant agreed to take part."""


class Declined(Happening, frozen=True, kw_only=True, tag="declined"):
    """The participant did not agree."""


class Chose(Happening, frozen=True, kw_only=True, tag="chose"):
    """The participant chose a goal, an index."""

    goal: int


class Allocated(Happening, frozen=True, kw_only=True, tag="allocated"):
    """The participant was allocated to a condition."""

    condition: str


class Began(Happening, frozen=True, kw_only=True, tag="began"):
    """A training session or trial began, or began again.

    Attributes:
        stage: which.
        attempt: how often it has begun, from 1.
        start: index of the robot state.
        belief: the robot's at the start; None in training.
    """

    stage: Stage
    attempt: int
    start: int
    belief: Belief | None = None


class Pressed(Happening, frozen=True, kw_only=True, tag="pressed"):
    """The input changed.

    Attributes:
        input: index of the input that is held from now on, or None.
        device: where it came from.
        sequence: number of the message, counted by the page.
        page_time: when the page saw it, in seconds of the page's clock.
        device_time: the gamepad's own time, in seconds of the page's clock, or None.
    """

    input: int | None
    device: Device
    sequence: int
    page_time: float
    device_time: float | None = None


class Stepped(Happening, frozen=True, kw_only=True, tag="stepped"):
    """A step of a training session or trial.

    Attributes:
        step: number of the step in this attempt, from 0.
        state: robot state in which it was decided.
        window: what the person remembers there, an index in the model's windows; None in training.
        input: index of the input, or None.
        action: what the robot did; None where it stayed for want of an input, in training.
        planned, agreement, matched: of the decision; None in training.
        belief: behind the decision; None in training.
        reached: the robot state it led to.
    """

    step: int
    state: int
    input: int | None
    action: int | None
    reached: int
    window: int | None = None
    planned: int | None = None
    agreement: float | None = None
    matched: bool | None = None
    belief: Belief | None = None


class Finished(Happening, frozen=True, kw_only=True, tag="finished"):
    """A training session or trial came to its end.

    Attributes:
        stage: which.
        goal: index of the goal reached, or None where the steps ran out.
        wanted: index of the goal that the last telling input was for, or None: see `wanted_goal`.
        forecast: the robot's belief for what would follow; None in training.
    """

    stage: Stage
    goal: int | None
    wanted: int | None = None
    forecast: Belief | None = None


class Answered(Happening, frozen=True, kw_only=True, tag="answered"):
    """A page of questions was answered: answers by the names of items and questions."""

    stage: Stage
    answers: dict[str, Answer]


class Withdrew(Happening, frozen=True, kw_only=True, tag="withdrew"):
    """The participant withdrew."""


class Excluded(Happening, frozen=True, kw_only=True, tag="excluded"):
    """The researcher took the session out of the data."""

    reason: str


class Readmitted(Happening, frozen=True, kw_only=True, tag="readmitted"):
    """The researcher took that back."""


class Noted(Happening, frozen=True, kw_only=True, tag="noted"):
    """Something that changes nothing: a connection made or lost, a latency, an error of the page.

    Attributes:
        what: a short name.
        value: a number, for example seconds, where there is one.
        text: more about it.
    """

    what: str
    value: float | None = None
    text: str = ""


Event = (
    Opened
    | Read
    | Checked
    | Consented
    | Declined
    | Chose
    | Allocated
    | Began
    | Pressed
    | Stepped
    | Finished
    | Answered
    | Withdrew
    | Excluded
    | Readmitted
    | Noted
)

KINDS: Mapping[type[Event], str] = {
    kind: f"{kind.__struct_config__.tag}" for kind in get_args(Event)
}
"""What the kinds of events are called where they are stored."""

_ENCODER = msgspec.json.Encoder()
_DECODER: msgspec.json.Decoder[Event] = msgspec.json.Decoder(Event)


def encode_event(event: Event) -> bytes:
    """``event`` as JSON; numbers are read back the same."""
    return _ENCODER.encode(event)


def decode_event(data: bytes | str) -> Event:
    """The event in ``data``.

    Raises:
        msgspec.MsgspecError: if it is none.
    """
    return _DECODER.decode(data)
