"""What each event makes of a session. Nothing else changes one."""

from __future__ import annotations

from collections.abc import Iterable

from msgspec.structs import replace

from coadapt.study.protocol import Item, Question, Study
from coadapt.study.session.events import (
    Allocated,
    Answer,
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
from coadapt.study.session.plan import READ, STEERED, Kind, Stage, plan_of
from coadapt.study.session.state import BEGINNING, Result, Session

LONGEST_ANSWER = 10_000
"""Characters."""


class NotNow(ValueError):
    """An event does not fit where the session stands."""


def replayed(study: Study, events: Iterable[Event]) -> Session:
    """The session after ``events``, from its beginning.

    Raises:
        NotNow: if they cannot have happened in this order.
    """
    session = BEGINNING
    for event in events:
        session = advance(study, session, event)
    return session


def stage_of(study: Study, session: Session) -> Stage | None:
    """The stage that ``session`` is in; None once it has ended."""
    return None if session.end else plan_of(study)[session.position]


def advance(study: Study, session: Session, event: Event) -> Session:
    """``session`` after ``event``.

    Raises:
        NotNow: if ``event`` cannot happen now. The session is as it was.
    """
    match event:
        case Noted():
            return session
        case Excluded():
            _require(session.end != "excluded", "the session is excluded already")
            return replace(session, end="excluded", before=session.end, running=False)
        case Readmitted():
            _require(session.end == "excluded", "the session is not excluded")
            return replace(session, end=session.before, before=None)
        case Opened():
            _require(not session.opened, "the session is open already")
            return replace(session, opened=True)
        case _:
            _require(session.opened, "the session has not been opened")
            # Answering the last question completes a session; its debrief is still to be read.
            reading = session.end == "finished" and isinstance(event, Read)
            _require(session.end is None or reading, f"the session has ended: {session.end}")
            return _within(study, session, event)


def _within(study: Study, session: Session, event: Event) -> Session:
    """``session``, which is under way, after ``event``."""
    stages = plan_of(study)
    stage = stages[session.position]
    match event:
        case Withdrew():
            return replace(session, end="withdrawn", running=False)
        case Read():
            _require_stage(stage, event.stage, READ)
            return session if stage.kind == "debrief" else _next(study, session)
        case Checked():
            _require_kind(stage, "preflight")
            return _next(study, replace(session, device=event.device))
        case Consented():
            _require_kind(stage, "consent")
            return _next(study, session)
        case Declined():
            _require_kind(stage, "consent")
            return replace(session, end="declined")
        case Chose():
            _require_kind(stage, "choice")
            _require(session.choice is None, "the choice has been made")
            _require(event.goal in (0, 1), f"there is no goal {event.goal}")
            return replace(session, choice=event.goal)
        case Allocated():
            _require_kind(stage, "choice")
            _require(session.choice is not None, "the choice has not been made")
            known = event.condition in {condition.name for condition in study.conditions}
            _require(known, f"there is no condition {event.condition!r}")
            return _next(study, replace(session, condition=event.condition))
        case Began():
            _require_stage(stage, event.stage, STEERED)
            expected = session.attempt + 1
            _require(event.attempt == expected, f"this would be attempt {expected}")
            return replace(session, attempt=event.attempt, steps=0, running=True)
        case Pressed():
            _require(stage.kind in STEERED, f"there is nothing to steer in stage {stage}")
            return session
        case Stepped():
            _require(session.running, "nothing is under way")
            _require(event.step == session.steps, f"this would be step {session.steps}")
            return replace(session, steps=session.steps + 1)
        case Finished():
            _require(session.running, "nothing is under way")
            _require_stage(stage, event.stage, STEERED)
            return _next(study, _with_result(stage, session, event))
        case Answered():
            _require_stage(stage, event.stage, frozenset({"scale", "questions"}))
            _require_answers(study, session, event)
            return _next(study, replace(session, answers={**session.answers, **event.answers}))
        case _:
            raise NotNow(f"{type(event).__name__} does not fit stage {stage}")


def _with_result(stage: Stage, session: Session, event: Finished) -> Session:
    if stage.kind == "practice":
        return session
    result = Result(event.goal, event.wanted, session.steps, session.attempt)
    return replace(session, results=(*session.results, result), forecast=event.forecast)


def _next(study: Study, session: Session) -> Session:
    """``session`` in the next stage that is for it; finished where only the debrief is left."""
    stages = plan_of(study)
    position = session.position + 1
    while _is_passed_over(study, session, stages[position]):
        position += 1
    end = "finished" if stages[position].kind == "debrief" else None
    return replace(session, position=position, attempt=0, steps=0, running=False, end=end)


def _is_passed_over(study: Study, session: Session, stage: Stage) -> bool:
    if stage.kind == "briefing":
        condition = session.condition
        return condition is None or not study.condition(condition).briefing
    return stage.kind == "questions" and not asked_questions(study, session)


def asked_questions(study: Study, session: Session) -> tuple[Question, ...]:
    """The questions that are for this participant."""
    return tuple(q for q in study.questions if q.ask == "always" or session.changed)


def _require_answers(study: Study, session: Session, event: Answered) -> None:
    if event.stage.kind == "scale":
        scale = study.scales[event.stage.number - 1]
        asked: tuple[Item | Question, ...] = scale.items
        points = len(scale.points)
    else:
        asked, points = asked_questions(study, session), 0
    _require({q.name for q in asked} == set(event.answers), "the answers are for other questions")
    for question in asked:
        _require_answer(question, event.answers[question.name], points)


def _require_answer(question: Item | Question, answer: Answer, points: int) -> None:
    if isinstance(question, Item):
        fits = isinstance(answer, int) and 1 <= answer <= points
    elif answer is None:
        fits = not question.required
    elif question.choices:
        fits = isinstance(answer, int) and 1 <= answer <= len(question.choices)
    else:
        fits = isinstance(answer, str) and len(answer) <= LONGEST_ANSWER
        fits = fits and not (question.required and not str(answer).strip())
    _require(fits, f"the answer to {question.name} does not fit")


def _require_stage(stage: Stage, named: Stage, kinds: frozenset[Kind]) -> None:
    _require(stage == named and stage.kind in kinds, f"the session is in stage {stage}")


def _require_kind(stage: Stage, kind: Kind) -> None:
    _require(stage.kind == kind, f"the session is in stage {stage}")


def _require(holds: bool, problem: str) -> None:
    if not holds:
        raise NotNow(problem)
