"""Connections to SQLite or PostgreSQL, and what differs between the two."""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import Literal, NamedTuple

import msgspec
from sqlalchemy import Connection, Engine, create_engine, event, text
from sqlalchemy.engine import URL, make_url
from sqlalchemy.exc import (
    ArgumentError,
    DBAPIError,
    IntegrityError,
    NoSuchModuleError,
    SQLAlchemyError,
)

from coadapt.errors import InputError

Durability = Literal["power", "process"]
"""What stored data survive: ``"power"``: a loss of power of the machine; ``"process"``: the end of
any process at any moment, but of the last moments before a loss of power some may be missing, never
an older event without a newer one. PostgreSQL always gives the first."""

ALLOCATION_LOCK = 0x636F6164  # any number that nobody else locks in this database

PAGE = 1024
"""Bytes of a page of a new SQLite file. Every session under way has a page of its own in the index
of events, and a commit writes each that it touches: with SQLite's own 4096 four times as much."""

CHECKPOINT_PAGES = 64_000
"""The write-ahead log of SQLite is emptied at this many pages at the latest, by who writes then;
see `coadapt.study.store.checkpoints`."""

CACHED = 16_000
"""Kilobytes of a SQLite file that a connection remembers: of every session under way the page to
which its events are added."""

REST = 5.0
"""Seconds after which it is asked whether a connection that writes often is still there."""

PATIENCE = 30
"""Seconds to wait for another process that writes to the same SQLite file."""


class StoreError(Exception):
    """The database does not work; nothing is stored. The message is for logs, not for pages."""


class Conflict(Exception):
    """A row cannot be written: its number or name is taken, or what it belongs to is gone."""


class EventRow(NamedTuple):
    """A row of `coadapt.study.store.schema.EVENTS`."""

    session: int
    sequence: int
    time: float
    kind: str
    data: str


MOST_ROWS = 1000
"""Of one statement; SQLite takes 32,766 values."""

_INSERT = "INSERT INTO events (session, sequence, time, kind, data) "

_INSERT_JSON = text(
    _INSERT
    + """SELECT (r->>0)::bigint, (r->>1)::integer, (r->>2)::double precision, r->>3, r->>4
        FROM json_array_elements(CAST(:rows AS json)) AS r"""
)

_ENCODER = msgspec.json.Encoder()


class Database:
    """A database.

    Args:
        url: ``sqlite:///PATH`` or ``postgresql://USER:PASSWORD@HOST/NAME``.
        durability: what stored data survive.

    Attributes:
        engine: for reading.

    Raises:
        InputError: if the URL cannot be used.
    """

    def __init__(self, url: str, durability: Durability = "power") -> None:
        parsed = parse_url(url)
        self.is_sqlite = parsed.get_backend_name() == "sqlite"
        if self.is_sqlite:
            self.engine = create_engine(
                parsed, connect_args={"timeout": PATIENCE}, hide_parameters=True
            )
            _prepare_sqlite(self.engine, durability)
        else:
            self.engine = create_engine(parsed, pool_pre_ping=True, hide_parameters=True)
        self._writing = self.engine.execution_options(coadapt_writes=True)

    @contextmanager
    def reading(self) -> Generator[Connection]:
        """A connection that sees one state of the database and changes nothing.

        Raises:
            StoreError: if it cannot be read.
        """
        with _translated(), self.engine.connect() as connection:
            yield connection

    @contextmanager
    def writing(self) -> Generator[Connection]:
        """A connection in a transaction, committed at the end; undone after an exception.

        Raises:
            Conflict: if what was written does not go with what is there.
            StoreError: if it cannot be written.
        """
        with _translated(), self._writing.begin() as connection:
            yield connection

    def insert_events(self, connection: Connection, rows: Sequence[EventRow]) -> None:
        """Insert ``rows``, many by one statement.

        So the interpreter is left and entered once, not for every row, which matters to a thread
        beside a busy one; and PostgreSQL is asked once.
        """
        for i in range(0, len(rows), MOST_ROWS):
            some = rows[i : i + MOST_ROWS]
            if self.is_sqlite:
                values = ", ".join(["(?, ?, ?, ?, ?)"] * len(some))
                connection.exec_driver_sql(f"{_INSERT}VALUES {values}", tuple(chain(*some)))
            else:
                connection.execute(_INSERT_JSON, {"rows": _ENCODER.encode(some).decode()})

    def writing_often(self) -> WritingConnection:
        """A connection for many transactions of one thread."""
        return WritingConnection(self._writing)

    def checkpoint(self) -> None:
        """Copy what stands in the write-ahead log of SQLite to where it belongs.

        Raises:
            StoreError: if that cannot be done.
        """
        with _translated():
            connection = self.engine.raw_connection()
            try:
                connection.cursor().execute("PRAGMA wal_checkpoint(PASSIVE)")
            finally:
                connection.close()

    def lock_allocation(self, connection: Connection) -> None:
        """Wait until no other process allocates; to the end of the transaction of ``connection``.

        On SQLite nobody else writes during a transaction that does.
        """
        if not self.is_sqlite:
            connection.execute(
                text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": ALLOCATION_LOCK}
            )

    def close(self) -> None:
        """Close all connections that nobody uses."""
        self.engine.dispose()


