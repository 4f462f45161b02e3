"""The protocol must stay as it was when the first participant came."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import cast

import msgspec
from sqlalchemy import select

from coadapt.errors import FileError
from coadapt.study.changes import add_change
from coadapt.study.protocol import Study
from coadapt.study.protocol.reader import FILE
from coadapt.study.record import SERVED
from coadapt.study.store import Store
from coadapt.study.store.schema import SESSIONS
from coadapt.study.store.store import get_setting, set_setting
from coadapt.tasks import Task


def keep_protocol(store: Store, study: Study, task: Task, directory: Path, *, accept: bool) -> None:
    """Store protocol and task, unless participants have had other ones.

    Args:
        store: the database.
        study, task: as they are now.
        directory: of the study, for the message.
        accept: take a change, at the researcher's wish.

    Raises:
        FileError: if something changed since the first participant; says what.
    """
    new = msgspec.json.encode({"study": study, "task": task}, order="deterministic").decode()
    with store.database.writing() as connection:
        old = get_setting(connection, SERVED)
        begun = connection.execute(select(SESSIONS.c.id).limit(1)).first() is not None
        if old is not None and old != new and begun:
            names = list(differences(msgspec.json.decode(old), msgspec.json.decode(new)))
            if not accept:
                shown = ", ".join(names[:5]) + (" and more" if len(names) > 5 else "")
                raise FileError(
                    directory / FILE,
                    None,
                    f"found changes of {shown} since the first participant came, expected none; "
                    "begin a new study for a new protocol, or serve with --accept-changes",
                )
            add_change(connection, names, time.time())
        if old != new:
            set_setting(connection, SERVED, new)


def differences(old: object, new: object, place: str = "") -> Iterator[str]:
    """The names of the values in which two decoded JSON texts differ."""
    if isinstance(old, dict) and isinstance(new, dict):
        before, after = cast("dict[str, object]", old), cast("dict[str, object]", new)
        for name in sorted({*before, *after}):
            inner = f"{place}.{name}" if place else name
            yield from differences(before.get(name), after.get(name), inner)
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):  # pyright: ignore
        pairs = zip(cast("list[object]", old), cast("list[object]", new), strict=True)
        for i, (a, b) in enumerate(pairs):
            yield from differences(a, b, f"{place}[{i}]")
    elif old != new:
        yield place.removeprefix("study.")
