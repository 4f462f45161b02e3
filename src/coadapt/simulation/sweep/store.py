"""Finished cells on disk: a file each, complete or not there at all.

    DIR/cells/KEY.json      what is known of the cell with that key
    DIR/failed/KEY.json     why a cell failed, until it succeeds
    DIR/log.jsonl           a line for everything done: when, where, how long

Files appear by renaming, so any number of processes may share a directory, and one may be killed at
any point. Equal cells have equal files, whoever writes them: times are in the log alone.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

import msgspec

from coadapt.errors import FileError
from coadapt.momdp.files.atomic import replacing
from coadapt.simulation.sweep.cell import Cell
from coadapt.simulation.sweep.grid import FORMAT
from coadapt.simulation.sweep.measure import Row
from coadapt.simulation.sweep.work import Failure


class _CellFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    format: int
    cell: msgspec.Raw
    rows: list[Row]


class Store:
    """The finished cells of a directory.

    Args:
        directory: made if it is not there.

    Raises:
        FileError: if it cannot be made.
    """

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        try:
            for part in ("cells", "failed"):
                (directory / part).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise FileError(directory, None, f"cannot be made: {error.strerror}") from error

    def has(self, cell: Cell) -> bool:
        """Whether ``cell`` is finished."""
        return self._path(cell).exists()

    def finished(self) -> set[str]:
        """The keys of all finished cells."""
        names = os.listdir(self.directory / "cells")
        return {name.removesuffix(".json") for name in names if not name.startswith(".")}

    def add(self, cell: Cell, rows: list[Row]) -> None:
        """Keep the result of ``cell``.

        Raises:
            FileError: if it cannot be written.
        """
        content = _CellFile(FORMAT, msgspec.Raw(cell.content), rows)
        with replacing(self._path(cell)) as file:
            file.write(msgspec.json.encode(content) + b"\n")
        self._failed(cell).unlink(missing_ok=True)

    def rows(self, cell: Cell) -> list[Row]:
        """The result of ``cell``.

        Raises:
            FileError: if the file is not there, damaged or of another cell.
        """
        path = self._path(cell)
        try:
            found = msgspec.json.decode(path.read_bytes(), type=_CellFile)
        except OSError as error:
            raise FileError(path, None, f"cannot be read: {error.strerror}") from error
        except (msgspec.MsgspecError, UnicodeDecodeError) as error:
            again = "remove it to run the cell again"
            raise FileError(path, None, f"found a damaged file ({error}); {again}") from error
        if found.format != FORMAT or bytes(found.cell) != cell.content:
            raise FileError(path, None, "found another cell than its name says; remove it")
        return found.rows

    def add_failure(self, cell: Cell, failure: Failure) -> None:
        """Note that ``cell`` failed. It is tried again the next time."""
        content = {
            "format": FORMAT,
            "cell": msgspec.Raw(cell.content),
            "message": failure.message,
            "details": failure.details,
        }
        with replacing(self._failed(cell)) as file:
            file.write(msgspec.json.encode(content) + b"\n")

    def log(self, entry: Mapping[str, object]) -> None:
        """Add a line to the log, whole even where several processes write."""
        line = msgspec.json.encode(entry) + b"\n"
        path = self.directory / "log.jsonl"
        descriptor = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
        try:
            os.write(descriptor, line)
        finally:
            os.close(descriptor)

    def _path(self, cell: Cell) -> Path:
        return self.directory / "cells" / f"{cell.key}.json"

    def _failed(self, cell: Cell) -> Path:
        return self.directory / "failed" / f"{cell.key}.json"
