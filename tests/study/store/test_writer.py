"""Group commit: who waits, for what, and what they are told."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine, Iterator
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import Connection, text

from coadapt.study.session.events import Noted, Opened
from coadapt.study.store import (
    Addition,
    Conflict,
    Overloaded,
    Row,
    Store,
    StoreError,
    Taken,
    Writer,
)
from coadapt.study.store import writer as module
from coadapt.study.store.store import set_setting


@pytest.fixture
def store(url: str) -> Iterator[Store]:
    store = Store(url)
    yield store
    store.close()


def rows(store: Store, n: int) -> list[Row]:
    with store.database.writing() as connection:
        for i in range(n):
            store.add_session(connection, f"key-{i}", None, Opened(parameters={}))
    return store.rows()


def note(row: Row, sequence: int, what: str = "a") -> Addition:
    return Addition(row.id, sequence, 1.0, [Noted(what=what)])


def count_commits(store: Store, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The number of sessions in each commit of appends."""
    sizes: list[int] = []
    append = store.append

    def counted(connection: Connection, additions: list[Addition]) -> None:
        sizes.append(len(additions))
        append(connection, additions)

    monkeypatch.setattr(store, "append", counted)
    return sizes


async def gather(*waiting: Coroutine[Any, Any, object]) -> list[object]:
    return await asyncio.gather(*waiting, return_exceptions=True)


