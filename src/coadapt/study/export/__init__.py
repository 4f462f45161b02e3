"""The data of a study as tables that can be published and analysed."""

from coadapt.study.export.column import Column, Meaning, Table
from coadapt.study.export.export import export
from coadapt.study.export.materials import Counts, Manifest
from coadapt.study.export.tables import FORMAT, TABLES

__all__ = [
    "FORMAT",
    "TABLES",
    "Column",
    "Counts",
    "Manifest",
    "Meaning",
    "Table",
    "export",
]
