"""What happened in a session, in words, the many small events of steering put together."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from coadapt.study.protocol import Study
from coadapt.study.record import Record
from coadapt.study.server.admin.overview import is_error, stage_name
from coadapt.study.session.events import (
    Allocated,
    Answered,
    Began,
    Checked,
    Chose,
    Consented,
    Declined,
    Event,
    Excluded,
    Finished,
    Noted,
    Opened,
    Pressed,
    Read,
    Readmitted,
    Stepped,
    Withdrew,
)


class Line(msgspec.Struct, frozen=True):
    """A line of the timeline.

    Attributes:
        time: seconds since the session was opened.
        what: what happened.
        detail: more about it.
        kind: ``"error"``, ``"researcher"`` or ``""``.
    """

    time: float
    what: str
    detail: str = ""
    kind: str = ""


def timeline(study: Study, record: Record, goals: Sequence[str], *, unblinded: bool) -> list[Line]:
    """The lines of a session.

    Args:
        study: the protocol.
        record: the session.
        goals: names of the goals.
        unblinded: whether the condition may be told.
    """
    lines: list[Line] = []
    presses = steps = 0
    for kept in record.events:
        event, time = kept.event, kept.time - record.opened
        presses += isinstance(event, Pressed)
        steps += isinstance(event, Stepped)
        if isinstance(event, Pressed | Stepped) or _tells(event, unblinded):
            continue
        if presses or steps:
            lines.append(Line(time, f"{steps} steps", f"{presses} changes of input"))
            presses = steps = 0
        lines.append(_line(study, time, event, goals, unblinded))
    if presses or steps:
        last = record.events[-1].time - record.opened
        lines.append(Line(last, f"{steps} steps", f"{presses} changes of input"))
    return lines


def _tells(event: Event, unblinded: bool) -> bool:
    """Whether that it happened tells the condition: only some have a briefing."""
    return not unblinded and isinstance(event, Read) and event.stage.kind == "briefing"


def _line(study: Study, time: float, event: Event, goals: Sequence[str], unblinded: bool) -> Line:
    match event:
        case Opened():
            return Line(time, "Opened")
        case Read():
            return Line(time, f"Read {event.stage.kind}")
        case Checked():
            size = f"{event.width} × {event.height}"
            pad = f", {event.pad}" if event.pad else ""
            detail = f"{event.device}{pad}, {size}, {event.latency * 1000:.0f} ms, {event.browser}"
            return Line(time, "Passed the preflight", detail)
        case Consented():
            return Line(time, "Consented")
        case Declined():
            return Line(time, "Declined")
        case Chose():
            return Line(time, "Chose", goals[event.goal])
        case Allocated():
            return Line(time, "Allocated", event.condition if unblinded else "condition hidden")
        case Began():
            return Line(time, f"Began {stage_name(study, event.stage)}", f"attempt {event.attempt}")
        case Finished():
            reached = "no goal" if event.goal is None else goals[event.goal]
            return Line(time, f"Finished {stage_name(study, event.stage)}", reached)
        case Answered():
            return Line(
                time, f"Answered {stage_name(study, event.stage)}", f"{len(event.answers)} answers"
            )
        case Withdrew():
            return Line(time, "Withdrew")
        case Excluded():
            return Line(time, "Excluded", event.reason, "researcher")
        case Readmitted():
            return Line(time, "Readmitted", "", "researcher")
        case Noted():
            value = "" if event.value is None else f"{event.value:g} "
            kind = "error" if is_error(event) else ""
            return Line(time, f"Note: {event.what}", f"{value}{event.text}", kind)
        case _:
            return Line(time, type(event).__name__)
