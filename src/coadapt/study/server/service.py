"""What the server does, whoever asks: pages, websockets, the researcher."""

from __future__ import annotations

import asyncio
import secrets
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Literal

from sqlalchemy import Connection

from coadapt.study.protocol import Study
from coadapt.study.robots import Robots, model_of
from coadapt.study.server.entry import Entry
from coadapt.study.server.messages import Scene
from coadapt.study.server.scene import scene_of
from coadapt.study.server.standings import allocate_session, digest_of
from coadapt.study.session import Event, NotNow, Session, Stage, advance
from coadapt.study.session.events import (
    Allocated,
    Excluded,
    Opened,
    Readmitted,
)
from coadapt.study.store import (
    Addition,
    Conflict,
    Kept,
    Row,
    Store,
    StoreError,
    Taken,
    Writer,
)
from coadapt.study.store.schema import LONGEST_PARTICIPANT
from coadapt.study.store.store import set_place, set_setting

Status = Literal["open", "closed", "paused"]
"""``"closed"``: nobody new is let in; ``"paused"``: those under way have to wait too."""

LONGEST_PARAMETER = 500
"""Characters of a parameter of a link that are kept."""

MOST_CACHED = 5_000
"""Sessions in memory. Others are read again from the database when they are needed."""

STATUS_AGE = 1.0
"""Seconds for which the study's status is not asked for again; another process may change it."""


class Closed(Exception):
    """The study takes no new participants, or is paused."""


class Unreadable(StoreError):
    """The events of a session do not fit the protocol, as after a change of `study.toml`."""


