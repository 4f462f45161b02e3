"""What the store says of notes, deletions and removals."""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest

from coadapt.study.session.events import Noted, Opened
from coadapt.study.store import Addition, Store


@pytest.fixture
def store(url: str) -> Iterator[Store]:
    store = Store(url)
    with store.database.writing() as connection:
        for key in ("one", "two", "three"):
            store.add_session(connection, key, f"person {key}", Opened(parameters={}))
    yield store
    store.close()


def note(store: Store, key: str, event: Noted) -> None:
    row = store.find(key=key)
    assert row is not None
    with store.database.writing() as connection:
        last = store.events(row.id)[-1].sequence
        store.append(connection, [Addition(row.id, last + 1, time.time(), [event])])


def test_sessions_with_a_bare_note(store: Store) -> None:
    note(store, "two", Noted(what="simulated"))
    note(store, "three", Noted(what="simulated", text="says the page"))
    note(store, "one", Noted(what="alive"))
    assert store.noted("simulated") == {"two"}


def test_of_a_deleted_session_only_the_time_is_left(store: Store) -> None:
    assert store.deleted() == ()
    row = store.find(key="two")
    assert row is not None
    before = time.time()
    with store.database.writing() as connection:
        store.delete(connection, row.id)
    (deleted,) = store.deleted()
    assert before <= deleted <= time.time()
    assert store.find(key="two") is None and store.events(row.id) == []
    assert [row.key for row in store.rows()] == ["one", "three"]
    assert "two" not in str(store.settings())


def test_removed_sessions_are_not_counted_as_deleted(store: Store) -> None:
    assert store.removed() == 0
    with store.database.writing() as connection:
        store.remove_simulated(connection, {"one", "three"})
    assert [row.key for row in store.rows()] == ["two"]
    assert store.deleted() == () and store.removed() > 0


def test_a_session_by_its_number(store: Store) -> None:
    row = store.find(key="three")
    assert row is not None
    assert store.find(number=row.id) == row
    assert store.find(number=10_000) is None
