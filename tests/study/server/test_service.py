"""The service on SQLite and PostgreSQL: alone, and as two processes with one database.

Two services with a store each share nothing but the database, like two processes.
"""

from __future__ import annotations

import asyncio
import time
from collections import Counter

import msgspec
import pytest

from coadapt.study.protocol import Allocation
from coadapt.study.server import service as module
from coadapt.study.server.service import Closed, Service, Unreadable
from coadapt.study.server.standings import digest_of, standing_of
from coadapt.study.server.steering import new_attempt
from coadapt.study.session import BEGINNING, NotNow, Session, Stage, replayed
from coadapt.study.session.events import Began, Chose, Consented, Noted, Read, Withdrew
from coadapt.study.store import StoreError
from tests.study.server.services import bring, serving, study_with

WELCOME, CHOICE = Stage("welcome"), Stage("choice")


async def kinds(service: Service, key: str) -> list[str]:
    return [type(kept.event).__name__ for kept in await service.events(key)]


def test_a_session_is_what_its_events_say(url: str) -> None:
    async def run() -> None:
        async with serving(url) as service:
            key = await service.open({"PROLIFIC_PID": "P1", "STUDY_ID": "S", "other": "x"})
            await bring(service, key, Stage("trial", 2))
            session = await service.session(key)
            events = [kept.event for kept in await service.events(key)]
            assert session == replayed(service.study, events)
            assert session.results[0].attempts == 1
            (row,) = await service.rows()
            assert events[0].parameters == {"PROLIFIC_PID": "P1", "STUDY_ID": "S"}  # type: ignore[union-attr]
            assert (row.participant, row.place) == ("P1", 1)
            assert row.digest == digest_of(session)
        async with serving(url) as again:  # after a restart
            assert await again.session(key) == session

    asyncio.run(run())


def test_who_returns_finds_their_session(url: str) -> None:
    async def run() -> None:
        async with serving(url) as service:
            first = await service.open({"PROLIFIC_PID": "P1"})
            anonymous = await service.open({})
            assert len({first, anonymous}) == 2
            assert await service.open({"PROLIFIC_PID": "P1"}) == first
            assert await service.open({}, returning=anonymous) == anonymous
            # The link names the person; the browser may be somebody else's.
            assert await service.open({"PROLIFIC_PID": "P1"}, returning=anonymous) == first
            second = await service.open({"PROLIFIC_PID": "P2"}, returning=first)
            assert second not in (first, anonymous)
            assert await service.open({}, returning="no such key") not in (first, anonymous, second)
            assert await service.open({"PROLIFIC_PID": ""}, returning=first) == first
            together = [service.open({"PROLIFIC_PID": "P3"}) for _ in range(5)]
            assert len(set(await asyncio.gather(*together))) == 1

    asyncio.run(run())


def test_keys_cannot_be_guessed(url: str) -> None:
    async def run() -> None:
        async with serving(url) as service:
            keys = [await service.open({}) for _ in range(20)]
            assert len(set(keys)) == 20
            assert {len(key) for key in keys} == {32}  # 24 bytes, 6 bits a character
            with pytest.raises(KeyError):
                await service.session("a")

    asyncio.run(run())


def test_what_does_not_fit_is_not_stored(url: str) -> None:
    async def run() -> None:
        async with serving(url) as service:
            key = await service.open({})
            before = await service.session(key)
            with pytest.raises(NotNow):
                await service.record(key, Read(stage=WELCOME), Consented())
            assert await service.session(key) == before
            assert await kinds(service, key) == ["Opened"]

    asyncio.run(run())


def test_many_at_once_are_stored_one_after_the_other(url: str) -> None:
    async def run() -> None:
        async with serving(url) as service:
            key = await service.open({})
            await service.session(key)  # from now on in memory
            await asyncio.gather(*(service.record(key, Noted(what=f"{i}")) for i in range(30)))
            events = await service.events(key)
            assert [kept.sequence for kept in events] == list(range(1, 32))
            assert [k.event.what for k in events[1:]] == [f"{i}" for i in range(30)]  # type: ignore[union-attr]

    asyncio.run(run())


