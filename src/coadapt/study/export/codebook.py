"""The codebook: what every column means, as Markdown, JSON and Psych-DS metadata."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from coadapt.study.export.column import Column, Table
from coadapt.study.export.files import csv_name
from coadapt.study.export.tables import TABLES
from coadapt.study.protocol import Study

TYPES = {
    "text": "text",
    "integer": "whole number",
    "number": "number",
    "boolean": "true or false",
    "numbers": "list of numbers",
    "matrix": "list of lists of numbers",
}
"""The types of columns, in words."""


def markdown(tables: Iterable[Table] = TABLES, heading: str = "##") -> str:
    """The codebook of ``tables``, a section each."""
    return "\n".join(_section(table, heading) for table in tables)


def _section(table: Table, heading: str) -> str:
    lines = [
        f"{heading} {table.name}",
        "",
        f"{table.text} Rows are told apart by {_listed(table.key)}.",
        "",
        "| column | type | unit | meaning |",
        "| --- | --- | --- | --- |",
    ]
    for column in table.columns:
        kind = TYPES[column.kind] + (", may be missing" if column.optional else "")
        lines.append(f"| `{column.name}` | {kind} | {column.meaning.unit} | {_said(column)} |")
    return "\n".join([*lines, ""])


def _said(column: Column) -> str:
    meaning = column.meaning
    return f"{meaning.text} ({meaning.values})" if meaning.values else meaning.text


def _listed(names: Sequence[str]) -> str:
    quoted = [f"`{name}`" for name in names]
    return " and ".join([", ".join(quoted[:-1]), quoted[-1]]) if len(quoted) > 1 else quoted[0]


def as_data() -> dict[str, Any]:
    """The codebook as JSON data: a list of columns by the name of the table."""
    return {
        table.name: [
            {
                "name": column.name,
                "type": column.kind,
                "optional": column.optional,
                "meaning": column.meaning.text,
                "unit": column.meaning.unit,
                "values": column.meaning.values,
            }
            for column in table.columns
        ]
        for table in TABLES
    }


def variables(table: Table) -> list[dict[str, str]]:
    """The columns of ``table`` as schema.org property values."""
    return [_variable(column.name, _said(column), column.meaning.unit) for column in table.columns]


def _variable(name: str, description: str, unit: str) -> dict[str, str]:
    variable = {"@type": "PropertyValue", "name": name, "description": description}
    return variable | ({"unitText": unit} if unit else {})


def dataset_description(study: Study, version: str) -> dict[str, Any]:
    """Psych-DS's description of a whole export of ``study``, written by coadapt ``version``."""
    said: dict[str, dict[str, list[str]]] = {}
    for table in TABLES:
        for column in table.columns:
            said.setdefault(column.name, {}).setdefault(_said(column), []).append(table.name)
    return {
        "@context": "https://schema.org",
        "@type": "Dataset",
        "name": study.title,
        "description": (
            "Data of a study of human-robot mutual adaptation in shared autonomy: participants "
            f"steered a robot in the task {study.task}. Written by coadapt {version}."
        ),
        "schemaVersion": "Psych-DS 0.1.0",
        "keywords": ["human-robot interaction", "shared autonomy", "mutual adaptation"],
        "variableMeasured": [
            _variable(name, _in_tables(meanings), "") for name, meanings in said.items()
        ],
    }


def sidecar(table: Table) -> dict[str, Any]:
    """Psych-DS's description of the one file ``csv_name(table)``."""
    return {
        "name": csv_name(table),
        "description": table.text,
        "variableMeasured": variables(table),
    }


def _in_tables(meanings: dict[str, list[str]]) -> str:
    if len(meanings) == 1:
        return next(iter(meanings))
    return " ".join(f"In {' and '.join(tables)}: {text}" for text, tables in meanings.items())
