"""All that is asked of the database. Functions with a connection run within its transaction."""

from __future__ import annotations

import time
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
from sqlalchemy import Connection, Select, case, func, insert, inspect, select, update

from coadapt.errors import InputError
from coadapt.study.session import Event, decode_event, encode_event
from coadapt.study.session.events import KINDS, Noted
from coadapt.study.store.database import Database, Durability, EventRow, StoreError
from coadapt.study.store.schema import EVENTS, FORMAT, METADATA, SESSIONS, SETTINGS

FILE = "study.db"
"""The database of a study's directory where no other is named."""

DELETED = "deleted"
"""Name of the setting that holds the times of all deletions."""

REMOVED = "removed"
"""Name of the setting that holds the time of the last removal of simulated sessions."""

_ENCODER = msgspec.json.Encoder()


class Kept(NamedTuple):
    """An event as stored.

    Attributes:
        sequence: number in its session, from 1.
        time: when, in seconds since 1970, by the server's clock.
        event: what happened.
    """

    sequence: int
    time: float
    event: Event


class Digest(msgspec.Struct, frozen=True):
    """What the events of a session say that is asked of all sessions at once."""

    condition: str | None = None
    choice: int | None = None
    device: str | None = None
    end: str | None = None


class Row(msgspec.Struct, frozen=True):
    """A session in the table of sessions.

    Attributes:
        id: its number in this database.
        key: the unguessable part of the participant's link.
        created: when, in seconds since 1970.
        participant: what a recruitment service calls the person, or None.
        place: in the order of allocation, from 1; None before.
        digest: what its events say.
        seen: time of its last event.
    """

    id: int
    key: str
    created: float
    participant: str | None
    place: int | None
    digest: Digest
    seen: float


class Addition(NamedTuple):
    """Events to append to a session.

    Attributes:
        session: ``id`` of its row.
        first: sequence number of the first of them.
        time: when they happened.
        events: the events.
        digest: what all events of the session say then, if it is something new.
    """

    session: int
    first: int
    time: float
    events: Sequence[Event]
    digest: Digest | None = None


class Store:
    """The database of a study.

    Args:
        url: see `Database`.
        durability: what stored data survive.

    Raises:
        InputError: if there is no such database, or one of another format.
    """

    def __init__(self, url: str, durability: Durability = "power") -> None:
        self.database = Database(url, durability)
        try:
            self._make()
        except StoreError as error:
            self.close()
            raise InputError(f"the database cannot be used: {error}") from error

    @staticmethod
    def url_in(directory: Path) -> str:
        """The URL of the database file in the study's ``directory``."""
        return f"sqlite:///{directory.absolute() / FILE}"

    def close(self) -> None:
        """Close all connections."""
        self.database.close()

    def _make(self) -> None:
        """Make the tables unless they are there; see whether they are ours."""
        with self.database.writing() as connection:
            self.database.lock_allocation(connection)
            if not inspect(connection).has_table(SETTINGS.name):
                METADATA.create_all(connection)
                set_setting(connection, "format", str(FORMAT))
            found = get_setting(connection, "format")
        if found != str(FORMAT):
            self.close()
            raise InputError(f"found a database of format {found}, expected format {FORMAT}")

    # Reading

    def setting(self, name: str) -> str | None:
        """The value of a setting, or None."""
        with self.database.reading() as connection:
            return get_setting(connection, name)

    def settings(self) -> dict[str, str]:
        """All settings."""
        with self.database.reading() as connection:
            rows = connection.execute(select(SETTINGS.c.name, SETTINGS.c.value))
            return {name: value for name, value in rows}

    def find(
        self, *, key: str | None = None, participant: str | None = None, number: int | None = None
    ) -> Row | None:
        """The session with this key, participant or ``id``; None if there is none."""
        if number is not None:
            where = SESSIONS.c.id == number
        else:
            where = SESSIONS.c.key == key if key else SESSIONS.c.participant == participant
        with self.database.reading() as connection:
            row = connection.execute(_ROWS.where(where)).first()
        return None if row is None else _row(row)

    def events(self, session: int, after: int = 0) -> list[Kept]:
        """The events of the session with this ``id`` behind the first ``after``, in order."""
        with self.database.reading() as connection:
            return get_events(connection, session, after)

    def rows(self) -> list[Row]:
        """All sessions, in the order in which they were opened."""
        with self.database.reading() as connection:
            return [_row(row) for row in connection.execute(_ROWS.order_by(SESSIONS.c.id))]

    def all_events(self) -> Iterator[tuple[Row, list[Kept]]]:
        """Every session with its events, one session at a time in memory."""
        for row in self.rows():
            yield row, self.events(row.id)

    def noted(self, what: str) -> set[str]:
        """The keys of the sessions with the bare event ``Noted(what=what)``."""
        data = encode_event(Noted(what=what)).decode()
        query = (
            select(SESSIONS.c.key)
            .join(EVENTS, EVENTS.c.session == SESSIONS.c.id)
            .where(EVENTS.c.kind == "noted", EVENTS.c.data == data)
        )
        with self.database.reading() as connection:
            return set(connection.execute(query).scalars())

    def deleted(self) -> tuple[float, ...]:
        """When sessions were deleted, in seconds since 1970: all that is left of them."""
        return _decode_times(self.setting(DELETED))

    def removed(self) -> float:
        """When simulated sessions were last removed, in seconds since 1970; 0 if never."""
        return float(self.setting(REMOVED) or 0)

    # Writing

    def append(self, connection: Connection, additions: Sequence[Addition]) -> None:
        """Append events to sessions.

        Raises:
            Conflict: from `Database.writing`, if a sequence number is taken, or a session has been
                deleted.
        """
        rows = [
            EventRow(
                a.session, a.first + i, a.time, KINDS[type(event)], encode_event(event).decode()
            )
            for a in additions
            for i, event in enumerate(a.events)
        ]
        self.database.insert_events(connection, rows)
        for addition in additions:
            if addition.digest is not None:
                values = msgspec.structs.asdict(addition.digest)
                this = SESSIONS.c.id == addition.session
                connection.execute(update(SESSIONS).where(this).values(values))

    def add_session(
        self, connection: Connection, key: str, participant: str | None, event: Event
    ) -> None:
        """A new session with its first event.

        Raises:
            Conflict: from `Database.writing`, if there is one with this key or participant.
        """
        now = time.time()
        new = {"key": key, "created": now, "participant": participant}
        done = connection.execute(insert(SESSIONS).values(new).returning(SESSIONS.c.id))
        self.append(connection, [Addition(done.scalar_one(), 1, now, [event])])

    def allotted(self, connection: Connection, stale: float) -> list[tuple[Digest, bool, int]]:
        """All sessions that have a condition, counted by what is asked of them.

        Args:
            connection: of the transaction.
            stale: time before which a last event is too old.

        Returns:
            For each kind of session: what its events say; whether it is stale, that is neither
            ended nor alive; how many there are.
        """
        is_old = case((SESSIONS.c.end.is_not(None), 0), (stale > _SEEN, 1), else_=0).label("is_old")
        kinds = select(
            SESSIONS.c.condition, SESSIONS.c.choice, SESSIONS.c.device, SESSIONS.c.end, is_old
        ).where(SESSIONS.c.place.is_not(None))
        of_one = kinds.subquery().c
        query: Select[Any] = select(*of_one, func.count()).group_by(*of_one)
        found = connection.execute(query)
        return [(Digest(*row[:4]), bool(row[4]), row[5]) for row in found]  # pyright: ignore

    def delete(self, connection: Connection, session: int) -> None:
        """Delete the session with this ``id`` and all its events; that it was done is kept."""
        times = (*_decode_times(get_setting(connection, DELETED)), time.time())
        set_setting(connection, DELETED, _ENCODER.encode(times).decode())
        self._erase(connection, session)

    def remove_simulated(self, connection: Connection, sessions: Collection[str]) -> None:
        """Delete the sessions with these keys, which no real person took part in."""
        ids = select(SESSIONS.c.id, SESSIONS.c.key)
        for session, key in connection.execute(ids).all():
            if key in sessions:
                self._erase(connection, session)
        set_setting(connection, REMOVED, repr(time.time()))

    def _erase(self, connection: Connection, session: int) -> None:
        connection.execute(EVENTS.delete().where(EVENTS.c.session == session))
        connection.execute(SESSIONS.delete().where(SESSIONS.c.id == session))


