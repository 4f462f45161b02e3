"""Checkpoints of SQLite beside the writing, so that no commit has to wait for one.

A commit goes to the write-ahead log; a checkpoint copies what is there to the database's pages,
which takes tens of milliseconds. SQLite lets who commits do it, and who is behind that waits.
"""

from __future__ import annotations

import logging
import threading

from coadapt.study.store.database import Database, StoreError

log = logging.getLogger("coadapt.study")

EVERY = 0.5
"""Seconds."""


class Checkpoints:
    """A thread that makes them."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run, name="checkpoints", daemon=True)

    def start(self) -> None:
        """Begin, if it is a database that has them."""
        if self._database.is_sqlite:
            self._thread.start()

    def stop(self) -> None:
        """End; waits for one that is under way."""
        self._end.set()
        if self._thread.is_alive():
            self._thread.join()

    def _run(self) -> None:
        while not self._end.wait(EVERY):
            try:
                self._database.checkpoint()
            except StoreError as error:  # who writes will find out
                log.warning("no checkpoint: %s", error)
