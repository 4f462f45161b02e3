"""Reading a log, row by row, in bounded memory. Whatever is wrong with it has one clear message."""

from __future__ import annotations

import csv
import math
import os
import re
import stat
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import BinaryIO

from coadapt.errors import FileError, excerpt
from coadapt.robots.task_setup import AnySetup, read_setup
from coadapt.simulation.log import (
    FIRST_FORMAT,
    FORMAT,
    FORMAT_LINE,
    INPUT,
    LARGEST_FILE,
    LONGEST_LINE,
    LONGEST_TRIAL,
    MATCHED,
    MOST_ROWS,
    PARTICIPANT,
    SETUP_LINE,
    TIME,
    TRIAL,
    VERSION_LINE,
    LogRow,
    Value,
    is_decision_column,
)

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
COUNT = re.compile(r"\d{1,9}", re.ASCII)
TEXT_COLUMNS = ("state", "action", "planned")
SHOWN_COLUMNS = 8


@contextmanager
def open_log(path: str | os.PathLike[str]) -> Generator[LogReader]:
    """Open a log and read it up to its header.

    Raises:
        FileError: if it cannot be opened, or is not a log this version reads.
    """
    try:
        status = Path(path).stat()
        if stat.S_ISDIR(status.st_mode):
            raise FileError(path, None, "found a directory, expected a log")
        if not stat.S_ISREG(status.st_mode):
            raise FileError(path, None, "found something that is not a file, expected a log")
        if status.st_size > LARGEST_FILE:
            raise FileError(path, None, _too_large(f"a file of {status.st_size:,} bytes"))
        stream = Path(path).open("rb")  # noqa: SIM115 (closed below)
    except OSError as error:
        raise _unreadable(path, error) from error
    with stream:
        yield LogReader(path, stream)


class LogReader:
    """A log of which the comments and the header are read; use `open_log`.

    Attributes:
        path: the file.
        setup: the robot behind the recorded decisions, or None if the log does not say.
        version: the version of coadapt that wrote it, or None.
        columns: names of all columns.
        decision_columns: names of those that hold recorded decisions.
    """

    def __init__(self, path: str | os.PathLike[str], stream: BinaryIO) -> None:
        self.path = path
        self.setup: AnySetup | None = None
        self.version: str | None = None
        self._is_ours = False
        self._lines = _lines(path, stream)
        self._line = 0
        header = self._read_comments()
        self._before_header = self._line - 1
        self._cells = csv.reader(chain([header], self._lines), strict=True)
        _, cells = self._next_cells() or (0, [])
        self.columns = tuple(name.strip() for name in cells)
        self._check_header()
        ours = self.columns if self._is_ours else ()
        self.decision_columns = tuple(name for name in ours if is_decision_column(name))

    def rows(self, inputs: Sequence[str]) -> Iterator[LogRow]:
        """The rows in order, each checked as it is read. They can be read once.

        Args:
            inputs: the names an input may have.

        Raises:
            FileError: if a row is not as the format wants it, or there is none.
        """
        place = {name: self.columns.index(name) for name in self.columns if name}
        last = LogRow(0, -math.inf, None, 0)
        steps = rows = 0
        while (found := self._next_cells()) is not None:
            line, cells = found
            rows += 1
            if rows > MOST_ROWS:
                raise FileError(self.path, line, _too_large(f"row {rows:,}"))
            if len(cells) != len(self.columns):
                raise FileError(
                    self.path,
                    line,
                    f"found {len(cells)} field{'s' * (len(cells) != 1)}, "
                    f"expected {len(self.columns)}: {_listed(self.columns)}",
                )
            trial = self._trial(line, cells[place[TRIAL]], last.trial) if TRIAL in place else 1
            is_new = trial != last.trial
            steps = 1 if is_new else steps + 1
            if steps > LONGEST_TRIAL:
                raise FileError(self.path, line, _too_large(f"step {steps:,} of trial {trial}"))
            time = self._number(line, TIME, cells[place[TIME]], "seconds")
            if not is_new and time < last.time:
                raise FileError(
                    self.path,
                    line,
                    f"found time {time!r} after {last.time!r}, "
                    "expected times that never decrease within a trial",
                )
            who = cells[place[PARTICIPANT]].strip() if PARTICIPANT in place else ""
            if not is_new and who != (last.participant or ""):
                raise FileError(
                    self.path,
                    line,
                    f"found {PARTICIPANT} {excerpt(who)} in a trial of "
                    f"{excerpt(last.participant or '')}, expected another trial for another one",
                )
            last = LogRow(
                line=line,
                time=time,
                human_input=self._input(line, cells[place[INPUT]], inputs),
                trial=trial,
                recorded=self._recorded(line, cells, place),
                participant=who or None,
            )
            yield last
        if rows == 0:
            raise FileError(
                self.path, self._line, "found no rows after the header, expected at least one"
            )

    def _read_comments(self) -> str:
        """Take in the comment lines; the first line after them."""
        for text in self._lines:
            self._line += 1
            line = text.strip()
            if line.startswith("#"):
                self._read_comment(line)
            elif line:
                return text
        if self._line:
            raise FileError(self.path, self._line, f"found the end, {_EXPECTED_HEADER}")
        raise FileError(self.path, 1, f"found an empty file, {_EXPECTED_HEADER}")

    def _read_comment(self, line: str) -> None:
        if line.startswith(FORMAT_LINE):
            self._check_format(line.removeprefix(FORMAT_LINE).strip())
            self._is_ours = True
        elif self._is_ours and line.startswith(VERSION_LINE):
            self.version = line.removeprefix(VERSION_LINE).strip()
        elif self._is_ours and line.startswith(SETUP_LINE):
            if self.setup is not None:
                raise FileError(self.path, self._line, "found a second setup, expected one")
            self.setup = self._read_setup(line.removeprefix(SETUP_LINE).strip())

    def _check_format(self, given: str) -> None:
        if COUNT.fullmatch(given) is None:
            raise FileError(
                self.path, self._line, f"found format {excerpt(given)}, expected {FORMAT}"
            )
        if int(given) > FORMAT:
            raise FileError(
                self.path,
                self._line,
                f"found format {int(given)}, which is newer than this coadapt reads; "
                f"expected {FORMAT}",
            )
        if int(given) < FIRST_FORMAT:
            raise FileError(self.path, self._line, f"found format {given}, expected {FORMAT}")

    def _read_setup(self, given: str) -> AnySetup:
        try:
            return read_setup(given.encode())
        except (ValueError, RecursionError) as error:
            raise FileError(
                self.path,
                self._line,
                f"found a setup that cannot be used ({error}), expected one that coadapt wrote",
            ) from error

    def _check_header(self) -> None:
        line = self._before_header + 1
        named = [name for name in self.columns if name]
        missing = [name for name in (TIME, INPUT) if name not in named]
        if missing:
            raise FileError(
                self.path,
                line,
                f"found columns {_listed(self.columns)}, expected {TIME} and {INPUT} "
                f"({' and '.join(missing)} missing)",
            )
        twice = next((name for name in named if named.count(name) > 1), None)
        if twice is not None:
            raise FileError(
                self.path, line, f"found column {excerpt(twice)} twice, expected it once"
            )

    def _next_cells(self) -> tuple[int, list[str]] | None:
        """The next line that is not blank, and its number; None at the end."""
        while True:
            line = self._before_header + self._cells.line_num + 1
            try:
                cells = next(self._cells)
            except StopIteration:
                return None
            except csv.Error as error:
                raise FileError(self.path, line, _bad_csv(str(error))) from error
            self._line = line
            if cells and not (len(cells) == 1 and not cells[0].strip()):
                return line, cells

    def _trial(self, line: int, cell: str, last: int) -> int:
        text = cell.strip()
        wanted = "1" if last == 0 else f"{last} or {last + 1}"
        if COUNT.fullmatch(text) is None or int(text) not in (last or 1, last + 1):
            raise FileError(self.path, line, f"found {TRIAL} {excerpt(text)}, expected {wanted}")
        return int(text)

    def _input(self, line: int, cell: str, inputs: Sequence[str]) -> str | None:
        text = cell.strip()
        if text and text not in inputs:
            raise FileError(
                self.path,
                line,
                f"found {INPUT} {excerpt(text)}, expected {', '.join(inputs)} or nothing",
            )
        return text or None

    def _number(self, line: int, column: str, cell: str, unit: str = "a number") -> float:
        text = cell.strip()
        value = float(text) if NUMBER.fullmatch(text) else math.nan
        if not math.isfinite(value):
            wanted = f"{unit} as a finite decimal number" if unit != "a number" else "a number"
            raise FileError(self.path, line, f"found {column} {excerpt(text)}, expected {wanted}")
        return value

    def _recorded(self, line: int, cells: Sequence[str], place: dict[str, int]) -> dict[str, Value]:
        values: dict[str, Value] = {}
        for column in self.decision_columns:
            cell = cells[place[column]].strip()
            if not cell:
                continue  # not recorded for this step
            if column in TEXT_COLUMNS:
                values[column] = cell
            elif column == MATCHED:
                if cell not in ("true", "false"):
                    raise FileError(
                        self.path, line, f"found {column} {excerpt(cell)}, expected true or false"
                    )
                values[column] = cell == "true"
            else:
                values[column] = self._number(line, column, cell)
        return values


