"""The door: from stored sessions to a folder."""

from __future__ import annotations

import os
import secrets
import shutil
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path

from coadapt import __version__
from coadapt.errors import FileError
from coadapt.study.export.files import TableFiles
from coadapt.study.export.materials import (
    MANIFEST,
    Counts,
    Manifest,
    write_manifest,
    write_materials,
    write_metadata,
    write_readme,
)
from coadapt.study.export.names import Names
from coadapt.study.export.rows import Place, SessionRows
from coadapt.study.export.tables import (
    ANSWERS,
    EVENTS,
    FORMAT,
    PARTICIPANTS,
    STEPS,
    TABLES,
    TRIALS,
)
from coadapt.study.protocol import Study
from coadapt.study.protocol.reader import FILE, study_task
from coadapt.study.record import Record, standing
from coadapt.study.session.machine import replayed

Records = Callable[[], Iterable[Record]]
"""Gives all sessions in the order in which they were opened; is called twice."""

PRIVATE = frozenset({"declined", "withdrawn"})
"""Standings of those whose doings are left out."""


@dataclass(frozen=True)
class Stored:
    """What an export is made from.

    Attributes:
        directory: of the study.
        study: its protocol.
        records: its sessions.
        deleted: number of sessions that were deleted.
    """

    directory: Path
    study: Study
    records: Records
    deleted: int = 0


def export(
    stored: Stored,
    out: str | os.PathLike[str],
    now: float,
    *,
    private: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> Manifest:
    """Write an export to the new folder ``out``; an older export there is replaced.

    The folder appears when all of it is written.

    Args:
        stored: the study.
        out: the folder.
        now: seconds since 1970; sessions without a sign of life for too long are stale by then.
        private: whether also what those did who declined or withdrew.
        progress: is told what is being done.

    Raises:
        FileError: if ``out`` is something else than an export, or cannot be written.
        InputError: if the study's task cannot be used.
        NotNow: if the events of a session cannot have happened in their order.
    """
    target = Path(os.path.abspath(out))
    if target.exists() and not (target / MANIFEST).is_file():
        if not (target.is_dir() and not any(target.iterdir())):
            raise FileError(out, None, "found something that is no export, expected a new folder")
    draft = target.with_name(f".{target.name[:100]}.{secrets.token_hex(4)}.tmp")
    try:
        draft.mkdir()
        manifest = _write(stored, draft, now, private, progress)
        if target.exists():
            aside = draft.with_suffix(".old")
            target.rename(aside)
            draft.rename(target)
            shutil.rmtree(aside)
        else:
            draft.rename(target)
    except OSError as error:
        raise FileError(out, None, f"cannot be written: {error.strerror}") from error
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    return manifest


def _write(
    stored: Stored, folder: Path, now: float, private: bool, progress: Callable[[str], None]
) -> Manifest:
    study = stored.study
    task = study_task(study, stored.directory)
    names = Names.of_model(task.build())
    data, parquet, raw = (folder / p for p in ("data", "data/parquet", "data/raw"))
    for path in (data, parquet, raw):
        path.mkdir()
    progress("Counting sessions")
    places = places_of(study, stored.records(), now)
    simulated = 0
    with ExitStack() as stack:
        files = {t.name: stack.enter_context(TableFiles(t, data, parquet)) for t in TABLES}
        lines = stack.enter_context((raw / "sessions.jsonl").open("wb"))
        for i, record in enumerate(stored.records()):
            progress(f"Writing session {i + 1:,} of {len(places):,}")
            place = places.get(record.key)
            if place is None:  # opened since the counting
                continue
            session = SessionRows(study, names, record, place)
            participant = session.participant()
            simulated += participant.simulated
            files[PARTICIPANTS.name].write([participant])
            if private or place.standing not in PRIVATE:
                files[TRIALS.name].write(session.trials())
                files[STEPS.name].write(session.steps())
                files[ANSWERS.name].write(session.answers())
                files[EVENTS.name].write(session.events())
                lines.write(session.as_json() + b"\n")
    protocol = (stored.directory / FILE).read_bytes()
    manifest = Manifest(
        format=FORMAT,
        coadapt=__version__,
        protocol_sha256=sha256(protocol).hexdigest(),
        exported=datetime.fromtimestamp(now, UTC).isoformat(timespec="seconds"),
        counts=Counts(
            sessions=len(places),
            included=sum(place.included for place in places.values()),
            simulated=simulated,
            standing=dict(Counter(place.standing for place in places.values())),
            deleted=stored.deleted,
        ),
        rows={name: file.rows for name, file in files.items()},
    )
    write_metadata(folder, study)
    write_materials(folder, study, protocol, task, names)
    write_readme(folder, study, manifest)
    write_manifest(folder, manifest)
    return manifest


def places_of(study: Study, records: Iterable[Record], now: float) -> Mapping[str, Place]:
    """By its key: where each session stands among all by the time ``now``.

    Raises:
        NotNow: if the events of a session cannot have happened in their order.
    """
    standings, simulated = {}, set[str]()
    allocated: list[tuple[float, str]] = []
    for record in records:
        session = replayed(study, (entry.event for entry in record.entries))
        standings[record.key] = standing(study, session, record.last_sign, now)
        if record.is_simulated:
            simulated.add(record.key)
        if record.allocated is not None:
            allocated.append((record.allocated, record.key))
    allocation = {key: i + 1 for i, (_, key) in enumerate(sorted(allocated))}
    is_mixed = 0 < len(simulated) < len(standings)
    return {
        key: Place(
            number=i + 1,
            allocation=allocation.get(key),
            standing=stands,
            included=stands == "completed" and not (is_mixed and key in simulated),
        )
        for i, (key, stands) in enumerate(standings.items())
    }
