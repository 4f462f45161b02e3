"""The table of a sweep as Parquet and CSV. Equal tables give equal bytes."""

from __future__ import annotations

import csv
import io
from importlib import import_module
from pathlib import Path
from typing import Any

from coadapt.momdp.files.atomic import replacing
from coadapt.simulation.sweep.grid import FORMAT
from coadapt.simulation.sweep.table import Table

PARQUET, CSV = "results.parquet", "results.csv"

FORMAT_KEY = "coadapt.sweep"
"""Under which the version of the format stands in the metadata of the Parquet file."""


def write_table(table: Table, directory: Path) -> None:
    """Write both files.

    Raises:
        FileError: if a file cannot be written.
    """
    # pyarrow comes without types, and is heavy.
    pa: Any = import_module("pyarrow")
    pq: Any = import_module("pyarrow.parquet")
    types = {
        "string": pa.string(),
        "bool": pa.bool_(),
        "int64": pa.int64(),
        "double": pa.float64(),
    }
    schema = pa.schema([(name, types[kind]) for name, kind in table.kinds.items()])
    arrays = pa.table(table.columns, schema=schema.with_metadata({FORMAT_KEY: str(FORMAT)}))
    with replacing(directory / PARQUET) as file:
        pq.write_table(arrays, file, compression="zstd")
    with replacing(directory / CSV) as file:
        text = io.TextIOWrapper(file, encoding="utf-8", newline="")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(table.columns)
        writer.writerows(zip(*table.columns.values(), strict=True))
        text.flush()
        _ = text.detach()
