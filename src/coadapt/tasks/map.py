"""The part of a task that describes its place as a map drawn in text."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from coadapt.errors import excerpt
from coadapt.requirements import (
    LARGEST_REWARD,
    MOST_ACTIONS,
    MOST_STATES,
    FieldError,
    require,
    require_chance,
    require_names,
)
from coadapt.tasks.goal import FREE, OBSTACLE, START, TaskGoal
from coadapt.worlds import World, grid
from coadapt.worlds.grid import Cell

DIRECTIONS: dict[str, Cell] = {
    "left": (-1, 0),
    "forward": (0, 1),
    "right": (1, 0),
    "back": (0, -1),
    "forward left": (-1, 1),
    "forward right": (1, 1),
    "back left": (-1, -1),
    "back right": (1, -1),
    "stay": (0, 0),
}
"""The moves on a map, cells to the right and ahead."""


class TaskMap(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Cells drawn in text, the farthest row first; the person is below.

    Attributes:
        drawing: lines of ``.`` free cells, ``#`` obstacles, ``@`` where the robot starts (if there
            are several each is as likely) and the goals' symbols.
        moves: the robot's actions, of `DIRECTIONS`.
        slip: probability that the robot does another of its moves instead, all alike.
        move_cost: what each move costs the robot, in units of reward, at least 0.
    """

    drawing: str
    moves: tuple[str, ...] = ("left", "forward", "right")
    slip: float = 0.0
    move_cost: float = 0.0

    def __post_init__(self) -> None:
        require_names(("moves",), self.moves, MOST_ACTIONS)
        for move in self.moves:
            require(
                ("moves",), move in DIRECTIONS, f"some of {', '.join(DIRECTIONS)}", excerpt(move)
            )
        require_chance(("slip",), self.slip, most_included=False)
        require_chance(("move_cost",), self.move_cost, LARGEST_REWARD, most_included=True)
        size = len(self.drawing)
        few = f"so small that it has at most {MOST_STATES:,} cells"
        require(("drawing",), size <= 2 * MOST_STATES, few, f"{size:,} characters")
        lines = self.lines
        require(("drawing",), bool(lines), "lines of cells", "empty")
        cells = len(lines) * len(lines[0])
        require(("drawing",), cells <= MOST_STATES, few, f"{cells:,}")
        for i, line in enumerate(lines, start=1):
            if len(line) != len(lines[0]):
                raise FieldError(
                    ("drawing",),
                    f"has {len(line)} cells in its line {i}, expected {len(lines[0])} as in its "
                    "first line",
                )

    @property
    def lines(self) -> list[str]:
        """The lines of the drawing, without blank ones around it and blanks beside it."""
        return [line.strip() for line in self.drawing.strip().splitlines()]

    def cells(self) -> dict[str, list[Cell]]:
        """The cells of each symbol, row by row from the near left corner."""
        found: dict[str, list[Cell]] = {}
        for row, line in enumerate(reversed(self.lines)):
            for column, symbol in enumerate(line):
                found.setdefault(symbol, []).append((column, row))
        return found

    def build(self, name: str, goals: Sequence[TaskGoal]) -> World:
        """The world.

        Raises:
            FieldError: if the drawing and the goals do not fit together.
        """
        cells = self.cells()
        owner: dict[str, str] = {}
        for i, goal in enumerate(goals):
            if goal.states is not None:
                raise FieldError(("goals", i, "states"), "is for graphs; a map has symbols")
            if goal.mark in (FREE, OBSTACLE, START):
                raise FieldError(("goals", i, "name"), "needs a symbol beside it")
            if goal.mark in owner:
                raise FieldError(
                    ("goals", i, "symbol"),
                    f"is {goal.mark!r} like that of {owner[goal.mark]}, expected another",
                )
            owner[goal.mark] = goal.name
            if goal.mark not in cells:
                raise FieldError(
                    ("map", "drawing"), f"has no cell {goal.mark!r}, expected one for {goal.name}"
                )
        for symbol, where in cells.items():
            if symbol not in (FREE, OBSTACLE, START, *owner):
                column, row = where[0]
                known = " ".join([FREE, OBSTACLE, START, *owner])
                raise FieldError(
                    ("map", "drawing"),
                    f"has {excerpt(symbol)} in its line {len(self.lines) - row}, column "
                    f"{column + 1}, expected one of {known}",
                )
        starts = cells.get(START, [])
        if not starts:
            raise FieldError(("map", "drawing"), f"has no {START}, expected one where it starts")
        return grid(
            len(self.lines[0]),
            len(self.lines),
            starts[0] if len(starts) == 1 else {cell: 1 / len(starts) for cell in starts},
            [(goal.name, cells[goal.mark], goal.reward) for goal in goals],
            actions={move: DIRECTIONS[move] for move in self.moves},
            obstacles=cells.get(OBSTACLE, []),
            slip=self.slip,
            move_cost=self.move_cost,
            name=name,
        )
