"""The door: a file or folder of data, in any of its forms."""

from __future__ import annotations

import os
from hashlib import sha256
from pathlib import Path

import msgspec

from coadapt.analysis.data import counts, export, own_table
from coadapt.analysis.data.declaration import Declaration, read_declaration
from coadapt.analysis.data.rows import read_table
from coadapt.analysis.data.study_data import StudyData
from coadapt.errors import FileError

TABLES = ("participants", "trials", "steps", "answers")


def read_data(
    path: str | os.PathLike[str],
    plan: str | os.PathLike[str] | None = None,
    *,
    with_steps: bool = True,
) -> StudyData:
    """The data of a study.

    Args:
        path: the folder that `coadapt study export` writes; a CSV file of counts, see `counts`; or
            one
            with a row for each participant, see `own_table`.
        plan: a file with conditions, scales and hypotheses; that of the export if left out.
        with_steps: whether the steps of an export are read, too.

    Raises:
        FileError: if a file cannot be read or used; names the line where there is one.
    """
    source = Path(path)
    if source.is_dir():
        return _from_folder(source, plan, with_steps=with_steps)
    table = read_table(source)
    declared, declared_hash = Declaration(), ""
    if plan is not None:
        declared, declared_hash = read_declaration(plan)
    make = counts.from_counts if set(counts.COLUMNS) <= set(table.columns) else own_table.from_table
    data = make(table, declared, sha256(source.read_bytes()).hexdigest())
    return msgspec.structs.replace(
        data, declared_in="" if plan is None else Path(plan).name, declared_sha256=declared_hash
    )


def _from_folder(
    folder: Path, plan: str | os.PathLike[str] | None, *, with_steps: bool
) -> StudyData:
    protocol = folder / export.PROTOCOL
    if plan is None and not protocol.is_file():
        expected = f"expected {export.PROTOCOL} in an export, or a plan"
        raise FileError(folder, None, f"found no protocol, {expected}")
    declared, declared_hash = read_declaration(protocol if plan is None else plan)
    paths = [export.table_path(folder, name) for name in TABLES]
    digest = sha256()
    for path in sorted(paths):
        digest.update(path.read_bytes())
    data = export.from_export(folder, declared, digest.hexdigest(), with_steps=with_steps)
    return msgspec.structs.replace(
        data,
        declared_in=export.PROTOCOL if plan is None else Path(plan).name,
        declared_sha256=declared_hash,
    )
