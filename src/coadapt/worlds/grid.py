"""Grid worlds: cells in columns and rows, moves to a neighbouring cell."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from coadapt.worlds.world import Goal, World

Cell = tuple[int, int]
"""Column and row, both from 0; columns count to the right, rows count away from the person."""

THREE_WAYS: Mapping[str, Cell] = {"left": (-1, 0), "forward": (0, 1), "right": (1, 0)}
"""The robot and human actions of the paper."""

FOUR_WAYS: Mapping[str, Cell] = {**THREE_WAYS, "back": (0, -1)}

FIVE_WAYS: Mapping[str, Cell] = {**FOUR_WAYS, "stay": (0, 0)}


def grid(
    columns: int,
    rows: int,
    start: Cell,
    goals: Sequence[tuple[str, Cell, float]],
    *,
    actions: Mapping[str, Cell] = THREE_WAYS,
    obstacles: Collection[Cell] = (),
    name: str = "grid",
) -> World:
    """A rectangular grid; a move off the grid or into an obstacle is a no-op.

    Args:
        columns, rows: size of the grid.
        start: cell in which the robot starts.
        goals: name, cell and reward of each goal.
        actions: name and displacement of each action.
        obstacles: cells that are no states.
        name: identifier of the world.

    Returns:
        A world whose states are numbered row by row from the near left corner, obstacles left out.

    Raises:
        ValueError: if a cell is off the grid, the start or a goal is an obstacle, or the goals are
            unusable.
    """
    needed = [("start", start), *((f"goal {g}", cell) for g, cell, _ in goals)]
    for what, (c, r) in [*needed, *(("obstacle", cell) for cell in obstacles)]:
        if not (0 <= c < columns and 0 <= r < rows):
            raise ValueError(f"{what} at column {c}, row {r} is off the {columns} x {rows} grid")
    free = np.ones((rows, columns), dtype=np.bool_)
    for c, r in obstacles:
        free[r, c] = False
    for what, (c, r) in needed:
        if not free[r, c]:
            raise ValueError(f"{what} at column {c}, row {r} is an obstacle")
    row, column = np.nonzero(free)
    number = np.cumsum(free).reshape(free.shape) - 1  # [rows, columns], of the free cells
    directions = np.array(list(actions.values()), dtype=np.int64)
    to_column, to_row = column[:, None] + directions[:, 0], row[:, None] + directions[:, 1]
    on_grid = (to_column >= 0) & (to_column < columns) & (to_row >= 0) & (to_row < rows)
    # What lies off the grid is looked up at the cell itself.
    to_column, to_row = (
        np.where(on_grid, to, here[:, None]) for to, here in ((to_column, column), (to_row, row))
    )
    here = number[row, column][:, None]
    return World(
        name=name,
        moves=np.where(free[to_row, to_column], number[to_row, to_column], here),
        goals=tuple(Goal(g, int(number[r, c]), reward) for g, (c, r), reward in goals),
        start=int(number[start[1], start[0]]),
        state_names=tuple(f"column {c} row {r}" for r, c in zip(row, column, strict=True)),
        action_names=tuple(actions),
        positions=np.stack([column, row], axis=1).astype(np.float64),
        directions=directions.astype(np.float64),
    )
