"""What a posted form says: the events it stands for, or what is wrong with it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import cast, get_args

from coadapt.study.protocol import Item, Question, Study
from coadapt.study.session.events import (
    Answer,
    Answered,
    Checked,
    Chose,
    Consented,
    Declined,
    Device,
    Event,
    Read,
)
from coadapt.study.session.machine import LONGEST_ANSWER, asked_questions
from coadapt.study.session.plan import READ, Stage, plan_of
from coadapt.study.session.state import Session

DEVICES: tuple[Device, ...] = get_args(Device)

LARGEST_WINDOW = 100_000
"""CSS pixels."""

LONGEST_LATENCY = 600.0
"""Seconds."""

LONGEST_NAME = 500
"""Characters of what a browser or a gamepad calls itself; the rest is cut off."""

CHOOSE = "Please choose one of the answers."

EITHER = "Please choose one of the two."

WRITE = "Please write an answer."


@dataclass(frozen=True)
class Refusal:
    """A form that cannot be taken as it is.

    Attributes:
        problems: a sentence for each field that has one.
        given: what was given, by field, to be shown again.
    """

    problems: Mapping[str, str]
    given: Mapping[str, str]


def read_form(
    study: Study, session: Session, form: Mapping[str, str]
) -> tuple[Event, ...] | Refusal:
    """The events that ``form``, posted for the page that ``session`` shows, stands for.

    None at all if it is for another page: a late form, or one that was sent twice.
    """
    stage = plan_of(study)[session.position]
    debriefed = session.end == "finished" and stage.kind == "debrief"
    ended = session.end is not None and not debriefed
    chosen = stage.kind == "choice" and session.choice is not None
    if form.get("stage") != str(stage) or ended or chosen:
        return ()
    reader = _Reader(form)
    event = _event(study, session, stage, reader)
    if reader.problems or event is None:
        return Refusal(reader.problems, {name: clean(text) for name, text in form.items()})
    return (event,)


def _event(study: Study, session: Session, stage: Stage, reader: _Reader) -> Event | None:
    if stage.kind in READ:
        return Read(stage=stage)
    match stage.kind:
        case "preflight":
            return _checked(reader)
        case "consent":
            given = reader.one_of("consent", ("yes", "no"), EITHER)
            return None if given is None else Consented() if given == "yes" else Declined()
        case "choice":
            goal = reader.one_of("goal", ("0", "1"), EITHER)
            return None if goal is None else Chose(goal=int(goal))
        case "scale":
            scale = study.scales[stage.number - 1]
            return _answered(stage, scale.items, len(scale.points), reader)
        case "questions":
            return _answered(stage, asked_questions(study, session), 0, reader)
        case _:
            return None


def _checked(reader: _Reader) -> Checked | None:
    device = reader.text("device")
    width, height = (reader.number(name, 1, LARGEST_WINDOW) for name in ("width", "height"))
    latency = reader.number("latency", 0, LONGEST_LATENCY)
    if device not in DEVICES:
        reader.problems["device"] = "Please choose what you steer with."
    if width is None or height is None or latency is None:
        reader.problems["checks"] = "The checks of this page are not complete yet."
    if reader.problems or width is None or height is None or latency is None:
        return None
    return Checked(
        device=cast("Device", device),
        width=round(width),
        height=round(height),
        latency=latency,
        browser=reader.text("browser")[:LONGEST_NAME],
        pad=reader.text("pad")[:LONGEST_NAME],
    )


def _answered(
    stage: Stage, asked: tuple[Item | Question, ...], points: int, reader: _Reader
) -> Answered:
    answers: dict[str, Answer] = {}
    for question in asked:
        if isinstance(question, Item):
            answers[question.name] = reader.point(question.name, points, CHOOSE)
        elif question.choices:
            missing = CHOOSE if question.required else ""
            answers[question.name] = reader.point(question.name, len(question.choices), missing)
        else:
            missing = WRITE if question.required else ""
            answers[question.name] = reader.words(question.name, missing)
    return Answered(stage=stage, answers=answers)


class _Reader:
    """Reads fields and collects what is wrong with them."""

    def __init__(self, form: Mapping[str, str]) -> None:
        self._form = form
        self.problems: dict[str, str] = {}

    def text(self, name: str) -> str:
        """The text of a field, "" without one."""
        return clean(self._form.get(name, ""))

    def one_of(self, name: str, values: Sequence[str], missing: str) -> str | None:
        """One of ``values``, or None.

        ``missing`` is the problem without one; if empty, nothing need be chosen.
        """
        given = self.text(name)
        if given in values:
            return given
        if given or missing:
            self.problems[name] = missing or CHOOSE
        return None

    def point(self, name: str, count: int, missing: str) -> int | None:
        """A number from 1 to ``count``, or None; ``missing`` as for `one_of`."""
        given = self.one_of(name, [f"{i + 1}" for i in range(count)], missing)
        return None if given is None else int(given)

    def words(self, name: str, missing: str) -> str | None:
        """A text that is not blank, or None; ``missing`` as for `one_of`."""
        given = self.text(name)
        if len(given) > LONGEST_ANSWER:
            few = f"Please write {LONGEST_ANSWER:,} characters at most; these are {len(given):,}."
            self.problems[name] = few
        elif not given.strip():
            if missing:
                self.problems[name] = missing
            return None
        return given

    def number(self, name: str, least: float, most: float) -> float | None:
        """A number from ``least`` to ``most``, or None."""
        try:
            value = float(self.text(name))
        except ValueError:
            return None
        return value if math.isfinite(value) and least <= value <= most else None


def clean(text: str) -> str:
    """``text`` with plain line ends, and without what a database or a table cannot hold."""
    text = text.encode("utf-8", "replace").decode("utf-8")
    return text.replace("\r\n", "\n").replace("\r", "\n").replace("\x00", "")
