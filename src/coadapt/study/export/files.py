"""Writing the rows of a table to its CSV and Parquet files, however many there are."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from contextlib import ExitStack
from importlib import import_module
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import msgspec

from coadapt.study.export.column import Column, Kind, Row, Table

BATCH = 20_000
"""Rows held in memory, and of a row group of the Parquet file."""


def csv_name(table: Table) -> str:
    """Name of the CSV file in the folder ``data``, as Psych-DS wants it."""
    return f"description-{table.name}_data.csv"


class TableFiles:
    """The files of a table. A context; they are whole once it is left.

    Args:
        table: what is written.
        data: folder of the CSV file.
        parquet: folder of the Parquet file.
    """

    def __init__(self, table: Table, data: Path, parquet: Path) -> None:
        # pyarrow comes without types, and is heavy.
        pq: Any = import_module("pyarrow.parquet")
        self.rows = 0
        self._columns = table.columns
        self._held: list[Row] = []
        self._schema = _schema(self._columns)
        with ExitStack() as stack:
            file = (data / csv_name(table)).open("w", encoding="utf-8", newline="")
            self._csv = csv.writer(stack.enter_context(file), lineterminator="\n")
            self._csv.writerow(column.name for column in self._columns)
            self._parquet = stack.enter_context(
                pq.ParquetWriter(parquet / f"{table.name}.parquet", self._schema)
            )
            self._stack = stack.pop_all()

    def write(self, rows: Iterable[Row]) -> None:
        """Add rows."""
        for row in rows:
            self._held.append(row)
            if len(self._held) >= BATCH:
                self._flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is None:
            self._flush()
        self._stack.close()

    def _flush(self) -> None:
        pa: Any = import_module("pyarrow")
        rows = [msgspec.structs.astuple(row) for row in self._held]
        self._csv.writerows([_cell(value) for value in row] for row in rows)
        columns: list[Any] = list(zip(*rows, strict=True)) or [()] * len(self._columns)
        arrays = [
            pa.array(values, type=field.type)
            for values, field in zip(columns, self._schema, strict=True)
        ]
        if rows:
            self._parquet.write_table(pa.Table.from_arrays(arrays, schema=self._schema))
        self.rows += len(rows)
        self._held.clear()


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return msgspec.json.encode(value).decode()
    return value if isinstance(value, str) else repr(value)


def _schema(columns: Iterable[Column]) -> Any:
    """The schema of the Parquet file, each column with its meaning."""
    pa: Any = import_module("pyarrow")
    types: dict[Kind, Any] = {
        "text": pa.string(),
        "integer": pa.int64(),
        "number": pa.float64(),
        "boolean": pa.bool_(),
        "numbers": pa.list_(pa.float64()),
        "matrix": pa.list_(pa.list_(pa.float64())),
    }
    return pa.schema(
        [
            pa.field(c.name, types[c.kind], nullable=c.optional).with_metadata(
                {"description": c.meaning.text}
            )
            for c in columns
        ]
    )
