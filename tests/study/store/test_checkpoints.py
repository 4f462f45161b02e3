"""What SQLite writes where: checkpoints beside the writing, pages."""

from __future__ import annotations

import sqlite3
import time
from pathlib import Path

import pytest

from coadapt.study.session.events import Opened
from coadapt.study.store import Store
from coadapt.study.store import checkpoints as module
from coadapt.study.store.checkpoints import Checkpoints


def test_what_is_written_goes_to_the_database_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "EVERY", 0.01)
    path = tmp_path / "study.db"
    store = Store(f"sqlite:///{path}")
    checkpoints = Checkpoints(store.database)
    checkpoints.start()
    with store.database.writing() as connection:
        store.add_session(connection, "a-key-of-a-session", None, Opened(parameters={}))
    until = time.monotonic() + 30
    while b"a-key-of-a-session" not in path.read_bytes():
        assert time.monotonic() < until
        time.sleep(0.01)
    checkpoints.stop()
    assert [row.key for row in store.rows()] == ["a-key-of-a-session"]
    store.close()


def test_a_new_file_has_small_pages_and_an_older_one_keeps_its_own(tmp_path: Path) -> None:
    for size, name in ((1024, "new.db"), (4096, "old.db")):
        path = tmp_path / name
        if size == 4096:  # as SQLite makes it if nobody says anything
            with sqlite3.connect(path) as connection:
                connection.execute("PRAGMA journal_mode = WAL")
                connection.execute("CREATE TABLE other (x)")
            connection.close()
        store = Store(f"sqlite:///{path}")
        with store.database.writing() as connection:
            store.add_session(connection, "key", None, Opened(parameters={}))
        store.close()
        with sqlite3.connect(path) as connection:
            assert connection.execute("PRAGMA page_size").fetchone() == (size,)
            assert connection.execute("SELECT key FROM sessions").fetchone() == ("key",)
        connection.close()
