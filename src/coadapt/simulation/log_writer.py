"""Writing a log: a result all or nothing, a live trial step by step and safe from crashes."""

from __future__ import annotations

import csv
import os
import secrets
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Self, TextIO

import msgspec

from coadapt import __version__
from coadapt.errors import FileError
from coadapt.robots import Decision, Robot
from coadapt.robots.task_setup import AnySetup
from coadapt.simulation.log import (
    FORMAT,
    FORMAT_LINE,
    INPUT,
    PARTICIPANT,
    SETUP_LINE,
    TIME,
    TRIAL,
    VERSION_LINE,
    DecisionCells,
    Value,
)


class LogWriter:
    """Writes the format's text to a stream: the head at once, then row by row.

    Args:
        stream: where to, opened with ``newline=""``.
        setup: the robot behind the decisions.
        columns: the decision columns.
        participants: whether there is a column for who steered.
    """

    def __init__(
        self,
        stream: TextIO,
        setup: AnySetup,
        columns: Sequence[str],
        participants: bool = False,
    ) -> None:
        self._columns = tuple(columns)
        self._participants = participants
        self._stream = stream
        self._csv = csv.writer(stream, lineterminator="\n")
        stream.write(f"{FORMAT_LINE} {FORMAT}\n{VERSION_LINE} {__version__}\n")
        stream.write(f"{SETUP_LINE} {msgspec.json.encode(setup).decode()}\n")
        who = [PARTICIPANT] if participants else []
        self._csv.writerow([TIME, INPUT, TRIAL, *who, *self._columns])

    def write(
        self,
        time: float,
        human_input: str | None,
        trial: int,
        values: Mapping[str, Value],
        participant: str | None = None,
    ) -> None:
        """Write one row; ``values`` are the cells of the decision columns, absent ones empty."""
        cells = [_cell(values[name]) if name in values else "" for name in self._columns]
        who = [participant or ""] if self._participants else []
        self._csv.writerow([repr(float(time)), human_input or "", str(trial), *who, *cells])


class DecisionLog:
    """A log of the decisions of one robot.

    Args:
        stream: where to, opened with ``newline=""``.
        robot: decides.
        setup: what the robot was built from.
        participants: whether to say who steered.
    """

    def __init__(
        self, stream: TextIO, robot: Robot, setup: AnySetup, participants: bool = False
    ) -> None:
        self._cells = DecisionCells(robot)
        self._writer = LogWriter(stream, setup, self._cells.columns, participants)

    def write(
        self, time: float, trial: int, decision: Decision, participant: str | None = None
    ) -> None:
        """Write one step.

        Args:
            time: in seconds.
            trial: its number, from 1 on through all participants.
            decision: what was decided.
            participant: who steered.
        """
        human_input, values = self._cells.input(decision), self._cells.values(decision)
        self._writer.write(time, human_input, trial, values, participant)


class LiveLog:
    """The log of a trial under way: after every step it is whole, on the disk.

    Args:
        path: a new file.
        robot: decides.
        setup: what the robot was built from.

    Raises:
        FileError: if the file exists or cannot be made.
    """

    def __init__(self, path: str | os.PathLike[str], robot: Robot, setup: AnySetup) -> None:
        self.path = Path(path)
        self.rows = 0
        try:
            self._stream = self.path.open("x", encoding="utf-8", newline="")
        except OSError as error:
            raise _unwritable(path, error) from error
        self._log = DecisionLog(self._stream, robot, setup)
        self._save()

    def write(self, time: float, trial: int, decision: Decision) -> None:
        """Write one step as `DecisionLog.write` and wait until it is on the disk.

        Raises:
            FileError: if it cannot be written.
        """
        self._log.write(time, trial, decision)
        self._save()
        self.rows += 1

    def close(self) -> None:
        """Close the file; without a row it is removed."""
        self._stream.close()
        if self.rows == 0:
            self.path.unlink(missing_ok=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _save(self) -> None:
        try:
            # One write of whole lines: a program killed at any moment leaves whole lines.
            self._stream.flush()
            os.fsync(self._stream.fileno())
        except OSError as error:
            raise _unwritable(self.path, error) from error


@contextmanager
def whole_log(
    path: str | os.PathLike[str], robot: Robot, setup: AnySetup, participants: bool = False
) -> Generator[DecisionLog]:
    """A log that appears under ``path`` when all of it is written, and not at all after an error.

    What was there before is replaced.

    Raises:
        FileError: if the file cannot be written, or something other than a file is there.
    """
    target = Path(os.path.realpath(path))
    draft = target.with_name(f".coadapt-{secrets.token_hex(8)}.tmp")
    if target.exists() and not target.is_file():
        raise FileError(path, None, "found something that is not a file, expected a place to save")
    try:
        stream = draft.open("x", encoding="utf-8", newline="")
    except OSError as error:
        raise _unwritable(path, error) from error
    try:
        with stream:
            yield DecisionLog(stream, robot, setup, participants)
            stream.flush()
            os.fsync(stream.fileno())
        draft.replace(target)
    except OSError as error:
        raise _unwritable(path, error) from error
    finally:
        with suppress(OSError):
            draft.unlink(missing_ok=True)


def _cell(value: Value) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(float(value))


def _unwritable(path: str | os.PathLike[str], error: OSError) -> FileError:
    return FileError(path, None, f"cannot be written ({error.strerror}), expected a place to save")