class Service:
    """A study that is being run.

    To be used within one event loop. Several processes may serve the same database.

    Args:
        study: the protocol.
        robots: one for each condition and chosen goal.
        store: the database.
        directory: of the study.
    """

    def __init__(self, study: Study, robots: Robots, store: Store, directory: Path) -> None:
        self.study = study
        self.robots = robots
        self.store = store
        self.directory = directory
        self._scenes: dict[Stage, Scene] = {}
        self._writer = Writer(store)
        self._entries: dict[str, Entry] = {}
        self._status: Status = "open"
        self._status_until = 0.0
        self._tasks: set[asyncio.Task[Session]] = set()

    async def close(self) -> None:
        """Store what is waiting and end."""
        await self._writer.close()

    # Sessions

    async def open(self, parameters: Mapping[str, str], returning: str | None = None) -> str:
        """The key of a new session, or of the one that a returning person had.

        Args:
            parameters: of the link. Those that the study keeps are stored.
            returning: the key of their last session, from the cookie of their browser. A link that
                names a person counts more.

        Raises:
            Closed: if the person is new and the study is not open.
            StoreError: if it could not be stored.
        """
        wanted = self.study.recruitment
        kept = {
            name: parameters[name][:LONGEST_PARAMETER]
            for name in wanted.parameters
            if name in parameters
        }
        participant = kept.get(wanted.participant or "", "")[:LONGEST_PARTICIPANT] or None
        known: Row | None = None
        if participant is not None:
            known = await asyncio.to_thread(self.store.find, participant=participant)
        elif returning is not None:
            known = await asyncio.to_thread(self.store.find, key=returning)
        if known is not None:
            return known.key
        if await self.status() != "open":
            raise Closed
        key = secrets.token_urlsafe(24)

        def add(connection: Connection) -> None:
            self.store.add_session(connection, key, participant, Opened(parameters=kept))

        try:
            await self._writer.transaction(add)
        except Conflict:  # the same person has come twice at the same moment
            return await self.open(parameters, returning)
        return key

    async def session(self, key: str) -> Session:
        """Where a session stands, whichever process has moved it.

        Raises:
            KeyError: if there is none with this key.
            StoreError: if it cannot be read.
        """
        entry = await self._entry(key)
        async with entry.turnstile:
            await self._refresh(entry)
            return entry.session

    async def known_session(self, key: str) -> Session:
        """Where a session stood when this process heard of it last.

        Another may have moved it since. `record` finds that out. Raises as `session`.
        """
        entry = await self._entry(key)
        return entry.session if entry.fresh else await self.session(key)

    def scene(self, stage: Stage) -> Scene:
        """What the page draws in ``stage``, in which somebody steers."""
        if stage not in self._scenes:
            self._scenes[stage] = scene_of(self.study, model_of(self.robots), stage)
        return self._scenes[stage]

    async def events(self, key: str) -> list[Kept]:
        """All events of a session; raises as `session`."""
        entry = await self._entry(key)
        return await asyncio.to_thread(self.store.events, entry.row.id)

    async def record(
        self, key: str, *events: Event, attempt: tuple[int, int] | None = None
    ) -> Session:
        """The session after ``events``, which are safe in the database when this returns.

        Args:
            key: of the session.
            events: what happened; all of them are stored or none.
            attempt: ``(position, attempt)`` of the attempt that they belong to: nothing else must
                have begun since.

        Raises:
            KeyError: if there is no such session.
            NotNow: if they cannot happen now. Nothing is stored.
            StoreError: if they could not be stored.
        """
        entry = await self._entry(key)
        async with entry.turnstile:
            while True:
                known = entry.fresh
                if not known:
                    await self._refresh(entry)
                try:
                    session = entry.after(self.study, events, attempt)
                except NotNow:
                    if not known:
                        raise
                    entry.fresh = False  # perhaps another process knows more
                    continue
                if await self._store(entry, session, events):
                    return session

    def post(
        self,
        key: str,
        events: Sequence[Event],
        attempt: tuple[int, int],
        told: Callable[[Exception | None], None],
    ) -> None:
        """As `record`, for who does not wait in a task.

        Where this process knows the session and nothing else happens in it, which is so while
        somebody steers, there is nothing to wait for but the database. Otherwise it is `record`.

        Args:
            key, events, attempt: as for `record`.
            told: called later, with None once the events are safe, or with what `record` raises.
        """
        entry = self._entries.get(key)
        if entry is not None and entry.fresh and entry.turnstile.enter():
            try:
                self._post(entry, events, attempt, told)
            except (NotNow, StoreError):
                entry.turnstile.leave()
            else:
                return
        self._record_later(key, events, attempt, told)

    def _post(
        self,
        entry: Entry,
        events: Sequence[Event],
        attempt: tuple[int, int],
        told: Callable[[Exception | None], None],
    ) -> None:
        session = entry.after(self.study, events, attempt)
        addition = entry.addition(session, events)

        def stored(_: object, error: Exception | None) -> None:
            if error is None:
                entry.settle(session, len(events))
            entry.turnstile.leave()
            if isinstance(error, Taken):
                self._record_later(entry.row.key, events, attempt, told)
            else:
                told(error)

        self._writer.put(addition, stored)
        entry.fresh = False

    def _record_later(
        self,
        key: str,
        events: Sequence[Event],
        attempt: tuple[int, int],
        told: Callable[[Exception | None], None],
    ) -> None:
        def done(task: asyncio.Task[Session]) -> None:
            self._tasks.discard(task)
            told(StoreError("the server is stopping") if task.cancelled() else task.exception())  # pyright: ignore

        task = asyncio.get_running_loop().create_task(self.record(key, *events, attempt=attempt))
        self._tasks.add(task)  # the loop does not keep it alive
        task.add_done_callback(done)

    async def _store(self, entry: Entry, session: Session, events: Sequence[Event]) -> bool:
        """Store ``events``, which lead to ``session``; False if another process has stored some."""
        addition = entry.addition(session, events)
        # Whatever goes wrong now, the database knows best what is stored.
        entry.fresh = False
        try:
            await self._writer.append(addition)
        except Taken:
            return False
        entry.settle(session, len(events))
        return True

    async def allocate(self, key: str) -> Session:
        """The session after its allocation to a condition, one at a time over all processes.

        Without a condition if all quotas are met, or if the session has had its allocation.

        Raises:
            KeyError, StoreError: as `record`.
        """
        entry = await self._entry(key)
        async with entry.turnstile:
            await self._refresh(entry)

            def choose(connection: Connection) -> None:
                self.store.database.lock_allocation(connection)
                _allocate(self.study, self.store, connection, entry)

            if entry.session.condition is None and entry.session.choice is not None:
                entry.fresh = False
                with suppress(Conflict):  # another process was faster
                    await self._writer.transaction(choose)
                await self._refresh(entry)
            return entry.session

    # The researcher

    async def status(self) -> Status:
        """Whether the study is open."""
        if time.monotonic() > self._status_until:
            found = await asyncio.to_thread(self.store.setting, "status")
            self._status = "open" if found is None else found  # pyright: ignore
            self._status_until = time.monotonic() + STATUS_AGE
        return self._status

    async def set_status(self, status: Status) -> None:
        """Open, close or pause the study; other processes see it within a second."""

        def change(connection: Connection) -> None:
            set_setting(connection, "status", status)

        await self._writer.transaction(change)
        self._status, self._status_until = status, time.monotonic() + STATUS_AGE

    async def exclude(self, key: str, reason: str) -> Session:
        """Take a session out of the data; raises as `record`."""
        return await self.record(key, Excluded(reason=reason))

    async def readmit(self, key: str) -> Session:
        """Take that back; raises as `record`."""
        return await self.record(key, Readmitted())

    async def delete(self, key: str) -> None:
        """Delete a session and all that is known of it.

        Raises:
            KeyError: if there is none.
            StoreError: if it could not be deleted.
        """
        entry = await self._entry(key)
        async with entry.turnstile:

            def remove(connection: Connection) -> None:
                self.store.database.lock_allocation(connection)
                self.store.delete(connection, entry.row.id)

            await self._writer.transaction(remove)
            entry.fresh = False
            self._entries.pop(key, None)

    async def rows(self) -> list[Row]:
        """All sessions, in the order in which they were opened."""
        return await asyncio.to_thread(self.store.rows)

    # Memory and database

    async def _entry(self, key: str) -> Entry:
        entry = self._entries.pop(key, None)
        if entry is None:
            row = await asyncio.to_thread(self.store.find, key=key)
            if row is None:
                raise KeyError(key)
            entry = self._entries.pop(key, None) or Entry(row)
        self._entries[key] = entry  # the latest stands last
        if len(self._entries) > MOST_CACHED:
            self._forget()
        return entry

    def _forget(self) -> None:
        """Drop the oldest entries that nobody is using."""
        idle = [key for key, entry in self._entries.items() if not entry.turnstile.is_taken]
        for key in idle[: len(self._entries) - MOST_CACHED * 9 // 10]:
            del self._entries[key]

    async def _refresh(self, entry: Entry) -> None:
        """Bring ``entry`` up to date with the database."""
        # The last one that is known comes again: without it the session has been deleted.
        found = await asyncio.to_thread(self.store.events, entry.row.id, entry.sequence - 1)
        if not found:
            self._entries.pop(entry.row.key, None)
            raise KeyError(entry.row.key)
        try:
            for kept in found[min(entry.sequence, 1) :]:
                entry.session = advance(self.study, entry.session, kept.event)
                entry.sequence = kept.sequence
        except NotNow as error:
            raise Unreadable(f"event {entry.sequence + 1} does not fit: {error}") from error
        entry.digest = digest_of(entry.session)
        entry.fresh = True


def _allocate(study: Study, store: Store, connection: Connection, entry: Entry) -> None:
    """Allocate the session of ``entry``, within a transaction in which nobody else does."""
    condition = allocate_session(study, store, connection, entry.session)
    if condition is None:
        return
    event = Allocated(condition=condition)
    digest = digest_of(advance(study, entry.session, event))
    addition = Addition(entry.row.id, entry.sequence + 1, time.time(), [event], digest)
    store.append(connection, [addition])
    set_place(connection, entry.row.id)
