"""Grid worlds: cells in columns and rows, moves to a neighbouring cell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from coadapt.worlds.world import Goal, World

Cell = tuple[int, int]
"""Column and row, both from 0; columns count to the right, rows count away from the person."""

THREE_WAYS: Mapping[str, Cell] = {"left": (-1, 0), "forward": (0, 1), "right": (1, 0)}
"""The robot and human actions of the paper."""


def grid(
    columns: int,
    rows: int,
    start: Cell,
    goals: Sequence[tuple[str, Cell, float]],
    *,
    actions: Mapping[str, Cell] = THREE_WAYS,
    name: str = "grid",
) -> World:
    """A rectangular grid; a move off the grid is a no-op.

    Args:
        columns, rows: size of the grid.
        start: cell in which the robot starts.
        goals: name, cell and reward of each goal.
        actions: name and displacement of each action.
        name: identifier of the world.

    Returns:
        A world whose states are numbered row by row from the near left corner.

    Raises:
        ValueError: if a cell is off the grid or the goals are unusable.
    """
    for what, (c, r) in [("start", start), *((f"goal {g}", cell) for g, cell, _ in goals)]:
        if not (0 <= c < columns and 0 <= r < rows):
            raise ValueError(f"{what} at column {c}, row {r} is off the {columns} x {rows} grid")
    row, column = np.divmod(np.arange(columns * rows), columns)
    directions = np.array(list(actions.values()), dtype=np.int64)
    to_column, to_row = column[:, None] + directions[:, 0], row[:, None] + directions[:, 1]
    on_grid = (to_column >= 0) & (to_column < columns) & (to_row >= 0) & (to_row < rows)
    here = np.arange(columns * rows)[:, None]
    return World(
        name=name,
        moves=np.where(on_grid, to_row * columns + to_column, here),
        goals=tuple(Goal(g, r * columns + c, reward) for g, (c, r), reward in goals),
        start=start[1] * columns + start[0],
        state_names=tuple(f"column {c} row {r}" for r, c in zip(row, column, strict=True)),
        action_names=tuple(actions),
        positions=np.stack([column, row], axis=1).astype(np.float64),
        directions=directions.astype(np.float64),
    )
