"""What the researcher asks for and does, whatever the pages look like."""

from __future__ import annotations

import asyncio
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from tempfile import mkdtemp

import msgspec

from coadapt.study.attempts import StoredAttempt, attempts_of
from coadapt.study.export import export
from coadapt.study.protocol import read_study
from coadapt.study.record import Record, Standing, Stored, alias_of, standing
from coadapt.study.robots import model_of
from coadapt.study.server.admin.blinding import (
    Act,
    Unblinding,
    is_unblinded,
    keep_unblinding,
    unblindings,
)
from coadapt.study.server.admin.overview import Glance, glance
from coadapt.study.server.admin.recording import Recording, recording_of
from coadapt.study.server.service import Service, Status
from coadapt.study.server.socket import Connections
from coadapt.study.session import NotNow
from coadapt.study.session.events import Noted
from coadapt.study.store import Row, Store

PAGE = 50
"""Sessions on a page of the dashboard."""

EXCLUDED = "The researchers have ended this session."

READMITTED = "readmitted"
"""`Noted.what` of the reason for which a session was readmitted."""


class Dashboard(msgspec.Struct, frozen=True, kw_only=True):
    """The state of the study.

    Attributes:
        status: whether it is open.
        now: the time at the server, in seconds since 1970.
        connected: pages that are connected to this server.
        standings: number of sessions by what became of them.
        deleted: number of those that were deleted.
        conditions: by condition and standing; None while blinded.
        unblindings: what is kept of unblinding.
        glances: some sessions, the latest first.
        unreadable: pseudonyms of those among them whose events do not fit the protocol, as after a
            change of it.
        page, pages: which part of the sessions that is, from 1.
        shown: the standing that was asked for, or None for all.
    """

    status: Status
    now: float
    connected: int
    standings: dict[Standing, int]
    deleted: int
    conditions: dict[str, dict[Standing, int]] | None
    unblindings: tuple[Unblinding, ...]
    glances: list[Glance]
    unreadable: list[str]
    page: int
    pages: int
    shown: str | None

    @property
    def sessions(self) -> int:
        """Number of all sessions."""
        return sum(self.standings.values())


class Desk:
    """The researcher's side of a study.

    Args:
        service: the study.
        connections: who is connected to this server.
    """

    def __init__(self, service: Service, connections: Connections) -> None:
        self.service = service
        self._connections = connections

    # What is there

    async def dashboard(self, page: int = 1, shown: str | None = None) -> Dashboard:
        """The state of the study, with one page of its sessions of the standing ``shown``."""
        study, store, now = self.service.study, self.service.store, time.time()
        rows = await self.service.rows()
        stands: list[tuple[Row, Standing]] = [
            (row, standing(study, row.digest.end, row.seen, now)) for row in rows
        ]
        kept = await asyncio.to_thread(unblindings, store)
        chosen = [row for row, s in reversed(stands) if shown in (None, s)]
        pages = max(1, -(-len(chosen) // PAGE))
        page = min(max(page, 1), pages)
        some = chosen[(page - 1) * PAGE : page * PAGE]
        glances, unreadable = list[Glance](), list[str]()
        for row in some:
            record = await self._record(row)
            try:
                if record.events:  # else it was deleted meanwhile
                    glances.append(self._glance(record, now))
            except NotNow:
                unreadable.append(record.alias)
        return Dashboard(
            status=await self.service.status(),
            now=now,
            connected=len(self._connections),
            standings=dict(Counter[Standing](s for _, s in stands)),
            deleted=len(await asyncio.to_thread(store.deleted)),
            conditions=self._conditions(stands) if is_unblinded(kept) else None,
            unblindings=kept,
            glances=glances,
            unreadable=unreadable,
            page=page,
            pages=pages,
            shown=shown,
        )

    async def record(self, number: int) -> Record:
        """The session with this number.

        Raises:
            KeyError: if there is none.
        """
        row = await asyncio.to_thread(self.service.store.find, number=number)
        if row is None:
            raise KeyError(number)
        return await self._record(row)

    def glance(self, record: Record) -> Glance:
        """A session at a glance."""
        return self._glance(record, time.time())

    def attempts(self, record: Record) -> list[StoredAttempt]:
        """Its attempts at training sessions and trials."""
        return attempts_of(record.moments(self.service.study))

    async def is_unblinded(self) -> bool:
        """Whether conditions are shown."""
        return is_unblinded(await asyncio.to_thread(unblindings, self.service.store))

    async def recording(self, record: Record, index: int) -> Recording:
        """The attempt number ``index``, from 0, of a session.

        Raises:
            KeyError: if there is none.
        """
        attempts = self.attempts(record)
        if not 0 <= index < len(attempts):
            raise KeyError(index)
        model = model_of(self.service.robots)
        unblinded = await self.is_unblinded()
        return recording_of(self.service.study, model, attempts[index], unblinded=unblinded)

    async def find(self, text: str) -> int | None:
        """The number of the session that ``text`` means.

        ``text`` is a number, a pseudonym, or what a recruitment service calls the person.
        """
        text = text.strip()
        for row in await self.service.rows():
            if text and text in (f"{row.id}", alias_of(row.key), row.participant):
                return row.id
        return None

    # What the researcher does

    async def set_status(self, status: Status) -> None:
        """Open, close or pause the study."""
        await self.service.set_status(status)

    async def keep(self, act: Act) -> None:
        """Show conditions, or hide them again; that it was done is kept."""
        await asyncio.to_thread(keep_unblinding, self.service.store, act)

    async def exclude(self, record: Record, reason: str) -> None:
        """Take a session out of the data; raises as `Service.record`."""
        await self.service.exclude(record.key, reason)
        self._connections.end(record.key, EXCLUDED)

    async def readmit(self, record: Record, reason: str) -> None:
        """Take that back; raises as `Service.record`."""
        await self.service.readmit(record.key)
        await self.service.record(record.key, Noted(what=READMITTED, text=reason))

    async def delete(self, record: Record) -> None:
        """Delete a session; raises as `Service.delete`."""
        await self.service.delete(record.key)
        self._connections.end(record.key, EXCLUDED)

    async def export(self) -> Path:
        """An export in a new temporary folder; that it was taken is kept.

        It is written by another process, so that those who are steering do not feel it.
        """
        await self.keep("exported")
        service = self.service
        folder = Path(mkdtemp(prefix="coadapt-export-")) / "export"
        url = service.store.database.engine.url.render_as_string(hide_password=False)
        apart = ProcessPoolExecutor(1, mp_context=get_context("spawn"))
        try:
            loop = asyncio.get_running_loop()
            await loop.run_in_executor(apart, write_export, service.directory, url, folder)
        finally:
            apart.shutdown(wait=False)
        return folder

    def _conditions(self, stands: list[tuple[Row, Standing]]) -> dict[str, dict[Standing, int]]:
        counts = {
            condition.name: Counter[Standing]() for condition in self.service.study.conditions
        }
        for row, stand in stands:
            if row.digest.condition is not None:
                counts[row.digest.condition][stand] += 1
        return {name: dict(count) for name, count in counts.items()}

    async def _record(self, row: Row) -> Record:
        return Record(row, await asyncio.to_thread(self.service.store.events, row.id))

    def _glance(self, record: Record, now: float) -> Glance:
        connected = record.key in self._connections
        return glance(self.service.study, record, now, connected=connected)


def write_export(directory: Path, url: str, folder: Path) -> None:
    """Write an export of the study in ``directory`` with its database to ``folder``."""
    store = Store(url)
    try:
        export(Stored.of(directory, read_study(directory), store), folder, time.time())
    finally:
        store.close()