def test_a_failure_to_store_leaves_the_session_as_it_was(
    url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def run() -> None:
        async with serving(url) as service:
            key = await service.open({})

            def fail(*_: object) -> None:
                raise StoreError("the disk is full")

            with monkeypatch.context() as patch:
                patch.setattr(service.store, "append", fail)
                with pytest.raises(StoreError):
                    await service.record(key, Read(stage=WELCOME))
            assert (await service.session(key)).position == 0
            assert (await service.record(key, Read(stage=WELCOME))).position == 1
            assert await kinds(service, key) == ["Opened", "Read"]

    asyncio.run(run())


def test_who_is_cancelled_while_it_is_stored_loses_nothing(url: str) -> None:
    async def run() -> None:
        async with serving(url) as service:
            key = await service.open({})
            task = asyncio.create_task(service.record(key, Read(stage=WELCOME)))
            await asyncio.sleep(0.001)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            await service.record(key, Noted(what="after"))
            session = await service.session(key)
            events = [kept.event for kept in await service.events(key)]
            assert session == replayed(service.study, events)
            assert isinstance(events[-1], Noted)

    asyncio.run(run())


async def post(service: Service, key: str, what: str, attempt: tuple[int, int]) -> None:
    """`Service.post` a note, and wait until it is told."""
    waiting: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    def told(error: Exception | None) -> None:
        if error is None:
            waiting.set_result(None)
        else:
            waiting.set_exception(error)

    service.post(key, [Noted(what=what)], attempt, told)
    await waiting


def test_what_is_posted_is_stored_as_what_is_recorded(url: str) -> None:
    async def run() -> None:
        async with serving(url) as a, serving(url) as b:
            key = await a.open({})
            session = await bring(a, key, Stage("practice", 1))
            session = await a.record(key, began(a, key, session))
            where = (session.position, session.attempt)
            count = len(await a.events(key))
            # Among others that wait, in the order in which they came.
            await asyncio.gather(
                post(a, key, "0", where),
                a.record(key, Noted(what="1")),
                post(a, key, "2", where),
                post(a, key, "3", where),
            )
            await b.record(key, Noted(what="4"))
            await post(a, key, "5", where)  # a did not know of b's
            events = await a.events(key)
            assert [kept.sequence for kept in events] == list(range(1, count + 7))
            assert [k.event.what for k in events[count:]] == [f"{i}" for i in range(6)]  # type: ignore[union-attr]
            await b.record(key, began(b, key, await b.session(key)))
            with pytest.raises(NotNow, match="another attempt has begun"):
                await post(a, key, "too late", where)
            with pytest.raises(KeyError):
                await post(a, "nobody", "a", where)
            await b.delete(key)
            with pytest.raises(KeyError):
                await post(a, key, "deleted", where)

    asyncio.run(run())


def test_what_cannot_be_posted_leaves_the_session_as_it_was(
    url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def run() -> None:
        async with serving(url) as service:
            key = await service.open({})
            where = (0, 0)

            def fail(*_: object) -> None:
                raise StoreError("the disk is full")

            await post(service, key, "before", where)
            with monkeypatch.context() as patch:
                patch.setattr(service.store, "append", fail)
                with pytest.raises(StoreError, match="full"):
                    await post(service, key, "lost", where)
            await post(service, key, "after", where)
            notes = [k.event.what for k in (await service.events(key))[1:]]  # type: ignore[union-attr]
            assert notes == ["before", "after"]
            service_closed = service
        with pytest.raises(StoreError, match="stopping"):
            await post(service_closed, key, "too late", where)

    asyncio.run(run())


def test_two_processes_drive_one_session(url: str) -> None:
    async def run() -> None:
        async with serving(url) as a, serving(url) as b:
            key = await a.open({})
            await b.record(key, Read(stage=WELCOME))
            assert (await a.session(key)).position == 1
            await a.record(key, Noted(what="a"))
            await b.record(key, Noted(what="b"))  # b did not know of a's
            with pytest.raises(NotNow):
                await b.record(key, Read(stage=WELCOME))
            # Both at once: nothing is lost, nothing is stored twice.
            notes = [(s, f"{n}{i}") for i in range(10) for n, s in (("a", a), ("b", b))]
            await asyncio.gather(*(s.record(key, Noted(what=what)) for s, what in notes))
            events = await a.events(key)
            assert [kept.sequence for kept in events] == list(range(1, 25))
            stored = [k.event.what for k in events[4:]]  # type: ignore[union-attr]
            assert sorted(stored) == sorted(what for _, what in notes)
            # Only one can take a step of the protocol.
            await bring(a, key, Stage("consent"))
            results = await asyncio.gather(
                *(s.record(key, Consented()) for s in (a, b)), return_exceptions=True
            )
            assert {type(result) for result in results} == {NotNow, Session}

    asyncio.run(run())


def test_an_attempt_ends_when_another_process_begins_one(url: str) -> None:
    async def run() -> None:
        async with serving(url) as a, serving(url) as b:
            key = await a.open({})
            session = await bring(a, key, Stage("practice", 1))
            session = await a.record(key, began(a, key, session))
            where = (session.position, session.attempt)
            await a.record(key, Noted(what="mine"), attempt=where)
            session = await b.session(key)
            await b.record(key, began(b, key, session), attempt=where)
            with pytest.raises(NotNow, match="another attempt has begun"):
                await a.record(key, Noted(what="too late"), attempt=where)

    asyncio.run(run())


def began(service: Service, key: str, session: Session) -> Began:
    return new_attempt(service, key, session, Stage("practice", 1)).began


def test_allocation_is_balanced_over_processes(url: str) -> None:
    async def run() -> None:
        async with serving(url) as a, serving(url) as b:
            keys = [await a.open({}) for _ in range(14)]
            for key in keys:
                await bring(a, key, CHOICE)
                await a.record(key, Chose(goal=1))
            await asyncio.gather(
                *((a, b)[i % 2].allocate(key) for i, key in enumerate(keys)),
                *((b, a)[i % 2].allocate(key) for i, key in enumerate(keys)),  # twice
            )
            conditions = [(await a.session(key)).condition for key in keys]
            counts = Counter(conditions)
            assert sorted(counts.values()) == [4, 5, 5]
            rows = await a.rows()
            assert sorted(row.place for row in rows if row.place) == list(range(1, 15))
            for key in keys:
                assert (await kinds(a, key)).count("Allocated") == 1

    asyncio.run(run())


def test_the_quotas_end_the_allocation(url: str) -> None:
    study = study_with()
    conditions = tuple(msgspec.structs.replace(c, quota=1) for c in study.conditions)
    study = msgspec.structs.replace(study, conditions=conditions)

    async def run() -> None:
        async with serving(url, study) as service:
            keys = [await service.open({}) for _ in range(4)]
            for key in keys:
                await bring(service, key, CHOICE)
                assert (await service.allocate(key)).condition is None  # nothing is chosen yet
                await service.record(key, Chose(goal=1))
                await service.allocate(key)
            assert (await service.session(keys[3])).condition is None
            lost = (await service.session(keys[1])).condition
            await service.record(keys[1], Withdrew())
            assert (await service.allocate(keys[3])).condition == lost

    asyncio.run(run())


def test_stale_sessions_are_replaced_until_they_come_back(url: str) -> None:
    # One condition has one place; a stale session frees it.
    study = study_with()
    only = (msgspec.structs.replace(study.conditions[0], quota=1),)
    soon = Allocation(stale_minutes=0.2 / 60)
    study = msgspec.structs.replace(study, conditions=only, allocation=soon)

    async def run() -> None:
        async with serving(url, study) as service:
            a, b = [await service.open({}) for _ in range(2)]
            for key in (a, b):
                await bring(service, key, CHOICE)
                await service.record(key, Chose(goal=1))
            assert (await service.allocate(a)).condition is not None
            await service.record(a, Noted(what="alive"))
            assert (await service.allocate(b)).condition is None
            await asyncio.sleep(0.3)
            assert (await service.allocate(b)).condition is not None
            rows = {row.key: row for row in await service.rows()}
            now = time.time()
            assert standing_of(study, rows[a], now) == "lost"
            assert standing_of(study, rows[b], now) == "active"
            await service.record(a, Noted(what="alive"))
            rows = {row.key: row for row in await service.rows()}
            assert standing_of(study, rows[a], time.time()) == "active"

    asyncio.run(run())


def test_closed_and_paused(url: str) -> None:
    async def run() -> None:
        async with serving(url) as a, serving(url) as b:
            key = await a.open({"PROLIFIC_PID": "P1"})
            assert await b.status() == "open"
            await a.set_status("closed")
            assert await a.status() == "closed"
            with pytest.raises(Closed):
                await a.open({})
            assert await a.open({"PROLIFIC_PID": "P1"}) == key  # who has begun may go on
            await asyncio.sleep(module.STATUS_AGE)
            with pytest.raises(Closed):
                await b.open({})
            await b.set_status("open")
            assert await b.open({})

    asyncio.run(run())


def test_the_researcher_excludes_readmits_deletes(url: str) -> None:
    async def run() -> None:
        async with serving(url) as a, serving(url) as b:
            key, other = await a.open({"PROLIFIC_PID": "P1"}), await a.open({})
            await bring(a, key, CHOICE)
            assert (await a.exclude(key, "a test")).end == "excluded"
            with pytest.raises(NotNow):
                await a.record(key, Chose(goal=0))
            assert (await b.readmit(key)).end is None
            await a.record(key, Chose(goal=0))
            await b.delete(key)
            with pytest.raises(KeyError):
                await b.session(key)
            with pytest.raises(KeyError):
                await a.record(key, Noted(what="late"))  # a still had it in memory
            with pytest.raises(KeyError):
                await a.delete(key)
            assert [row.key for row in await a.rows()] == [other]
            assert await a.open({"PROLIFIC_PID": "P1"}) not in (key, other)

    asyncio.run(run())


def test_memory_is_bounded(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_CACHED", 10)

    async def run() -> None:
        async with serving(url) as service:
            keys = [await service.open({}) for _ in range(30)]
            for key in keys:
                await service.record(key, Read(stage=WELCOME))
            assert len(service._entries) <= 10
            for key in keys:  # the forgotten ones are read again
                assert (await service.session(key)).position == 1

    asyncio.run(run())


def test_events_that_do_not_fit_the_protocol_are_named(url: str) -> None:
    async def run() -> None:
        async with serving(url) as service:
            key = await service.open({})
            await bring(service, key, Stage("practice", 2))
        async with serving(url, study_with(practice=0)) as other:
            with pytest.raises(Unreadable, match="does not fit"):
                await other.session(key)
            assert await other.session(await other.open({})) != BEGINNING  # others go on

    asyncio.run(run())


def test_a_deletion_during_an_allocation_disturbs_nobody(url: str) -> None:
    async def run() -> None:
        async with serving(url) as a, serving(url) as b:
            key = await a.open({})
            await bring(a, key, CHOICE)
            await a.record(key, Chose(goal=0))
            await asyncio.gather(a.allocate(key), b.delete(key), return_exceptions=True)
            with a.store.database.reading() as connection:
                assert a.store.allotted(connection, 0.0) == []
            with pytest.raises(KeyError):
                await a.session(key)

    asyncio.run(run())
