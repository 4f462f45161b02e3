"""One thread that writes, and commits together what has come since it began the commit before."""

from __future__ import annotations

import asyncio
import logging
import queue
import threading
from collections import deque
from collections.abc import Callable, Sequence
from typing import TypeVar

from sqlalchemy import Connection

from coadapt.study.store.checkpoints import Checkpoints
from coadapt.study.store.database import Conflict, StoreError
from coadapt.study.store.store import Addition, Store

log = logging.getLogger("coadapt.study")

T = TypeVar("T")

Told = Callable[[object, Exception | None], None]

DELAY = 0.002
"""Seconds for which the first of a group waits for others."""

LARGEST_GROUP = 500

MOST_WAITING = 20_000


class Overloaded(StoreError):
    """Too much is waiting to be stored."""


class Taken(Exception):
    """Another process has written to the session, or deleted it; nothing was stored."""


class _Job:
    """Something to write, and who is told what came of it: a result, or an error."""

    __slots__ = ("addition", "error", "result", "told", "work")

    def __init__(
        self,
        told: Told,
        addition: Addition | None = None,
        work: Callable[[Connection], object] | None = None,
    ) -> None:
        self.told = told
        self.addition = addition
        self.work = work
        self.result: object = None
        self.error: Exception | None = None


class Writer:
    """Writes to ``store``. Whoever calls waits until their data are safe.

    To be used within one event loop, which puts the groups together: the thread is woken once for
    each of them.

    Args:
        store: the database.
        delay: seconds for which the first of a group waits for others.
    """

    def __init__(self, store: Store, delay: float = DELAY) -> None:
        self._store = store
        self._connection = store.database.writing_often()
        self._checkpoints = Checkpoints(store.database)
        self._delay = delay
        self._jobs: deque[_Job] = deque()  # that wait for their group
        self._groups: queue.SimpleQueue[Sequence[_Job]] = queue.SimpleQueue()  # for the thread
        self._waiting = 0
        self._closing = False
        self._idle = asyncio.Event()  # neither does the thread write, nor is a group gathered
        self._idle.set()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread = threading.Thread(target=self._run, name="writer", daemon=True)

    async def append(self, addition: Addition) -> None:
        """Append events to a session, committed together with those of others.

        Raises:
            Taken: if the sequence number is taken, or the session has been deleted.
            StoreError: if it could not be stored.
        """
        waiting, told = _waiting()
        self.put(addition, told)
        await waiting

    def put(self, addition: Addition, told: Told) -> None:
        """As `append`, for who does not wait in a task.

        Args:
            addition: the events.
            told: called in the event loop with None and None once they are safe, or with what
                `append` raises.

        Raises:
            StoreError: if it cannot even wait to be stored. Then nobody is told.
        """
        self._put(_Job(told, addition=addition))

    async def transaction(self, work: Callable[[Connection], T]) -> T:
        """What ``work`` returns, called on the writing thread in a transaction of its own.

        Raises:
            Conflict: see `Database.writing`.
            StoreError: if it could not be stored.
        """
        waiting, told = _waiting()
        self._put(_Job(told, work=work))
        return await waiting  # pyright: ignore

    async def close(self) -> None:
        """Write what is waiting and end."""
        self._closing = True
        await self._idle.wait()
        if self._loop is not None:
            self._groups.put([])
            await asyncio.to_thread(self._thread.join)
            await asyncio.to_thread(self._checkpoints.stop)

    # In the event loop

    def _put(self, job: _Job) -> None:
        if self._closing:
            raise StoreError("the server is stopping")
        if self._waiting >= MOST_WAITING:
            raise Overloaded("too much is waiting to be stored")
        if self._loop is None:
            self._loop = asyncio.get_running_loop()
            self._thread.start()
            self._checkpoints.start()
        self._jobs.append(job)
        self._waiting += 1
        if self._idle.is_set():
            self._idle.clear()
            self._gather()

    def _gather(self) -> None:
        """Wait for others that want to be in the next group."""
        assert self._loop is not None
        self._loop.call_later(0.0 if self._closing else self._delay, self._write_next)

    def _write_next(self) -> None:
        """Let the thread write appends that wait, or one job with a transaction of its own."""
        jobs = self._jobs
        group = [jobs.popleft()]
        if group[0].work is None:
            while jobs and jobs[0].work is None and len(group) < LARGEST_GROUP:
                group.append(jobs.popleft())
        self._groups.put(group)

    def _written(self, group: Sequence[_Job]) -> None:
        self._waiting -= len(group)
        if self._jobs:
            self._gather()
        else:
            self._idle.set()
        for job in group:
            try:
                job.told(job.result, job.error)
            except Exception:  # the others are told all the same
                log.exception("what was stored could not be told")

    # On the thread

    def _run(self) -> None:
        assert self._loop is not None
        while group := self._groups.get():
            self._write(group)
            self._loop.call_soon_threadsafe(self._written, group)
        self._connection.close()

    def _write(self, group: Sequence[_Job]) -> None:
        try:
            with self._connection.transaction() as connection:
                work = group[0].work
                if work is None:
                    additions = [job.addition for job in group if job.addition is not None]
                    self._store.append(connection, additions)
                else:
                    group[0].result = work(connection)
        except Conflict as error:
            if len(group) > 1:  # who is it?
                for job in group:
                    self._write([job])
            elif group[0].work is None:
                group[0].error = Taken()
            else:
                group[0].error = error
        except Exception as error:
            for job in group:
                job.error = error


def _waiting() -> tuple[asyncio.Future[object], Told]:
    """Something to wait for, and how it is told."""
    waiting: asyncio.Future[object] = asyncio.get_running_loop().create_future()

    def told(result: object, error: Exception | None) -> None:
        if waiting.done():  # nobody waits any more
            return
        if error is None:
            waiting.set_result(result)
        else:
            waiting.set_exception(error)

    return waiting, told