_EXPECTED_HEADER = f"expected a header with the columns {TIME} and {INPUT}"


def _lines(path: str | os.PathLike[str], stream: BinaryIO) -> Iterator[str]:
    """The lines of the file as text; nothing longer than a line is ever held."""
    total = line = 0
    while True:
        line += 1
        try:
            raw = stream.readline(LONGEST_LINE + 1)
        except OSError as error:
            raise _unreadable(path, error) from error
        if not raw:
            return
        total += len(raw)
        if total > LARGEST_FILE:
            raise FileError(path, line, _too_large(f"{total:,} bytes"))
        if len(raw) > LONGEST_LINE:
            raise FileError(path, line, _too_large("a longer line"))
        try:
            text = raw.decode()
        except UnicodeDecodeError as error:
            raise FileError(
                path, line, f"found byte 0x{raw[error.start]:02x}, expected UTF-8 text"
            ) from error
        if "\0" in text:
            raise FileError(path, line, "found a NUL byte, expected UTF-8 text")
        yield text.removeprefix("\ufeff") if line == 1 else text


def _too_large(found: str) -> str:
    return (
        f"found {found}, expected at most {LARGEST_FILE // 10**6} MB, {MOST_ROWS:,} rows, "
        f"{LONGEST_TRIAL:,} steps a trial and {LONGEST_LINE:,} bytes a line"
    )


def _unreadable(path: str | os.PathLike[str], error: OSError) -> FileError:
    return FileError(path, None, f"found no readable file ({error.strerror}), expected a log")


def _bad_csv(problem: str) -> str:
    if "new-line" in problem:
        return "found a carriage return within the line, expected lines that end in LF or CR LF"
    if "field larger" in problem:
        return "found a quoted field without an end, expected a closing quote"
    return f"found quotes that do not pair ({problem}), expected CSV"


def _listed(columns: Sequence[str]) -> str:
    shown = ", ".join(columns[:SHOWN_COLUMNS])
    more = len(columns) - SHOWN_COLUMNS
    return excerpt(shown) if more <= 0 else f"{excerpt(shown)} and {more} more"
