"""Checkpoints of SQLite beside the writing."""

from __future__ import annotations

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
