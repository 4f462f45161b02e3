"""Changes of the protocol that were accepted after the first participant came, in the database."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime

import msgspec
from sqlalchemy import Connection

from coadapt.study.store.store import Store, get_setting, set_setting

SETTING = "protocol_changes"


class Change(msgspec.Struct, frozen=True):
    """A change under way.

    Attributes:
        at: when it was accepted, UTC, ISO 8601.
        values: names of the values of protocol and task that changed.
    """

    at: str
    values: tuple[str, ...]


def add_change(connection: Connection, values: Sequence[str], now: float) -> None:
    """Note that ``values`` changed.

    Args:
        connection: of a transaction that writes.
        values: their names.
        now: seconds since 1970.
    """
    change = Change(datetime.fromtimestamp(now, UTC).isoformat(timespec="seconds"), tuple(values))
    noted = (*_decode(get_setting(connection, SETTING)), change)
    set_setting(connection, SETTING, msgspec.json.encode(noted).decode())


def changes_in(store: Store) -> tuple[Change, ...]:
    """What was noted, the earliest first.

    Raises:
        StoreError: if the database cannot be read.
    """
    return _decode(store.setting(SETTING))


def _decode(setting: str | None) -> tuple[Change, ...]:
    return msgspec.json.decode(setting or "[]", type=tuple[Change, ...])
