"""The door: from stored sessions to a folder."""

from __future__ import annotations

import os
import secrets
import shutil
from collections import Counter
from collections.abc import Callable, Generator
from contextlib import ExitStack, contextmanager
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path

import msgspec

from coadapt import __version__
from coadapt.errors import FileError
from coadapt.study.export.files import TableFiles
from coadapt.study.export.logs import Logs
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
from coadapt.study.export.rows import SessionRows
from coadapt.study.export.tables import (
    ANSWERS,
    EVENTS,
    FORMAT,
    PARTICIPANTS,
    STEPS,
    TABLES,
    TRIALS,
    Participant,
    StepRow,
    TrialRow,
)
from coadapt.study.protocol.reader import FILE, study_task
from coadapt.study.record import Stored
from coadapt.study.server.unchanged import differences
from coadapt.tasks import Task

PRIVATE = frozenset({"declined", "withdrawn"})
"""Standings of those whose doings are left out."""


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
    with _new_folder(Path(os.path.abspath(out))) as folder:
        return _write(stored, folder, now, private, progress)


@contextmanager
def _new_folder(target: Path) -> Generator[Path]:
    """A folder to fill, which takes the place of ``target`` if all goes well."""
    is_export = (target / MANIFEST).is_file()
    is_empty = target.is_dir() and not any(target.iterdir())
    if target.exists() and not is_export and not is_empty:
        raise FileError(target, None, "found something that is no export, expected a new folder")
    draft = target.with_name(f".{target.name[:100]}.{secrets.token_hex(4)}.tmp")
    old = draft.with_suffix(".old")
    try:
        draft.mkdir()
        yield draft
        if target.exists():
            target.rename(old)
        draft.rename(target)
    except OSError as error:
        raise FileError(target, None, f"cannot be written: {error.strerror}") from error
    finally:
        shutil.rmtree(draft, ignore_errors=True)
        shutil.rmtree(old, ignore_errors=True)


def _edited(stored: Stored, task: Task) -> tuple[str, ...]:
    """Names of the values that are not as participants were last served them."""
    if stored.served is None:
        return ()
    now = msgspec.json.encode({"study": stored.study, "task": task})
    return tuple(differences(msgspec.json.decode(stored.served), msgspec.json.decode(now)))


def _write_logs(logs: Logs, trials: list[TrialRow], steps: list[StepRow]) -> None:
    """Write the finished trials of one session."""
    for trial in trials:
        theirs = [
            step
            for step in steps
            if step.stage == "trial" and step.number == trial.trial and step.counts
        ]
        if theirs:
            logs.write(trial.condition, trial.choice, theirs)


def bare(participant: Participant) -> Participant:
    """What is told of someone who declined or withdrew: that they did, when and where."""
    untold = ("device", "pad", "browser", "width", "height", "latency", "choice", "changed")
    values = dict.fromkeys(untold)
    return msgspec.structs.replace(participant, **values, checks=0, checks_failed=0, restarts=0)


def _write(
    stored: Stored, folder: Path, now: float, private: bool, progress: Callable[[str], None]
) -> Manifest:
    study = stored.study
    task = study_task(study, stored.directory)
    names = Names.of_model(task.build())
    data, parquet, raw = (folder / p for p in ("data", "data/parquet", "data/raw"))
    for path in (data, parquet, raw):
        path.mkdir()
    standings = Counter[str]()
    included = simulated = 0
    with ExitStack() as stack:
        files = {t.name: stack.enter_context(TableFiles(t, data, parquet)) for t in TABLES}
        lines = stack.enter_context((raw / "sessions.jsonl").open("wb"))
        logs = stack.enter_context(Logs(folder / "logs", study, task, names))
        for record in stored.records():
            session = SessionRows(stored, names, record, now)
            participant = session.participant()
            standings[participant.standing] += 1
            included += participant.included
            simulated += participant.simulated
            progress(f"Exporting: {standings.total():,} sessions")
            is_told = private or participant.standing not in PRIVATE
            files[PARTICIPANTS.name].write([participant if is_told else bare(participant)])
            if is_told:
                trials, steps = list(session.trials()), list(session.steps())
                files[TRIALS.name].write(trials)
                files[STEPS.name].write(steps)
                if participant.included:
                    _write_logs(logs, trials, steps)
                files[ANSWERS.name].write(session.answers())
                files[EVENTS.name].write(session.events())
                lines.write(session.as_json() + b"\n")
    protocol = (stored.directory / FILE).read_bytes()
    manifest = Manifest(
        format=FORMAT,
        coadapt=__version__,
        protocol_sha256=sha256(protocol).hexdigest(),
        protocol_changes=stored.changes,
        protocol_edited=_edited(stored, task),
        exported=datetime.fromtimestamp(now, UTC).isoformat(timespec="seconds"),
        counts=Counts(
            sessions=standings.total(),
            included=included,
            simulated=simulated,
            standing=dict(standings),
            deleted=len(stored.deleted),
        ),
        rows={name: file.rows for name, file in files.items()},
    )
    write_metadata(folder, study)
    write_materials(folder, study, protocol, task, names)
    write_readme(folder, study, manifest)
    write_manifest(folder, manifest)
    return manifest