class WritingConnection:
    """A connection for many transactions, one after the other.

    `Database.writing` takes one from the pool each time and gives it back, which is most of the
    work of a small transaction, and asks PostgreSQL each time whether it is still there. Here that
    is done after a rest, and after whatever went wrong.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._connection: Connection | None = None
        self._used = 0.0

    @contextmanager
    def transaction(self) -> Generator[Connection]:
        """As `Database.writing`."""
        try:
            with _translated():
                if self._connection is None or time.monotonic() - self._used > REST:
                    self.close()
                    self._connection = self._engine.connect()
                with self._connection.begin():
                    yield self._connection
                self._used = time.monotonic()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Give it back."""
        if self._connection is not None:
            connection, self._connection = self._connection, None
            with _translated():
                connection.close()


def parse_url(url: str) -> URL:
    """``url`` with the driver that coadapt uses where none is named.

    Raises:
        InputError: if it is no URL of SQLite or PostgreSQL, or its driver is missing. The message
            does not repeat it, since it may hold a password.
    """
    try:
        parsed = make_url(url)
        if parsed.drivername in ("postgresql", "postgres"):
            parsed = parsed.set(drivername="postgresql+pg8000")
        backend = parsed.get_backend_name()
        parsed.get_dialect().import_dbapi()
    except (ArgumentError, NoSuchModuleError, ValueError) as error:
        raise InputError(
            "the database URL cannot be read, expected sqlite:///FILE or "
            "postgresql://USER:PASSWORD@HOST/NAME"
        ) from error
    except ImportError as error:
        raise InputError(f"the database's driver is not installed: {error}") from error
    if backend not in ("sqlite", "postgresql"):
        raise InputError(f"found a database URL of {backend}, expected sqlite or postgresql")
    if backend == "sqlite":
        if not parsed.database or parsed.database == ":memory:":
            raise InputError("the database must be a file: what is in memory only would be lost")
        if not Path(parsed.database).absolute().parent.is_dir():
            raise InputError(f"found no directory for the database {parsed.database}")
    return parsed


def _prepare_sqlite(engine: Engine, durability: Durability) -> None:
    """Write-ahead log, foreign keys, and transactions that begin when SQLAlchemy says so."""

    @event.listens_for(engine, "connect")
    def connected(connection: sqlite3.Connection, _: object) -> None:
        connection.isolation_level = None
        synchronous = "FULL" if durability == "power" else "NORMAL"
        for pragma in (
            f"page_size = {PAGE}",  # of a file that has no tables yet
            "journal_mode = WAL",
            f"synchronous = {synchronous}",
            "foreign_keys = ON",
            "secure_delete = ON",  # deleted data are overwritten
            f"wal_autocheckpoint = {CHECKPOINT_PAGES}",
            f"cache_size = -{CACHED}",
            "temp_store = MEMORY",  # what a statement of many rows may have to undo
        ):
            connection.execute(f"PRAGMA {pragma}")

    @event.listens_for(engine, "begin")
    def begun(connection: Connection) -> None:
        writes = connection.get_execution_options().get("coadapt_writes", False)
        # Who reads first and then writes could find that another process wrote in between.
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")

    del connected, begun


@contextmanager
def _translated() -> Generator[None]:
    """Errors of drivers become ours."""
    try:
        yield
    except DBAPIError as error:
        if is_conflict(error):
            raise Conflict from error
        raise StoreError(shown(error)) from error
    except (SQLAlchemyError, OSError) as error:
        raise StoreError(shown(error)) from error


def shown(error: Exception) -> str:
    """``error`` without statement, parameters or password."""
    cause: object = getattr(error, "orig", None) or error
    details: object = cause.args[0] if isinstance(cause, Exception) and cause.args else None
    if isinstance(details, dict):  # of PostgreSQL; other parts of it repeat values
        cause = details.get("M", "")  # pyright: ignore
    return " ".join(f"{cause}".split())[:200]


def is_conflict(error: DBAPIError) -> bool:
    """Whether a constraint of a table is violated."""
    if isinstance(error, IntegrityError):
        return True
    # pg8000 tells some of them only by the code of PostgreSQL, of class 23.
    details: object = error.orig.args[0] if error.orig is not None and error.orig.args else None
    return isinstance(details, dict) and f"{details.get('C')}".startswith("23")  # pyright: ignore
