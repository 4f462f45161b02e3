"""Columns: the fields of a row, each with its meaning. Codebook, files and docs come from these."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any, Literal, get_args, get_origin, get_type_hints

import msgspec

Kind = Literal["text", "integer", "number", "boolean", "numbers", "matrix"]
"""Type of the values of a column; ``numbers`` and ``matrix``: JSON arrays in CSV files."""

Row = msgspec.Struct
"""A row of a table. Its fields are annotated with a `Meaning` each."""

_KINDS: dict[object, Kind] = {
    str: "text",
    int: "integer",
    float: "number",
    bool: "boolean",
    tuple[float, ...]: "numbers",
    tuple[tuple[float, ...], ...]: "matrix",
}


@dataclass(frozen=True)
class Meaning:
    """What a column says.

    Attributes:
        text: the meaning, a sentence.
        unit: of its numbers, or "".
        values: what its values can be, where that is not plain, or "".
    """

    text: str
    unit: str = ""
    values: str = ""


@dataclass(frozen=True)
class Column:
    """A column: name, type, whether a value may be missing, and what it says."""

    name: str
    kind: Kind
    optional: bool
    meaning: Meaning


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes:
        name: as in the names of its files.
        text: what a row stands for.
        row: type of its rows.
        key: the columns that together tell rows apart.
    """

    name: str
    text: str
    row: type[Row]
    key: tuple[str, ...]

    @property
    def columns(self) -> tuple[Column, ...]:
        """In their order."""
        return _columns_of(self.row)


@cache
def _columns_of(row: type[Row]) -> tuple[Column, ...]:
    hints = get_type_hints(row, include_extras=True)
    return tuple(_column(field.name, hints[field.name]) for field in msgspec.structs.fields(row))


def _column(name: str, hint: Any) -> Column:
    value, meaning = get_args(hint)
    options = (value,) if get_origin(value) is tuple else get_args(value) or (value,)
    kinds: list[Kind] = [_KINDS[option] for option in options if option is not type(None)]
    return Column(name, kinds[0], type(None) in options, meaning)
