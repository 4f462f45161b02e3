"""What the researcher sees of a session at a glance: a pure function of what is stored."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from coadapt.study.attempts import attempts_of
from coadapt.study.protocol import Study
from coadapt.study.record import Record, Standing, standing
from coadapt.study.session.events import Answered, Checked, Event, Noted
from coadapt.study.session.plan import Stage, plan_of

ERROR = "error"
"""`Noted.what` of an error that a page reports begins with this."""


class Glance(msgspec.Struct, frozen=True, kw_only=True):
    """A session at a glance. Nothing in it tells the condition.

    Attributes:
        number: of the session.
        alias: its pseudonym.
        recruited: what a recruitment service calls the person.
        standing: what has become of it.
        simulated: whether a program takes part.
        stage: where it stands or ended, for example "trial 2".
        position, stages: the same as numbers, for drawing how far it has come.
        opened: when it began, in seconds since 1970.
        seen: time of its last event.
        device: what the participant steers with.
        latency: at the preflight, in seconds.
        restarts: how often a training session or trial had to be begun again.
        errors: errors that its pages reported.
        checks_failed: attention checks answered otherwise than asked for.
        connected: whether its page is connected to this server.
    """

    number: int
    alias: str
    recruited: str | None
    standing: Standing
    simulated: bool
    stage: str
    position: int
    stages: int
    opened: float
    seen: float
    device: str | None
    latency: float | None
    restarts: int
    errors: int
    checks_failed: int
    connected: bool


def glance(study: Study, record: Record, now: float, *, connected: bool) -> Glance:
    """The session of ``record`` at a glance.

    Raises:
        NotNow: if its events cannot have happened in their order.
    """
    moments = record.moments(study)
    session, stages = moments[-1].after, plan_of(study)
    events = [kept.event for kept in record.events]
    checked = next((e for e in reversed(events) if isinstance(e, Checked)), None)
    seen = record.events[-1].time
    return Glance(
        number=record.row.id,
        alias=record.alias,
        recruited=record.row.participant,
        standing=standing(study, session.end, seen, now),
        simulated=record.is_simulated,
        stage=stage_name(study, stages[session.position]),
        position=session.position,
        stages=len(stages),
        opened=record.opened,
        seen=seen,
        device=session.device,
        latency=checked.latency if checked else None,
        restarts=sum(attempt.began.attempt > 1 for attempt in attempts_of(moments)),
        errors=sum(is_error(event) for event in events),
        checks_failed=failed_checks(study, events),
        connected=connected,
    )


def stage_name(study: Study, stage: Stage) -> str:
    """``"trial 2"``, or ``"debrief"`` where there is but one of its kind.

    Only some conditions have a briefing: who is there counts as still at their choice.
    """
    if stage.kind == "briefing":
        return "choice"
    alone = sum(other.kind == stage.kind for other in plan_of(study)) == 1
    return stage.kind if alone else str(stage)


def is_error(event: Event) -> bool:
    """Whether a page reported an error."""
    return isinstance(event, Noted) and event.what.startswith(ERROR)


def failed_checks(study: Study, events: Sequence[Event]) -> int:
    """Number of attention checks that were answered otherwise than asked for."""
    expected = {
        item.name: item.expected
        for scale in study.scales
        for item in scale.items
        if item.expected is not None
    }
    answers = {
        name: answer
        for event in events
        if isinstance(event, Answered)
        for name, answer in event.answers.items()
    }
    return sum(answers[name] != point for name, point in expected.items() if name in answers)
