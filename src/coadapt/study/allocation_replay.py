"""Whether each participant was allocated as the rules say."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from coadapt.study.allocation import Allotted, Standing, allocate
from coadapt.study.protocol import Study
from coadapt.study.record import MINUTE, Moment, Record
from coadapt.study.session.events import Allocated

UNDER_WAY = 2.0
"""Seconds. An event of another session that happened so shortly before may not have been stored
when the allocation was decided."""


class WrongAllocation(NamedTuple):
    """An allocation that the rules do not give.

    Attributes:
        alias: the session's pseudonym.
        place: in the order of allocation.
        stored, computed: names of conditions.
    """

    alias: str
    place: int
    stored: str
    computed: str


@dataclass(frozen=True)
class _Course:
    """What of a session the allocation of others depends on.

    Attributes:
        alias: the session's pseudonym.
        place: in the order of allocation.
        condition: that it was allocated to.
        covariates: that it was balanced by.
        allocated: when, in seconds since 1970.
        times: of all its events.
        ends: how it had ended after each of them.
    """

    alias: str
    place: int
    condition: str
    covariates: dict[str, str]
    allocated: float
    times: Sequence[float]
    ends: Sequence[str | None]

    def standing(self, study: Study, now: float, known_until: float) -> Standing:
        """At the time ``now``, by the events up to ``known_until``."""
        known = max(bisect_right(self.times, known_until), 1)
        end, seen = self.ends[known - 1], self.times[known - 1]
        if end == "finished":
            return "completed"
        is_stale = now - seen > study.allocation.stale_minutes * MINUTE
        return "lost" if end or is_stale else "active"


class AllocationReplay:
    """Collects sessions, then decides every allocation again.

    Args:
        study: gives the rules.
        last_deletion: when a session was last deleted, in seconds since 1970; 0 if none was.

    Attributes:
        checked: number of allocations decided again.
        unchecked: number of those that cannot be: what a deleted session counted for is unknown.
    """

    def __init__(self, study: Study, last_deletion: float) -> None:
        self._study = study
        self._last_deletion = last_deletion
        self._courses: list[_Course] = []
        self.checked = self.unchecked = 0

    def add(self, record: Record, moments: Sequence[Moment]) -> None:
        """Take in a session."""
        for kept, before, _ in moments:
            if isinstance(kept.event, Allocated):
                self._courses.append(
                    _Course(
                        alias=record.alias,
                        place=record.row.place or 0,
                        condition=kept.event.condition,
                        covariates={"choice": f"{before.choice}", "device": f"{before.device}"},
                        allocated=kept.time,
                        times=[m.kept.time for m in moments],
                        ends=[m.after.end for m in moments],
                    )
                )

    def differences(self) -> Iterator[WrongAllocation]:
        """The allocations that the rules do not give."""
        courses = sorted(self._courses, key=lambda course: course.place)
        for i, course in enumerate(courses):
            if course.allocated <= self._last_deletion:
                self.unchecked += 1
                continue
            self.checked += 1
            now = course.allocated
            computed = self._decide(courses[:i], course, now)
            if computed != course.condition:
                # Some event of the last moment may not have been stored yet.
                if self._decide(courses[:i], course, now - UNDER_WAY) == course.condition:
                    continue
                shown = computed or "none, all quotas are met"
                yield WrongAllocation(course.alias, course.place, course.condition, shown)

    def _decide(self, before: Sequence[_Course], course: _Course, known_until: float) -> str | None:
        allotted = [
            Allotted(
                other.condition,
                other.standing(self._study, course.allocated, known_until),
                other.covariates,
            )
            for other in before
        ]
        return allocate(self._study, allotted, course.covariates)
