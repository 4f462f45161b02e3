"""What is stored of a session, and what it says of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Literal, NamedTuple, Self, cast

from coadapt.study.changes import Change, changes_in
from coadapt.study.protocol import Study
from coadapt.study.session.events import Noted
from coadapt.study.session.machine import advance
from coadapt.study.session.state import BEGINNING, Session
from coadapt.study.store import Kept, Row, Store

SIMULATED = "simulated"
"""`Noted.what` of a session that no real person takes part in."""

SERVED = "protocol"
"""The setting that holds protocol and task as they are for the participants."""

MINUTE = 60.0

Standing = Literal["completed", "active", "stale", "declined", "withdrawn", "excluded"]
"""What became of a session; ``stale``: without a sign of life for too long."""


class Moment(NamedTuple):
    """A stored event with the session before and after it."""

    kept: Kept
    before: Session
    after: Session


@dataclass(frozen=True)
class Record:
    """All that is stored of one session.

    Attributes:
        row: in the table of sessions.
        events: in the order of their numbers; at least one.
    """

    row: Row
    events: Sequence[Kept]

    @property
    def key(self) -> str:
        """The unguessable part of its link."""
        return self.row.key

    @property
    def alias(self) -> str:
        """What it is called where the key, with which one could get into it, must not be told."""
        return alias_of(self.row.key)

    @property
    def opened(self) -> float:
        """When it began, in seconds since 1970."""
        return self.events[0].time

    @property
    def is_simulated(self) -> bool:
        """Whether a program takes part in it."""
        return any(isinstance(e.event, Noted) and e.event.what == SIMULATED for e in self.events)

    def moments(self, study: Study) -> list[Moment]:
        """Every event with the session before and after it.

        Raises:
            NotNow: if the events cannot have happened in this order.
        """
        session, moments = BEGINNING, list[Moment]()
        for kept in self.events:
            after = advance(study, session, kept.event)
            moments.append(Moment(kept, session, after))
            session = after
        return moments


def alias_of(key: str) -> str:
    """What the session with this key is called where the key must not be told."""
    return sha256(key.encode()).hexdigest()[:12]


def standing(study: Study, end: str | None, seen: float, now: float) -> Standing:
    """What has become of a session by the time ``now``.

    Args:
        study: says when a session is stale.
        end: how it ended, as in `Session.end`.
        seen: time of its last event.
        now: as ``seen`` in seconds since 1970.
    """
    if end == "finished":
        return "completed"
    if end is not None:
        return cast("Standing", end)
    is_stale = now - seen > study.allocation.stale_minutes * MINUTE
    return "stale" if is_stale else "active"


@dataclass(frozen=True)
class Stored:
    """A study with what is stored of it.

    Attributes:
        directory: of the study.
        study: its protocol.
        records: gives its sessions, in the order in which they were opened, one at a time in
            memory.
        is_mixed: whether both real people and programs take part.
        deleted: when sessions were deleted, in seconds since 1970.
        removed: when simulated sessions were last removed; 0 if never.
        served: protocol and task as participants were last served them, JSON; None if never.
        changes: of the protocol, accepted since the first participant came.
    """

    directory: Path
    study: Study
    records: Callable[[], Iterable[Record]]
    is_mixed: bool = False
    deleted: tuple[float, ...] = ()
    removed: float = 0.0
    served: str | None = None
    changes: tuple[Change, ...] = ()

    @classmethod
    def of(cls, directory: Path, study: Study, store: Store) -> Self:
        """What ``store`` holds of ``study``.

        Raises:
            StoreError: if it cannot be read.
        """

        def records() -> Iterable[Record]:
            found = (Record(row, events) for row, events in store.all_events())
            return (record for record in found if record.events)  # others were deleted meanwhile

        simulated = len(store.noted(SIMULATED))
        is_mixed = 0 < simulated < len(store.rows())
        return cls(
            directory,
            study,
            records,
            is_mixed,
            store.deleted(),
            store.removed(),
            store.setting(SERVED),
            changes_in(store),
        )
