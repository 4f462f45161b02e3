"""A session in memory, beside what the database holds of it."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field

from coadapt.study.protocol import Study
from coadapt.study.server.standings import digest_of
from coadapt.study.server.turnstile import Turnstile
from coadapt.study.session import BEGINNING, Event, NotNow, Session, advance
from coadapt.study.session.events import Began, Noted, Pressed
from coadapt.study.store import Addition, Digest, Row

MOST_EVENTS = 100_000
"""Of a session, beyond which its page can add no more inputs and notes: hours of steering."""


@dataclass
class Entry:
    """A session in memory.

    Attributes:
        row: in the table of sessions.
        session: after its first ``sequence`` events.
        digest: what they say that is asked of all sessions at once.
        fresh: whether memory and database are known to have been the same; another process may
            have written since.
        turnstile: who reads or writes it is in there.
    """

    row: Row
    session: Session = BEGINNING
    sequence: int = 0
    digest: Digest = field(default_factory=Digest)
    fresh: bool = False
    turnstile: Turnstile = field(default_factory=Turnstile)

    def after(
        self, study: Study, events: Sequence[Event], attempt: tuple[int, int] | None
    ) -> Session:
        """The session after ``events`` of its ``attempt``.

        Raises:
            NotNow: if they cannot happen now, or another attempt has begun.
        """
        if self.sequence >= MOST_EVENTS and isinstance(events[0], Began | Pressed | Noted):
            raise NotNow("too much has happened in this session")
        session = self.session
        if attempt is not None and attempt != (session.position, session.attempt):
            raise NotNow("another attempt has begun")
        for event in events:
            session = advance(study, session, event)
        return session

    def addition(self, session: Session, events: Sequence[Event]) -> Addition:
        """What is to be stored so that it becomes ``session`` by ``events``."""
        digest = self.digest if session is self.session else digest_of(session)
        news = None if digest == self.digest else digest
        return Addition(self.row.id, self.sequence + 1, time.time(), events, news)

    def settle(self, session: Session, count: int) -> None:
        """So many events have been stored, and it is ``session`` now."""
        if session is not self.session:
            self.session, self.digest = session, digest_of(session)
        self.sequence += count
        self.fresh = True
