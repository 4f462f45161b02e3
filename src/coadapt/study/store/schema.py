"""The tables of a study's database.

`EVENTS` holds what happened. Nothing in it is ever changed, and rows go only when a participant's
data are deleted. The columns of `SESSIONS` after the first four repeat what the events say, for
questions about all sessions at once; they are written together with the events.
"""

from __future__ import annotations

from sqlalchemy import (
    BigInteger,
    Column,
    Double,
    ForeignKey,
    Integer,
    MetaData,
    String,
    Table,
    Text,
)

FORMAT = 1
"""Version of these tables."""

LONGEST_PARTICIPANT = 200
"""Characters of what a recruitment service calls a person."""

METADATA = MetaData()

_NUMBER = BigInteger().with_variant(Integer, "sqlite")  # SQLite numbers rows itself if INTEGER

SESSIONS = Table(
    "sessions",
    METADATA,
    Column("id", _NUMBER, primary_key=True),
    Column("key", String(64), nullable=False, unique=True),  # unguessable, part of the link
    Column("created", Double, nullable=False),  # seconds since 1970
    Column("participant", String(LONGEST_PARTICIPANT), unique=True),
    Column("place", _NUMBER, unique=True),  # in the order of allocation
    Column("condition", String(64)),
    Column("choice", Integer),
    Column("device", String(16)),
    Column("end", String(16)),
    sqlite_autoincrement=True,  # the number of a deleted session is never given again
)

EVENTS = Table(
    "events",
    METADATA,
    Column("session", _NUMBER, ForeignKey("sessions.id"), primary_key=True),
    Column("sequence", Integer, primary_key=True, autoincrement=False),  # from 1
    Column("time", Double, nullable=False),  # seconds since 1970, by the server's clock
    Column("kind", String(16), nullable=False),
    Column("data", Text, nullable=False),  # the event as JSON
)

SETTINGS = Table(
    "settings",
    METADATA,
    Column("name", String(64), primary_key=True),
    Column("value", Text, nullable=False),
)
