"""The rows that a session gives."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from typing import Any, TypeVar, cast

import msgspec

from coadapt.study.attempts import StoredAttempt, StoredStep, attempts_of
from coadapt.study.export.names import Names
from coadapt.study.export.tables import AnswerRow, EventRow, Participant, StepRow, TrialRow
from coadapt.study.order import shown_items
from coadapt.study.protocol import Item, Question
from coadapt.study.record import Moment, Record, Stored, standing
from coadapt.study.session.events import (
    KINDS,
    Answer,
    Answered,
    Belief,
    Checked,
    Event,
    Excluded,
    Opened,
    Pressed,
    encode_event,
)
from coadapt.study.session.machine import asked_questions
from coadapt.study.session.plan import plan_of

Kind = TypeVar("Kind", bound=Event)


class SessionRows:
    """One session as rows of the tables.

    Args:
        stored: the study.
        names: of goals, inputs and actions.
        record: what is stored of the session.
        now: seconds since 1970; by then it may be stale.

    Raises:
        NotNow: if the events cannot have happened in this order.
    """

    def __init__(self, stored: Stored, names: Names, record: Record, now: float) -> None:
        self._study, self._names, self._record = stored.study, names, record
        self._moments = record.moments(stored.study)
        self._attempts = attempts_of(self._moments)
        self._session = self._moments[-1].after
        self._stages = plan_of(stored.study)
        seen = record.events[-1].time
        self._standing = standing(stored.study, self._session.end, seen, now)
        # In a study with real participants too, simulated ones do not count.
        counts = not (stored.is_mixed and record.is_simulated)
        self._included = self._standing == "completed" and counts

    def _since(self, time: float) -> float:
        """``time`` in seconds since the session was opened."""
        return round(time - self._record.opened, 6)

    def participant(self) -> Participant:
        """The session itself."""
        study, session, record = self._study, self._session, self._record
        checked = _last(self._moments, Checked)
        answered = [e.time for e in record.events if isinstance(e.event, Answered)]
        condition = session.condition
        wrong = [
            session.answers[item.name] != item.expected
            for scale in study.scales
            for item in scale.items
            if item.expected is not None and item.name in session.answers
        ]
        excluded = _last(self._moments, Excluded)
        is_excluded = self._standing == "excluded"
        return Participant(
            participant=record.alias,
            number=record.row.id,
            included=self._included,
            standing=self._standing,
            reason=excluded.reason if excluded and is_excluded else None,
            simulated=record.is_simulated,
            opened=datetime.fromtimestamp(record.opened, UTC).isoformat(timespec="milliseconds"),
            duration=self._since(answered[-1]) if answered else None,
            stage=str(self._stages[session.position]),
            device=checked.device if checked else None,
            pad=(checked.pad or None) if checked else None,
            browser=checked.browser if checked else None,
            width=checked.width if checked else None,
            height=checked.height if checked else None,
            latency=checked.latency if checked else None,
            choice=self._names.goal(session.choice),
            condition=condition,
            robot=None if condition is None else study.condition(condition).robot,
            allocation=record.row.place,
            trials=len(session.results),
            changed=session.changed if session.results else None,
            checks=len(wrong),
            checks_failed=sum(wrong),
            restarts=sum(attempt.began.attempt > 1 for attempt in self._attempts),
        )

    def trials(self) -> Iterator[TrialRow]:
        """The trials that began."""
        last = {a.stage.number: a for a in self._attempts if a.stage.kind == "trial"}
        for number in sorted(last):
            yield self._trial(number, last[number])

    def _trial(self, number: int, attempt: StoredAttempt) -> TrialRow:
        names, session, end = self._names, attempt.session, attempt.finished
        assert session.choice is not None and session.condition is not None
        optimal = 1 - session.choice
        rewards = self._study.rewards
        reward = None
        if end is not None:
            worth = rewards.optimal if end.goal == optimal else rewards.other
            reward = 0.0 if end.goal is None else worth
        steps = [step.stepped for step in attempt.steps]
        first = attempt.presses[0].time if attempt.presses else None
        return TrialRow(
            participant=self._record.alias,
            trial=number,
            condition=session.condition,
            robot=self._study.condition(session.condition).robot,
            device=_device_of(attempt) or session.device,
            choice=names.goals[session.choice],
            optimal=names.goals[optimal],
            finished=end is not None,
            goal=names.goal(end.goal) if end else None,
            at_optimal=end.goal == optimal if end else None,
            reward=reward,
            steps=len(steps),
            attempts=attempt.began.attempt,
            wanted=names.goal(end.wanted) if end else None,
            changed=end.wanted not in (None, session.choice) if end else None,
            inputs=sum(step.input is not None for step in steps),
            disagreements=sum(names.is_disagreement(s.input, s.action) for s in steps),
            matched=sum(step.matched is True for step in steps),
            belief_alpha=_over_alpha(end.forecast) if end else None,
            began=self._since(attempt.began_at),
            duration=_rounded(attempt.finished_at, attempt.began_at),
            first_input=_rounded(first, attempt.began_at),
        )

    def steps(self) -> Iterator[StepRow]:
        """The steps of all attempts."""
        for attempt in self._attempts:
            for step in attempt.steps:
                yield self._step(attempt, step)

    def _step(self, attempt: StoredAttempt, step: StoredStep) -> StepRow:
        names, stepped, pressed = self._names, step.stepped, step.pressed
        cause = cast("Pressed", pressed.event) if pressed else None
        return StepRow(
            participant=self._record.alias,
            stage=attempt.stage.kind,
            number=attempt.stage.number,
            attempt=attempt.began.attempt,
            counts=attempt.finished is not None,
            step=stepped.step,
            time=self._since(step.time),
            state=stepped.state,
            window=stepped.window,
            input=names.input(stepped.input),
            action=names.action(stepped.action),
            planned=names.action(stepped.planned),
            agreement=stepped.agreement,
            matched=stepped.matched,
            reached=stepped.reached,
            belief=stepped.belief,
            device=cause.device if cause else None,
            input_time=self._since(pressed.time) if pressed else None,
            page_time=cause.page_time if cause else None,
            device_time=cause.device_time if cause else None,
        )

    def answers(self) -> Iterator[AnswerRow]:
        """The answers, in the order in which they were shown."""
        study, session = self._study, self._session
        for moment in self._moments:
            event = moment.kept.event
            if not isinstance(event, Answered):
                continue
            if event.stage.kind == "scale":
                scale = study.scales[event.stage.number - 1]
                shown: Sequence[Item | Question] = shown_items(scale, self._record.key)
                named, labels = scale.name, scale.points
            else:
                shown, named, labels = asked_questions(study, session), None, ()
            for i, question in enumerate(shown):
                yield AnswerRow(
                    participant=self._record.alias,
                    item=question.name,
                    scale=named,
                    position=i + 1,
                    time=self._since(moment.kept.time),
                    **_answer(question, event.answers[question.name], labels),
                )

    def events(self) -> Iterator[EventRow]:
        """All events, without what names the person."""
        for kept, before, _ in self._moments:
            data = encode_event(_nameless(kept.event))
            yield EventRow(
                participant=self._record.alias,
                sequence=kept.sequence,
                time=self._since(kept.time),
                stage=str(self._stages[before.position]),
                event=KINDS[type(kept.event)],
                data=data.decode(),
            )

    def as_json(self) -> bytes:
        """The session with all its events, a JSON object on one line."""
        entries = [
            {
                "sequence": kept.sequence,
                "time": self._since(kept.time),
                **msgspec.to_builtins(_nameless(kept.event)),
            }
            for kept in self._record.events
        ]
        participant = msgspec.to_builtins(self.participant())
        return msgspec.json.encode({**participant, "events": entries})


def _answer(question: Item | Question, answer: Answer, labels: Sequence[str]) -> dict[str, Any]:
    """What an answer says: all columns that depend on it."""
    options = question.choices if isinstance(question, Question) else labels
    value = answer if isinstance(answer, int) else None
    score = correct = None
    if isinstance(question, Question):
        kind = "choice" if options else "text"
    elif question.expected is not None:
        kind, correct = "check", value == question.expected
    else:
        kind = "rating"
        score = len(options) + 1 - value if value and question.reversed else value
    return {
        "kind": kind,
        "value": value,
        "score": score,
        "points": len(options) or None,
        "label": None if value is None else options[value - 1],
        "text": answer if isinstance(answer, str) else None,
        "correct": correct,
    }


def _last(moments: Sequence[Moment], kind: type[Kind]) -> Kind | None:
    found = (m.kept.event for m in reversed(moments))
    return next((event for event in found if isinstance(event, kind)), None)


def _nameless(event: Event) -> Event:
    return msgspec.structs.replace(event, parameters={}) if isinstance(event, Opened) else event


def _device_of(attempt: StoredAttempt) -> str | None:
    """What most of the inputs came from."""
    devices = Counter(e.event.device for e in attempt.presses if isinstance(e.event, Pressed))
    return devices.most_common(1)[0][0] if devices else None


def _over_alpha(belief: Belief | None) -> tuple[float, ...] | None:
    return None if belief is None else tuple(math.fsum(row) for row in belief)


def _rounded(later: float | None, earlier: float) -> float | None:
    return None if later is None else round(later - earlier, 6)
