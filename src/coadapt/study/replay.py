"""Everything a study computed, computed again from what is stored.

The robot's beliefs and decisions follow from the inputs, the allocation from who came and finished
when. A difference means that program, protocol or data are not those of the study.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Literal

import msgspec

from coadapt.study.allocation_replay import AllocationReplay
from coadapt.study.attempts import StoredAttempt, attempts_of
from coadapt.study.protocol import Study
from coadapt.study.record import Record, Stored
from coadapt.study.robots import Robots
from coadapt.study.seeds import attempt_rng
from coadapt.study.session import NotNow
from coadapt.study.session.events import Pressed
from coadapt.study.trial import Attempt, Practice

What = Literal["events", "input", "beginning", "decision", "end", "allocation"]
"""Where things differ: ``"events"``: they do not follow each other; ``"input"``: one that nobody
gave."""


class Difference(msgspec.Struct, frozen=True, kw_only=True):
    """Something that is stored otherwise than it is computed.

    Attributes:
        participant: the session's pseudonym.
        where: the stage, attempt and step.
        what: what differs.
        stored, computed: both, as text.
    """

    participant: str
    where: str
    what: What
    stored: str
    computed: str


@dataclass
class Replayed:
    """What was looked at, and all differences.

    Attributes:
        sessions, events, attempts, steps: how many were computed again.
        allocations: how many allocations were.
        unchecked: allocations that cannot be: a session that was deleted later may have counted.
        differences: what is stored otherwise than it is computed.
    """

    sessions: int = 0
    events: int = 0
    attempts: int = 0
    steps: int = 0
    allocations: int = 0
    unchecked: int = 0
    differences: list[Difference] = field(default_factory=list[Difference])


def replay(
    stored: Stored, robots: Robots, progress: Callable[[str], None] = lambda _: None
) -> Replayed:
    """Compute all sessions again.

    Args:
        stored: the study.
        robots: of the study, see `coadapt.study.robots.load_robots`.
        progress: is told what is being done.
    """
    done, study = Replayed(), stored.study
    allocations = AllocationReplay(study, max((*stored.deleted, stored.removed)))
    for record in stored.records():
        done.sessions += 1
        done.events += len(record.events)
        progress(f"Replaying: {done.sessions:,} sessions")
        try:
            moments = record.moments(study)
        except NotNow as error:
            problem = Difference(
                participant=record.alias,
                where="the session",
                what="events",
                stored="an event that cannot follow the ones before",
                computed=str(error),
            )
            done.differences.append(problem)
            continue
        allocations.add(record, moments)
        for attempt in attempts_of(moments):
            done.attempts += 1
            done.steps += len(attempt.steps)
            done.differences.extend(_differences(study, robots, record, attempt))
    progress("Replaying the allocation")
    for wrong in allocations.differences():
        done.differences.append(
            Difference(
                participant=wrong.alias,
                where=f"allocation {wrong.place}",
                what="allocation",
                stored=wrong.stored,
                computed=wrong.computed,
            )
        )
    done.allocations, done.unchecked = allocations.checked, allocations.unchecked
    return done


def attempt_again(
    study: Study, robots: Robots, key: str, stored: StoredAttempt
) -> Attempt | Practice:
    """The attempt as the server began it.

    Raises:
        KeyError: if the study has no such robot.
    """
    stage, number, session = stored.stage, stored.began.attempt, stored.session
    rng, most_steps = attempt_rng(key, stage, number), study.clock.most_steps
    if stage.kind == "practice":
        return Practice(next(iter(robots.values())).model, stage, number, rng, most_steps)
    robot = robots[session.condition or "", -1 if session.choice is None else session.choice]
    belief = session.forecast if study.belief == "carried" else None
    return Attempt(robot, stage, number, belief, rng, most_steps)


def _differences(
    study: Study, robots: Robots, record: Record, stored: StoredAttempt
) -> Iterator[Difference]:
    """Of one attempt. After the first wrong step nothing more can be said of it."""
    again = attempt_again(study, robots, record.key, stored)
    where = f"{stored.stage}, attempt {stored.began.attempt}"
    if again.began != stored.began:
        yield _difference(record, where, "beginning", stored.began, again.began)
        return
    for step in stored.steps:
        where_step = f"{where}, step {step.stepped.step}"
        if step.stepped.input is not None and step.pressed is None:
            given = [k.event.input for k in stored.presses if isinstance(k.event, Pressed)]
            yield _difference(record, where_step, "input", step.stepped.input, given)
        try:
            stepped = again.step(step.stepped.input)
        except ValueError as error:
            yield _difference(record, where_step, "decision", step.stepped, str(error))
            return
        if not _same(stepped, step.stepped):
            yield _difference(record, where_step, "decision", step.stepped, stepped)
            return
    if stored.finished is not None:
        computed = again.finished() if again.done else "it goes on"
        if not _same(computed, stored.finished):
            yield _difference(record, where, "end", stored.finished, computed)


def _same(a: object, b: object) -> bool:
    """Whether both are equal to the last bit; ``0.0`` is not ``-0.0``."""
    return msgspec.json.encode(a) == msgspec.json.encode(b)


def _difference(
    record: Record, where: str, what: What, stored: object, computed: object
) -> Difference:
    return Difference(
        participant=record.alias,
        where=where,
        what=what,
        stored=_text(stored),
        computed=_text(computed),
    )


def _text(value: object) -> str:
    return value if isinstance(value, str) else msgspec.json.encode(value).decode()
