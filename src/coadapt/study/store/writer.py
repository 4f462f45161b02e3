"""One thread that writes, and commits together what arrives within a few milliseconds."""

from __future__ import annotations

import asyncio
import queue
import threading
import time
from collections.abc import Callable, Sequence
from typing import TypeVar

from sqlalchemy import Connection

from coadapt.study.store.database import Conflict, StoreError
from coadapt.study.store.store import Addition, Store

T = TypeVar("T")

DELAY = 0.003
"""Seconds from the first of a group to its commit."""

LARGEST_GROUP = 500

MOST_WAITING = 20_000


class Overloaded(StoreError):
    """Too much is waiting to be stored."""


class Taken(Exception):
    """Another process has written to the session, or deleted it; nothing was stored."""


class _Job:
    """Something to write, and who waits for it."""

    __slots__ = ("addition", "error", "result", "waiting", "work")

    def __init__(
        self,
        waiting: asyncio.Future[object],
        addition: Addition | None = None,
        work: Callable[[Connection], object] | None = None,
    ) -> None:
        self.waiting = waiting
        self.addition = addition
        self.work = work
        self.result: object = None
        self.error: Exception | None = None


class Writer:
    """Writes to ``store``. Whoever calls waits until their data are safe.

    To be used within one event loop.
    """

    def __init__(self, store: Store, delay: float = DELAY) -> None:
        self._store = store
        self._delay = delay
        self._jobs: queue.SimpleQueue[_Job | None] = queue.SimpleQueue()
        self._next: _Job | None = None  # taken from the queue, for the next group
        self._waiting = 0
        self._closing = False
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread = threading.Thread(target=self._run, name="writer", daemon=True)

    async def append(self, addition: Addition) -> None:
        """Append events to a session, committed together with those of others.

        Raises:
            Taken: if the sequence number is taken, or the session has been deleted.
            StoreError: if it could not be stored.
        """
        await self._wait(_Job(_future(), addition=addition))

    async def transaction(self, work: Callable[[Connection], T]) -> T:
        """What ``work`` returns, called on the writing thread in a transaction of its own.

        Raises:
            Conflict: see `Database.writing`.
            StoreError: if it could not be stored.
        """
        return await self._wait(_Job(_future(), work=work))  # pyright: ignore

    async def close(self) -> None:
        """Write what is waiting and end."""
        self._closing = True
        if self._loop is not None:
            self._jobs.put(None)
            await asyncio.to_thread(self._thread.join)

    async def _wait(self, job: _Job) -> object:
        if self._closing:
            raise StoreError("the server is stopping")
        if self._waiting >= MOST_WAITING:
            raise Overloaded("too much is waiting to be stored")
        if self._loop is None:
            self._loop = asyncio.get_running_loop()
            self._thread.start()
        self._waiting += 1
        self._jobs.put(job)
        return await job.waiting

    # On the thread

    def _run(self) -> None:
        assert self._loop is not None
        while group := self._group():
            self._write(group)
            self._loop.call_soon_threadsafe(self._tell, group)

    def _group(self) -> list[_Job]:
        """Appends that wait, or one job that wants a transaction of its own; none at the end."""
        first, self._next = self._next or self._jobs.get(), None
        if first is None:
            return []
        if first.work is not None:
            return [first]
        if not self._closing:
            time.sleep(self._delay)
        group = [first]
        while len(group) < LARGEST_GROUP:
            try:
                job = self._jobs.get_nowait()
            except queue.Empty:
                break
            if job is None:
                self._jobs.put(None)  # the end is for the next time
                break
            if job.work is not None:
                self._next = job
                break
            group.append(job)
        return group

    def _write(self, group: Sequence[_Job]) -> None:
        try:
            with self._store.database.writing() as connection:
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

    # In the event loop

    def _tell(self, group: Sequence[_Job]) -> None:
        self._waiting -= len(group)
        for job in group:
            if job.waiting.done():  # nobody waits any more
                continue
            if job.error is None:
                job.waiting.set_result(job.result)
            else:
                job.waiting.set_exception(job.error)


def _future() -> asyncio.Future[object]:
    return asyncio.get_running_loop().create_future()
