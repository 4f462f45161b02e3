"""Grid worlds: cells in columns and rows, moves to a neighbouring cell."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.human.history import NO_STATE
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
    start: Cell | Mapping[Cell, float],
    goals: Sequence[tuple[str, Cell | Sequence[Cell], float]],
    *,
    actions: Mapping[str, Cell] = THREE_WAYS,
    obstacles: Collection[Cell] = (),
    slip: float = 0.0,
    move_cost: float = 0.0,
    name: str = "grid",
) -> World:
    """A rectangular grid; a move off the grid or into an obstacle is a no-op.

    Args:
        columns, rows: size of the grid.
        start: cell in which the robot starts, or several with their probabilities, the first of
            them the world's ``start``.
        goals: name, cell (or cells, for a goal region) and reward of each goal.
        actions: name and displacement of each action.
        obstacles: cells that are no states.
        slip: probability that the robot does one of the other actions, all alike, in [0, 1).
        move_cost: what each move costs the robot, at least 0.
        name: identifier of the world.

    Returns:
        A world whose states are numbered row by row from the near left corner, obstacles left out.

    Raises:
        ValueError: if a cell is off the grid, the start or a goal is an obstacle, or the goals are
            unusable.
    """
    starts = start if isinstance(start, Mapping) else {start: 1.0}
    regions = [(goal, _cells(where), reward) for goal, where, reward in goals]
    needed = [("start", cell) for cell in starts]
    needed += [(f"goal {goal}", cell) for goal, cells, _ in regions for cell in cells]
    for what, (c, r) in [*needed, *(("obstacle", cell) for cell in obstacles)]:
        if not (0 <= c < columns and 0 <= r < rows):
            raise ValueError(f"{what} at column {c}, row {r} is off the {columns} x {rows} grid")
    free = np.ones((rows, columns), dtype=np.bool_)
    for c, r in obstacles:
        free[r, c] = False
    for what, (c, r) in needed:
        if not free[r, c]:
            raise ValueError(f"{what} at column {c}, row {r} is an obstacle")
    if not 0 <= slip < 1:
        raise ValueError(f"slip must lie in [0, 1), not {slip}")
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
    moves = np.where(free[to_row, to_column], number[to_row, to_column], here)
    chances = None
    if slip > 0:
        moves, chances = slipping(moves, slip)
    return World(
        name=name,
        moves=moves,
        goals=tuple(
            Goal(goal, tuple(int(number[r, c]) for c, r in cells), reward)
            for goal, cells, reward in regions
        ),
        start=int(next(number[r, c] for c, r in starts)),
        state_names=tuple(f"column {c} row {r}" for r, c in zip(row, column, strict=True)),
        action_names=tuple(actions),
        positions=np.stack([column, row], axis=1).astype(np.float64),
        directions=directions.astype(np.float64),
        chances=chances,
        starts={int(number[r, c]): chance for (c, r), chance in starts.items()},
        costs=np.full((len(row), len(actions)), move_cost) if move_cost != 0 else None,
    )


def slipping(moves: IntArray, slip: float) -> tuple[IntArray, FloatArray]:
    """Uncertain moves: now and then the robot does another action than it decided.

    Args:
        moves: ``[X, A]`` the state each action leads to.
        slip: probability of one of the other actions, all alike, in (0, 1).

    Returns:
        Moves and chances ``[X, A, N]`` as in `World`.
    """
    actions = moves.shape[1]
    share = np.full((actions, actions), slip / max(actions - 1, 1))
    np.fill_diagonal(share, 1.0 - slip if actions > 1 else 1.0)
    # Actions that lead to the same state are one outcome, the first of them.
    first = np.argmax(moves[:, :, None] == moves[:, None, :], axis=2)  # [X, A]
    joins = np.eye(actions)[first]  # [X, A, N]
    chances = np.einsum("ab,xbn->xan", share, joins)
    outcomes = np.broadcast_to(moves[:, None, :], chances.shape)
    return np.where(chances > 0, outcomes, NO_STATE), chances


def _cells(where: Cell | Sequence[Cell]) -> tuple[Cell, ...]:
    """A cell, or several, as several."""
    cells = np.array(where, dtype=np.int64).reshape(-1, 2)
    return tuple((int(c), int(r)) for c, r in cells)
