"""The database of a study, on SQLite and on PostgreSQL."""

from __future__ import annotations

import gc
import sqlite3
import warnings
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sqlalchemy import text

from coadapt.errors import InputError
from coadapt.study.session import Event, Stage
from coadapt.study.session.events import Answered, Noted, Opened, Pressed, Read, Stepped
from coadapt.study.store import Addition, Conflict, Digest, Row, Store
from coadapt.study.store.database import parse_url
from coadapt.study.store.store import get_setting, set_place, set_setting

TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
EVENTS = st.one_of(
    st.builds(Noted, what=TEXTS, value=st.none() | NUMBERS, text=TEXTS),
    st.builds(Opened, parameters=st.dictionaries(TEXTS, TEXTS, max_size=3)),
    st.builds(
        Pressed,
        input=st.none() | st.integers(0, 9),
        device=st.just("gamepad"),
        sequence=st.integers(0, 2**53),
        page_time=NUMBERS,
        device_time=st.none() | NUMBERS,
    ),
    st.builds(
        Stepped,
        step=st.integers(0, 99),
        state=st.integers(0, 99),
        input=st.none(),
        action=st.integers(0, 3),
        reached=st.integers(0, 99),
        agreement=NUMBERS,
        matched=st.booleans(),
        belief=st.lists(st.lists(NUMBERS, max_size=3).map(tuple), max_size=3).map(tuple),
    ),
    st.builds(
        Answered,
        stage=st.just(Stage("scale", 1)),
        answers=st.dictionaries(TEXTS, st.none() | st.integers(1, 5) | TEXTS, max_size=3),
    ),
)


@pytest.fixture
def store(url: str) -> Iterator[Store]:
    store = Store(url)
    yield store
    store.close()


def add(store: Store, key: str, participant: str | None = None) -> Row:
    with store.database.writing() as connection:
        store.add_session(connection, key, participant, Opened(parameters={}))
    row = store.find(key=key)
    assert row is not None
    return row


def append(store: Store, *additions: Addition) -> None:
    with store.database.writing() as connection:
        store.append(connection, additions)


def test_a_new_database_is_empty(store: Store) -> None:
    assert store.rows() == []
    assert store.settings() == {"format": "1"}
    assert store.find(key="a") is None
    assert store.find(participant="a") is None


def test_opening_again_finds_what_was_stored(url: str) -> None:
    first = Store(url)
    row = add(first, "a", "P1")
    first.close()
    second = Store(url)
    assert second.rows() == [row] == [second.find(participant="P1")]
    assert [kept.event for kept in second.events(row.id)] == [Opened(parameters={})]
    second.close()


@given(st.lists(EVENTS, min_size=1, max_size=5))
@settings(max_examples=40)
def test_events_come_back_the_same(tmp_path_factory: pytest.TempPathFactory, events: list[Event]):
    store = Store(f"sqlite:///{tmp_path_factory.mktemp('db') / 'study.db'}")
    row = add(store, "a")
    append(store, Addition(row.id, 2, 17.25, events))
    kept = store.events(row.id, after=1)
    assert [k.event for k in kept] == events
    assert [k.sequence for k in kept] == list(range(2, 2 + len(events)))
    assert {k.time for k in kept} == {17.25}
    store.close()


def test_any_text_and_number_comes_back_the_same(store: Store) -> None:
    # NUL, quotes, backslashes, four-byte characters; the largest, smallest and longest doubles.
    row = add(store, "a")
    nasty = "\x00\x01\"'\\ \\u0000 \u2028 𝕊 %s :rows ?"
    events: list[Event] = [
        Noted(what=nasty, value=number, text=nasty)
        for number in (1.7976931348623157e308, 5e-324, 0.1 + 0.2, -0.0, 1e22)
    ]
    append(store, Addition(row.id, 2, 1.7e9 + 0.123456, events))
    kept = store.events(row.id, after=1)
    assert [k.event for k in kept] == events
    assert [repr(k.event) for k in kept] == [repr(e) for e in events]  # -0.0 == 0.0
    assert kept[0].time == pytest.approx(1.7e9 + 0.123456, abs=1e-6)


def test_a_sequence_number_is_given_once(store: Store) -> None:
    a, b = add(store, "a"), add(store, "b")
    with pytest.raises(Conflict):
        append(
            store,
            Addition(b.id, 2, 1.0, [Noted(what="b")]),
            Addition(a.id, 1, 1.0, [Noted(what="taken")]),
        )
    assert [len(store.events(row.id)) for row in (a, b)] == [1, 1]  # all or nothing


def test_participants_have_one_session(store: Store) -> None:
    add(store, "a", "P1")
    with pytest.raises(Conflict):
        add(store, "b", "P1")
    add(store, "c")
    add(store, "d")  # without a name there may be many
    assert [row.key for row in store.rows()] == ["a", "c", "d"]


