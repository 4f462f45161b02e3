"""What is stored of a session, and what it says of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from typing import Literal, NamedTuple

from coadapt.study.protocol import Study
from coadapt.study.session.events import Allocated, Event, Excluded, Noted, Readmitted
from coadapt.study.session.machine import advance
from coadapt.study.session.state import BEGINNING, Session

SIMULATED = "simulated"
"""`Noted.what` of a session that no real person takes part in."""

MINUTE = 60.0

Standing = Literal["completed", "active", "stale", "declined", "withdrawn", "excluded"]
"""What became of a session; ``stale``: without a sign of life for too long."""


class Entry(NamedTuple):
    """A stored event: its number in the session, and when, in seconds since 1970 by the server."""

    sequence: int
    time: float
    event: Event


class Moment(NamedTuple):
    """An entry with the session before and after it."""

    entry: Entry
    before: Session
    after: Session


@dataclass(frozen=True)
class Record:
    """All that is stored of one session.

    Attributes:
        key: of its link.
        entries: in the order of their numbers; at least one.
    """

    key: str
    entries: Sequence[Entry]

    @property
    def alias(self) -> str:
        """What it is called where the key, with which one could get into it, must not be told."""
        return sha256(self.key.encode()).hexdigest()[:12]

    @property
    def opened(self) -> float:
        """When it began, in seconds since 1970."""
        return self.entries[0].time

    @property
    def last_sign(self) -> float:
        """When something last happened in it that was not the researcher's doing."""
        theirs = [e.time for e in self.entries if not isinstance(e.event, Excluded | Readmitted)]
        return max(theirs, default=self.opened)

    @property
    def is_simulated(self) -> bool:
        """Whether a program takes part in it."""
        return any(isinstance(e.event, Noted) and e.event.what == SIMULATED for e in self.entries)

    @property
    def allocated(self) -> float | None:
        """When it was allocated to a condition."""
        times = (e.time for e in self.entries if isinstance(e.event, Allocated))
        return next(times, None)

    def moments(self, study: Study) -> list[Moment]:
        """Every entry with the session before and after it.

        Raises:
            NotNow: if the events cannot have happened in this order.
        """
        session, moments = BEGINNING, list[Moment]()
        for entry in self.entries:
            after = advance(study, session, entry.event)
            moments.append(Moment(entry, session, after))
            session = after
        return moments


def standing(study: Study, session: Session, last_sign: float, now: float) -> Standing:
    """What has become of ``session`` by the time ``now``.

    Args:
        study: says when a session is stale.
        session: as it is.
        last_sign: when something last happened in it.
        now: as ``last_sign`` in seconds since 1970.
    """
    if session.end == "finished":
        return "completed"
    if session.end is not None:
        return session.end
    is_stale = now - last_sign > study.allocation.stale_minutes * MINUTE
    return "stale" if is_stale else "active"