def test_what_comes_together_is_committed_together(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    sizes = count_commits(store, monkeypatch)

    async def run() -> None:
        writer = Writer(store, delay=0.05)
        found = rows(store, 20)
        sizes.clear()
        await gather(*(writer.append(note(row, 2)) for row in found))
        assert all(len(store.events(row.id)) == 2 for row in found)  # stored when it returned
        await writer.close()

    asyncio.run(run())
    assert sizes == [20]


def test_a_conflict_is_told_to_whom_it_concerns(store: Store) -> None:
    async def run() -> None:
        writer = Writer(store, delay=0.05)
        found = rows(store, 3)
        with store.database.writing() as connection:  # as another process would
            store.append(connection, [note(found[1], 2, "theirs")])
        results = await gather(*(writer.append(note(row, 2, "ours")) for row in found))
        assert [type(result) for result in results] == [type(None), Taken, type(None)]
        notes = [store.events(row.id)[1].event for row in found]
        assert notes == [Noted(what="ours"), Noted(what="theirs"), Noted(what="ours")]
        await writer.close()

    asyncio.run(run())


def test_events_of_one_call_are_stored_all_or_none(store: Store) -> None:
    async def run() -> None:
        writer = Writer(store)
        (row,) = rows(store, 1)
        with store.database.writing() as connection:
            store.append(connection, [note(row, 3)])
        late = Addition(row.id, 2, 1.0, [Noted(what="b"), Noted(what="c")])
        assert [type(r) for r in await gather(writer.append(late))] == [Taken]
        assert [kept.sequence for kept in store.events(row.id)] == [1, 3]
        await writer.close()

    asyncio.run(run())


def test_order_is_kept_and_transactions_stand_alone(store: Store) -> None:
    async def run() -> None:
        writer = Writer(store, delay=0.02)
        (row,) = rows(store, 1)
        seen: list[int] = []

        def look(connection: Connection) -> str:
            query = text("SELECT count(*) FROM events")
            seen.append(connection.execute(query).scalar_one())
            return "looked"

        results = await gather(
            writer.append(note(row, 2)),
            writer.transaction(look),
            writer.append(note(row, 3)),
            writer.append(note(row, 4)),
            writer.transaction(look),
        )
        assert results == [None, "looked", None, None, "looked"]
        assert seen == [2, 4]
        await writer.close()

    asyncio.run(run())


def test_a_transaction_that_fails_tells_why_and_changes_nothing(store: Store) -> None:
    async def run() -> None:
        writer = Writer(store)

        def fail(connection: Connection) -> None:
            set_setting(connection, "a", "1")
            raise ZeroDivisionError

        def clash(connection: Connection) -> None:
            store.add_session(connection, "key-0", None, Opened(parameters={}))

        rows(store, 1)
        results = await gather(writer.transaction(fail), writer.transaction(clash))
        assert [type(result) for result in results] == [ZeroDivisionError, Conflict]
        assert store.setting("a") is None
        await writer.close()

    asyncio.run(run())


def test_closing_writes_what_waits_and_refuses_the_rest(store: Store) -> None:
    async def run() -> None:
        writer = Writer(store, delay=0.2)
        (row,) = rows(store, 1)
        waiting = asyncio.create_task(writer.append(note(row, 2)))
        await asyncio.sleep(0)
        await writer.close()
        await waiting
        assert len(store.events(row.id)) == 2
        with pytest.raises(StoreError, match="stopping"):
            await writer.append(note(row, 3))
        await Writer(store).close()  # one that never wrote

    asyncio.run(run())


def test_too_much_is_refused_at_once(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_WAITING", 5)

    async def run() -> None:
        writer = Writer(store, delay=0.05)
        found = rows(store, 8)
        results = await gather(*(writer.append(note(row, 2)) for row in found))
        assert [type(r) for r in results] == [type(None)] * 5 + [Overloaded] * 3
        await writer.append(note(found[5], 2))  # there is room again
        await writer.close()

    asyncio.run(run())


def test_who_stops_waiting_disturbs_nobody(store: Store) -> None:
    async def run() -> None:
        writer = Writer(store, delay=0.05)
        a, b = rows(store, 2)
        impatient = asyncio.create_task(writer.append(note(a, 2)))
        patient = asyncio.create_task(writer.append(note(b, 2)))
        await asyncio.sleep(0)
        impatient.cancel()
        await patient
        assert len(store.events(b.id)) == 2
        await writer.close()

    asyncio.run(run())


def test_a_full_disk_is_told_and_overcome(tmp_path: Path) -> None:
    # https://sqlite.org/pragma.html#pragma_max_page_count: beyond it a write fails as if the disk
    # were full. It holds for one connection, and the writer's is the only one that is open.
    store = Store(f"sqlite:///{tmp_path / 'study.db'}")

    def limit(pages: int) -> None:
        with store.database.writing() as connection:
            connection.execute(text(f"PRAGMA max_page_count = {pages}"))

    async def run() -> None:
        writer = Writer(store)
        (row,) = rows(store, 1)
        limit(1)  # no smaller than the file is
        large = Addition(row.id, 2, 1.0, [Noted(what="a", text="x" * 100_000)])
        with pytest.raises(StoreError, match="disk is full"):
            await writer.append(large)
        assert len(store.events(row.id)) == 1
        limit(1_000_000)
        await writer.append(large)
        assert store.events(row.id)[1].event == large.events[0]
        await writer.close()

    asyncio.run(run())
    store.close()


def test_postgresql_that_goes_away_is_told(postgres_url: str) -> None:
    store = Store(postgres_url)

    async def run() -> None:
        writer = Writer(store)
        (row,) = rows(store, 1)
        await writer.append(note(row, 2))

        def end(connection: Connection) -> None:  # the server ends the connection we write on
            own = connection.execute(text("SELECT pg_backend_pid()")).scalar_one()
            other = Store(postgres_url)
            with other.database.reading() as killer:
                killer.execute(text("SELECT pg_terminate_backend(:pid)"), {"pid": own})
            other.close()
            set_setting(connection, "a", "1")

        with pytest.raises(StoreError):
            await writer.transaction(end)
        await writer.append(note(row, 3))  # on a new connection
        assert [kept.sequence for kept in store.events(row.id)] == [1, 2, 3]
        assert store.setting("a") is None
        await writer.close()

    asyncio.run(run())
    store.close()