def test_digest_and_place(store: Store) -> None:
    rows = [add(store, key) for key in "abc"]
    digest = Digest("one_way", 1, "switch", "finished")
    append(store, Addition(rows[2].id, 2, 5.0, [Read(stage=Stage("welcome"))], digest))
    with store.database.writing() as connection:
        for row in (rows[2], rows[0]):
            set_place(connection, row.id)
    assert [(row.key, row.place) for row in store.rows()] == [("a", 2), ("b", None), ("c", 1)]
    found = store.rows()[2]
    assert (found.digest, found.seen) == (digest, 5.0)


def test_allotted_sessions_are_counted_by_kind(store: Store) -> None:
    kinds = [
        *[(Digest("a", 1, "touch"), 5.0)] * 3,
        *[(Digest("a", 1, "touch"), 50.0)] * 2,
        *[(Digest("a", 1, "touch", "withdrawn"), 5.0)] * 2,
        (Digest("b", 0, "touch", "finished"), 5.0),
    ]
    rows = [add(store, f"{i}") for i in range(len(kinds) + 1)]  # the last is not allocated
    for row, (digest, seen) in zip(rows, kinds, strict=False):
        append(store, Addition(row.id, 2, seen, [Noted(what="x")], digest))
        with store.database.writing() as connection:
            set_place(connection, row.id)
    with store.database.reading() as connection:
        found = store.allotted(connection, 10.0)
    assert sorted(found, key=str) == sorted(
        [
            (Digest("a", 1, "touch"), True, 3),
            (Digest("a", 1, "touch"), False, 2),
            (Digest("a", 1, "touch", "withdrawn"), False, 2),
            (Digest("b", 0, "touch", "finished"), False, 1),
        ],
        key=str,
    )


def test_deleted_sessions_leave_nothing(store: Store, url: str, tmp_path: Path) -> None:
    row = add(store, "a", "SECRETPERSON")
    append(store, Addition(row.id, 2, 1.0, [Noted(what="SECRETANSWER")]))
    with store.database.writing() as connection:
        store.delete(connection, row.id)
    assert store.rows() == []
    assert store.events(row.id) == []
    assert len(store.deleted()) == 1
    new = add(store, "b", "SECRETPERSON")  # who was deleted can come again
    assert new.id != row.id
    with pytest.raises(Conflict):  # nothing can be added to what was deleted
        append(store, Addition(row.id, 3, 1.0, [Noted(what="late")]))
    if url.startswith("sqlite"):
        with store.database.writing() as connection:
            store.delete(connection, new.id)
        store.close()
        with closing(sqlite3.connect(tmp_path / "study.db")) as connection:
            connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        content = (tmp_path / "study.db").read_bytes()
        assert b"SECRETANSWER" not in content  # overwritten, not only unlinked
        assert b"SECRETPERSON" not in content


def test_settings_change(store: Store) -> None:
    with store.database.writing() as connection:
        set_setting(connection, "status", "open")
        set_setting(connection, "status", "closed")
        assert get_setting(connection, "status") == "closed"
    assert store.setting("status") == "closed"
    assert store.setting("nothing") is None


def test_a_transaction_that_fails_changes_nothing(store: Store) -> None:
    with pytest.raises(ZeroDivisionError), store.database.writing() as connection:
        set_setting(connection, "status", "closed")
        raise ZeroDivisionError
    assert store.setting("status") is None


def test_another_format_is_refused(url: str) -> None:
    store = Store(url)
    with store.database.writing() as connection:
        set_setting(connection, "format", "2")
    store.close()
    with pytest.raises(InputError, match="database of format 2, expected format 1"):
        Store(url)


def test_another_database_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "study.db"
    path.write_bytes(b"no database at all" * 100)
    with pytest.raises(InputError, match="the database cannot be used: file is not a database"):
        Store(f"sqlite:///{path}")


@pytest.mark.parametrize(
    ("url", "words"),
    [
        ("nonsense", "the database URL cannot be read"),
        ("mysql://u:secret@h/d", "driver is not installed|expected sqlite or postgresql"),
        ("sqlite://", "must be a file"),
        ("sqlite:///:memory:", "must be a file"),
        ("sqlite:////no/such/directory/study.db", "found no directory"),
        ("postgresql+nosuch://u:secret@h/d", "the database URL cannot be read"),
    ],
)
def test_bad_urls_are_refused_without_repeating_them(url: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as error:
        parse_url(url)
    assert "secret" not in str(error.value)


def test_a_server_that_is_not_there_is_named_without_password() -> None:
    with pytest.raises(InputError, match="the database cannot be used") as error:
        Store("postgresql://user:secret@127.0.0.1:1/name")
    assert "secret" not in str(error.value)
    del error
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", ResourceWarning
        )  # pg8000 leaves its socket to the collector
        gc.collect()


def test_durability(tmp_path: Path) -> None:
    # https://sqlite.org/pragma.html#pragma_synchronous: 1 NORMAL, 2 FULL
    for durability, level in (("power", 2), ("process", 1)):
        store = Store(f"sqlite:///{tmp_path / durability}.db", durability)  # type: ignore[arg-type]
        with store.database.writing() as connection:
            assert connection.execute(text("PRAGMA synchronous")).scalar() == level
            assert connection.execute(text("PRAGMA journal_mode")).scalar() == "wal"
        store.close()
