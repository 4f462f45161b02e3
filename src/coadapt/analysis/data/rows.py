"""Rows of CSV files with their lines."""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import msgspec

from coadapt.errors import FileError, excerpt

MISSING = frozenset({"", "NA", "NaN", "nan", "n/a", "N/A", "null", "None"})
"""Cells that hold no value."""

TRUE, FALSE = frozenset({"true", "1", "yes"}), frozenset({"false", "0", "no"})


class Row(msgspec.Struct, frozen=True):
    """A row of a table.

    Attributes:
        line: where it begins in the file, from 1.
        cells: by the column's name; without those that hold no value.
    """

    line: int
    cells: Mapping[str, str]

    def get(self, column: str) -> str | None:
        """The cell; None if it holds no value."""
        return self.cells.get(column)


class Table(msgspec.Struct, frozen=True):
    """A CSV file.

    Attributes:
        path: of the file.
        columns: their names.
        rows: all rows.
    """

    path: Path
    columns: tuple[str, ...]
    rows: tuple[Row, ...]

    @property
    def name(self) -> str:
        """Of the file."""
        return self.path.name

    def require(self, columns: Sequence[str]) -> None:
        """Raise FileError unless there are all of these columns."""
        for column in columns:
            if column not in self.columns:
                found = ", ".join(self.columns[:12]) + (", ..." if len(self.columns) > 12 else "")
                raise FileError(self.path, 1, f"expected a column {column!r}, found {found}")


def read_table(path: str | os.PathLike[str]) -> Table:
    """The table in a CSV file with a header.

    Raises:
        FileError: if it cannot be read, or a row has more cells than the header.
    """
    try:
        with Path(path).open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file, strict=True)
            header = [name.strip() for name in next(reader, list[str]())]
            if not any(header):
                raise FileError(path, 1, "found nothing, expected a CSV file with a header")
            twice = [name for i, name in enumerate(header) if name and name in header[:i]]
            if twice:
                raise FileError(path, 1, f"has the column {excerpt(twice[0])} twice")
            return Table(Path(path), tuple(header), tuple(_rows(path, reader, header)))
    except OSError as error:
        found = f"found no readable file ({error.strerror}), expected a CSV file"
        raise FileError(path, None, found) from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise FileError(path, None, f"is no CSV file in UTF-8: {error}") from error


def _rows(path: object, reader: Iterator[list[str]], header: Sequence[str]) -> Iterator[Row]:
    line = 2
    for cells in reader:
        if any(cell.strip() for cell in cells):
            if len(cells) > len(header):
                wanted = f"expected at most {len(header)}, as in the header"
                raise FileError(path, line, f"found {len(cells)} cells, {wanted}")
            pairs = zip(header, (cell.strip() for cell in cells), strict=False)
            yield Row(line, {name: cell for name, cell in pairs if cell not in MISSING})
        line = getattr(reader, "line_num", line) + 1


def as_number(text: str | None) -> float | None:
    """The finite number that ``text`` is; None if it is none."""
    try:
        value = float(text or "")
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def as_count(text: str | None) -> int | None:
    """The whole number that ``text`` is; None if it is none."""
    value = as_number(text)
    return int(value) if value is not None and value.is_integer() else None


def as_flag(text: str | None) -> bool | None:
    """Whether ``text`` says yes; None if it says neither yes nor no."""
    word = (text or "").lower()
    return True if word in TRUE else False if word in FALSE else None
