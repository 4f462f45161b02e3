"""The table of a sweep: a row for each trial of each cell, every parameter and seed a column."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from hashlib import sha256
from typing import Any

import msgspec

from coadapt.robots.setup import RobotSetup
from coadapt.simulation.sweep.cell import Cell
from coadapt.simulation.sweep.measure import MEASURES, Row
from coadapt.simulation.sweep.values import plain

Value = float | int | str | bool | None

PARAMETERS: tuple[tuple[str, str], ...] = (
    ("cell", "string"),
    ("task", "string"),
    ("task_sha256", "string"),
    ("robot", "string"),
    ("match_rule", "bool"),
    ("columns", "int64"),
    ("rows", "int64"),
    ("left_reward", "double"),
    ("right_reward", "double"),
    ("reward_gap", "double"),
    ("memory", "int64"),
    ("adaptability", "string"),
    ("disagreement_cost", "double"),
    ("discount", "double"),
    ("step_cost", "double"),
    ("match_threshold", "double"),
    ("gap", "double"),
)
"""Columns of the setup, with their types."""

Record = dict[str, Value]
"""One row, by the names of the columns."""

RUN: tuple[tuple[str, str], ...] = (
    ("seed", "int64"),
    ("episodes", "int64"),
    ("trials", "int64"),
    ("carry_belief", "bool"),
    ("max_steps", "int64"),
    ("exact", "bool"),
    ("tolerance", "double"),
    ("format", "int64"),
    ("coadapt", "string"),
    ("error", "string"),
    ("trial", "int64"),
)
"""Columns of how it was found out."""


@dataclass(frozen=True)
class Table:
    """The table.

    Attributes:
        kinds: the type of each column, in their order: ``string``, ``bool``, ``int64``, ``double``.
        columns: the values of each, None where there is none.
    """

    kinds: dict[str, str]
    columns: dict[str, list[Value]]

    def __len__(self) -> int:
        return len(self.columns["cell"])

    def rows(self) -> Iterator[Record]:
        """The rows in their order."""
        for values in zip(*self.columns.values(), strict=True):
            yield dict(zip(self.columns, values, strict=True))


def table_of(cells: Sequence[Cell], rows: Sequence[Sequence[Row] | str]) -> Table:
    """The table.

    Args:
        cells: in the order of the table.
        rows: for each cell its rows, or why it failed.
    """
    people = sorted({name for cell in cells for name in cell.partner})
    numeric = {n for n in people if all(_is_number(c.partner.get(n)) for c in cells)}
    kinds = {
        **dict(PARAMETERS),
        **{f"partner_{n}": "double" if n in numeric else "string" for n in people},
        **dict(RUN),
        **{column: "double" for measure in MEASURES for column in measure.columns},
    }
    columns: dict[str, list[Value]] = {name: [] for name in kinds}
    for cell, found in zip(cells, rows, strict=True):
        shared = parameters(cell)
        for name in people:
            shared[f"partner_{name}"] = _cell_of(cell.partner.get(name), name in numeric)
        if isinstance(found, str):
            _add(columns, shared | {"error": found})
            continue
        for trial, row in enumerate(found, start=1):
            _add(columns, shared | row | {"trial": trial})
    return Table(kinds, columns)


def _add(columns: dict[str, list[Value]], row: Record) -> None:
    for name, column in columns.items():
        column.append(row.get(name))


def _cell_of(value: object, is_number: bool) -> Value:
    """A value of a partner as the table has it: what is no number in a column of text as JSON."""
    if value is None or is_number or isinstance(value, str):
        return value  # pyright: ignore[reportReturnType]
    return _json(value)


def parameters(cell: Cell) -> Record:
    """The values of the columns that all rows of a cell share."""
    setup = cell.setup
    rewards = sorted(cell.rewards.values())
    values: dict[str, Any] = msgspec.to_builtins(cell)
    values |= {"cell": cell.key, "reward_gap": plain(rewards[-1] - rewards[0])}
    if isinstance(setup, RobotSetup):
        values |= msgspec.to_builtins(setup) | {"task": "table_clearing"}
        values["adaptability"] = _json(setup.adaptability)
    else:
        task = setup.task
        values |= msgspec.to_builtins(setup) | msgspec.to_builtins(task.model)
        values["task"] = task.name
        values["task_sha256"] = sha256(msgspec.json.encode(task, order="sorted")).hexdigest()
        values["adaptability"] = _json(task.adaptability)
    if not cell.match_rule:
        values["match_threshold"] = None
    wanted = {name for name, _ in (*PARAMETERS, *RUN)}
    return {name: value for name, value in values.items() if name in wanted}


def _json(value: object) -> str:
    return msgspec.json.encode(value, order="sorted").decode()


def _is_number(value: object) -> bool:
    return value is None or (isinstance(value, float | int) and not isinstance(value, bool))
