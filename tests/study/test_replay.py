"""Replaying a study: what was computed comes out again, and what was changed is found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import msgspec
import pytest

from coadapt.study.record import Record, Stored
from coadapt.study.replay import replay
from coadapt.study.session import Stage
from coadapt.study.session.events import (
    Allocated,
    Began,
    Event,
    Finished,
    Pressed,
    Stepped,
)
from tests.study.sessions import NOON, Driver, allocated_sessions, changed_study, small_study


def stored(records: Sequence[Record], **changes: object) -> Stored:
    directory, _, _ = small_study()
    return Stored(directory, changed_study(**changes), lambda: records)


def test_nothing_differs() -> None:
    records = allocated_sessions(7)
    _, _, robots = small_study()
    found = replay(stored(records), robots)
    assert found.differences == []
    assert found.sessions == found.allocations == 7
    # Two training sessions and three trials each.
    assert found.attempts == 7 * 5
    assert found.events == sum(len(record.events) for record in records)
    assert found.steps == sum(isinstance(k.event, Stepped) for r in records for k in r.events)


def test_attempts_that_were_broken_off_are_replayed_too() -> None:
    _, study, robots = small_study()
    driver = Driver(study, robots, "broken", 3, allotted="mutual_adaptation")
    driver.open()
    trial = Stage("trial", 2)
    driver.go(until=trial)
    driver.steer(trial, stop_after=2)
    driver.go()
    record = driver.record
    found = replay(stored([record]), robots)
    assert found.attempts == 6
    # The condition was given, not decided by the rules, which give another one to the first.
    assert {d.what for d in found.differences} <= {"allocation"}


def test_belief_that_is_carried() -> None:
    _, _, robots = small_study()
    study = changed_study(belief="carried")
    driver = Driver(study, robots, "carried", 5)
    driver.open()
    record = driver.go()
    assert replay(stored([record], belief="carried"), robots).differences == []
    wrong = replay(stored([record], belief="reset"), robots).differences
    assert {(d.what, d.where) for d in wrong} == {
        ("beginning", "trial 2, attempt 1"),
        ("beginning", "trial 3, attempt 1"),
    }


def nudged(belief: object) -> tuple[tuple[float, ...], ...]:
    """The belief with its first number in the next 64-bit number."""
    rows = [list(row) for row in belief]  # type: ignore[attr-defined]
    rows[0][0] = _next_up(rows[0][0])
    return tuple(map(tuple, rows))


def _next_up(x: float) -> float:
    import math

    return math.nextafter(x, math.inf)


CHANGES: dict[str, tuple[type, Callable[[Event], Event], str]] = {
    "one bit of a belief": (
        Stepped,
        lambda e: msgspec.structs.replace(e, belief=nudged(e.belief)),
        "decision",
    ),
    "an action": (
        Stepped,
        lambda e: msgspec.structs.replace(e, action=(e.action + 1) % 3),
        "decision",
    ),
    "an input nobody gave": (
        Stepped,
        lambda e: msgspec.structs.replace(e, input=None if e.input is not None else 0),
        "decision",
    ),
    "the goal reached": (
        Finished,
        lambda e: msgspec.structs.replace(e, goal=1 - e.goal),
        "end",
    ),
    "where it began": (Began, lambda e: msgspec.structs.replace(e, start=e.start + 1), "beginning"),
    "the condition": (Allocated, lambda _: Allocated(condition="no_adaptation"), "allocation"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_change_of_the_data_is_found(name: str) -> None:
    kind, change, what = CHANGES[name]
    records = list(allocated_sessions(2))
    _, _, robots = small_study()
    # The robot of the second session must be one that believes something.
    index = next(i for i, r in enumerate(records) if r.row.digest.condition != "no_adaptation")
    record = records[index]
    events = list(record.events)
    places = [
        i
        for i, kept in enumerate(events)
        if isinstance(kept.event, kind)
        and not (kind is Stepped and kept.event.belief is None)  # type: ignore[attr-defined]
        and not (kind is Finished and kept.event.stage.kind == "practice")  # type: ignore[attr-defined]
    ]
    i = places[0]
    changed = change(events[i].event)
    assert changed != events[i].event
    events[i] = events[i]._replace(event=changed)
    records[index] = replace(record, events=tuple(events))
    found = replay(stored(records), robots).differences
    assert found[0].participant == record.alias
    assert what in {d.what for d in found}


def test_events_in_an_impossible_order_are_found() -> None:
    record = allocated_sessions(1)[0]
    events = list(record.events)
    del events[1]  # the welcome page is never left
    found = replay(stored([replace(record, events=tuple(events))]), small_study()[2])
    assert [d.what for d in found.differences] == ["events"]
    assert found.attempts == 0


def test_an_input_without_a_press_is_found() -> None:
    record = allocated_sessions(1)[0]
    events = [kept for kept in record.events if not isinstance(kept.event, Pressed)]
    found = replay(stored([replace(record, events=tuple(events))]), small_study()[2])
    inputs = [d for d in found.differences if d.what == "input"]
    steps = [k.event for k in record.events if isinstance(k.event, Stepped)]
    assert len(inputs) == sum(step.input is not None for step in steps)


def test_allocations_before_a_deletion_cannot_be_checked() -> None:
    records = allocated_sessions(5)
    directory, study, robots = small_study()
    # The first is deleted when three have been allocated: what it counted for then is unknown.
    time = records[3].row.created
    found = replay(Stored(directory, study, lambda: records[1:], deleted=(time,)), robots)
    assert (found.allocations, found.unchecked) == (2, 2)
    assert time > NOON