def set_place(connection: Connection, session: int) -> None:
    """Give the session with this ``id`` the next place in the order of allocation."""
    last = select(func.coalesce(func.max(SESSIONS.c.place), 0)).scalar_subquery()
    place = connection.execute(select(last + 1)).scalar_one()
    connection.execute(update(SESSIONS).where(SESSIONS.c.id == session).values(place=place))


def get_events(connection: Connection, session: int, after: int = 0) -> list[Kept]:
    """As `Store.events`."""
    query = (
        select(EVENTS.c.sequence, EVENTS.c.time, EVENTS.c.data)
        .where(EVENTS.c.session == session, EVENTS.c.sequence > after)
        .order_by(EVENTS.c.sequence)
    )
    return [
        Kept(sequence, when, decode_event(data))
        for sequence, when, data in connection.execute(query)
    ]


def get_setting(connection: Connection, name: str) -> str | None:
    """The value of a setting, or None."""
    query = select(SETTINGS.c.value).where(SETTINGS.c.name == name)
    return connection.execute(query).scalar()


def set_setting(connection: Connection, name: str, value: str) -> None:
    """Give a setting a value."""
    this = SETTINGS.c.name == name
    if connection.execute(update(SETTINGS).where(this).values(value=value)).rowcount == 0:
        connection.execute(insert(SETTINGS).values(name=name, value=value))


def _decode_times(setting: str | None) -> tuple[float, ...]:
    return msgspec.json.decode(setting or "[]", type=tuple[float, ...])


_LAST = EVENTS.alias()

_SEEN = (
    select(_LAST.c.time)
    .where(_LAST.c.session == SESSIONS.c.id)
    .order_by(_LAST.c.sequence.desc())
    .limit(1)
    .scalar_subquery()
)
"""Time of the last event of a session."""

_ROWS = select(
    SESSIONS.c.id,
    SESSIONS.c.key,
    SESSIONS.c.created,
    SESSIONS.c.participant,
    SESSIONS.c.place,
    SESSIONS.c.condition,
    SESSIONS.c.choice,
    SESSIONS.c.device,
    SESSIONS.c.end,
    _SEEN,
)


def _row(row: Sequence[object]) -> Row:
    number, key, created, participant, place, *digest, seen = row
    return Row(number, key, created, participant, place, Digest(*digest), seen)  # pyright: ignore
