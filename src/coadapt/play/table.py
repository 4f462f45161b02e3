"""The table: cells, goals, the robot and the way it came."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from rich.text import Text
from textual.geometry import Size
from textual.widget import Widget

from coadapt.arrays import FloatArray
from coadapt.robots import Decision
from coadapt.worlds import World

ARROWS = {
    (-1, 0): "←",
    (0, 1): "↑",
    (1, 0): "→",
    (0, -1): "↓",
    (-1, 1): "↖",
    (1, 1): "↗",
    (1, -1): "↘",
    (-1, -1): "↙",
}
FREE, ROBOT, START, NECK, BOTTLE = "·", "●", "○", "╷", "█"
OBSTACLE = "▒"

SMALLEST_CELL = 2
LARGEST_CELL = 6
"""Characters across; so that the table keeps its shape."""


def arrow(direction: FloatArray) -> str:
    """The direction ``[2]`` of an action or input as a character."""
    right, ahead = np.sign(direction.round(1))
    return ARROWS.get((int(right), int(ahead)), "•")


def is_table(world: World) -> bool:
    """Whether it is the paper's task, with two bottles to name above the far row."""
    return world.name.startswith("table_clearing")


def goal_labels(world: World) -> tuple[str, ...]:
    """The goals' names; with the digits that stand in their cells where they are no bottles."""
    names = [goal.name for goal in world.goals]
    return tuple(names if is_table(world) else [f"{_mark(g)} {n}" for g, n in enumerate(names)])


def _mark(goal: int) -> str:
    return f"{goal + 1}" if goal < 9 else BOTTLE


@dataclass(frozen=True)
class Scene:
    """What the table shows.

    Attributes:
        world: the table.
        state: where the robot is.
        decisions: the steps of this trial so far.
    """

    world: World
    state: int
    decisions: Sequence[Decision]


class TableView(Widget):
    """Draws a `Scene` as large as there is room; around the robot where there is too little."""

    COMPONENT_CLASSES: ClassVar[set[str]] = {
        "table--free",
        "table--trail",
        "table--robot",
        "table--goal",
        "table--label",
    }
    DEFAULT_CSS = """
    TableView {
        & > .table--free { color: $foreground-muted; }
        & > .table--trail { color: $primary-lighten-2; text-style: bold; }
        & > .table--robot { color: $warning; text-style: bold; }
        & > .table--goal { color: $success; text-style: bold; }
        & > .table--label { color: $foreground; text-style: bold; }
    }
    """

    scene: Scene | None = None

    def show(self, scene: Scene) -> None:
        """Draw ``scene`` from now on."""
        self.scene = scene
        self.refresh(layout=True)

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Lines at the smallest size: the rows and a label above and below."""
        return 2 + (0 if self.scene is None else _extent(self.scene.world)[1])

    def render(self) -> Text:
        """The drawing."""
        if self.scene is None:
            return Text()
        return self._draw(self.scene)

    def _draw(self, scene: Scene) -> Text:
        world = scene.world
        columns, rows = _extent(world)
        room = self.size
        across = max(SMALLEST_CELL, min(LARGEST_CELL, room.width // columns))
        down = max(1, min((across + 1) // 2, (room.height - 2) // rows))
        here, there = (
            _cell(world, scene.state),
            {_cell(world, state): g for g in world.goals for state in g.states},
        )
        first_column, shown_columns = _window(here[0], columns, room.width // across)
        first_row, shown_rows = _window(here[1], rows, (room.height - 2) // down)
        trail = {_cell(world, d.state): arrow(world.directions[d.action]) for d in scene.decisions}
        start = _cell(world, world.start)
        cells = {_cell(world, state) for state in range(world.states)}
        marks = {
            _cell(world, x): _mark(g) for g, goal in enumerate(world.goals) for x in goal.states
        }

        text = Text("\n" * max(0, (room.height - 2 - shown_rows * down) // 2), no_wrap=True)
        margin = " " * max(0, (room.width - shown_columns * across) // 2)
        above, below = (_Labels(shown_columns * across) for _ in range(2))
        for cell, goal in there.items() if is_table(world) else ():
            middle = (cell[0] - first_column) * across + across // 2
            above.add(middle, f"{goal.name} {goal.reward:g}", "‹ ", " ›")
        below.add((start[0] - first_column) * across + across // 2, "start")
        label = self.get_component_rich_style("table--label")
        text.append(f"{margin}{above}\n", label)
        for row in range(first_row + shown_rows - 1, first_row - 1, -1):
            upper, lower = Text(margin), Text(margin)
            for column in range(first_column, first_column + shown_columns):
                cell = column, row
                glyph, part = FREE, "free"
                if cell not in cells:
                    glyph = OBSTACLE
                elif cell in there:
                    glyph, part = BOTTLE if is_table(world) else marks[cell], "goal"
                elif cell in trail:
                    glyph, part = trail[cell], "trail"
                elif cell == start:
                    glyph = START
                if cell == here:
                    glyph, part = ROBOT, "robot"
                style = self.get_component_rich_style(f"table--{part}")
                lower.append(_centred(glyph, across), style)
                neck = NECK if is_table(world) and cell in there and cell != here else " "
                upper.append(_centred(neck, across), style)
            text.append_text(_stacked(upper, lower, down))
        text.append(f"{margin}{below}", self.get_component_rich_style("table--free"))
        return text


def _stacked(upper: Text, lower: Text, down: int) -> Text:
    """A row of cells ``down`` lines high, the drawing at the bottom."""
    lines = Text()
    for line in range(down):
        if line == down - 1:
            lines.append_text(lower)
        elif line == down - 2:
            lines.append_text(upper)
        lines.append("\n")
    return lines


class _Labels:
    """A line with texts centred on given columns, kept within the line."""

    def __init__(self, width: int) -> None:
        self._characters = [" "] * width

    def add(self, middle: int, label: str, before: str = "", after: str = "") -> None:
        """Add ``label``; one off the line goes to its end, with ``before`` or ``after`` to it."""
        room = len(self._characters)
        if middle < 0:
            label = f"{before}{label}" if before else ""
        elif middle >= room:
            label = f"{label}{after}" if after else ""
        begin = max(0, min(middle - len(label) // 2, room - len(label)))
        for i, character in enumerate(label[:room]):
            self._characters[begin + i] = character

    def __str__(self) -> str:
        return "".join(self._characters).rstrip()


def _centred(glyph: str, across: int) -> str:
    return " " * (across // 2) + glyph + " " * (across - across // 2 - 1)


def _cell(world: World, state: int) -> tuple[int, int]:
    column, row = world.positions[state]
    return int(column), int(row)


def _extent(world: World) -> tuple[int, int]:
    """Number of columns and rows."""
    column, row = world.positions.max(axis=0)
    return int(column) + 1, int(row) + 1


def _window(centre: int, count: int, room: int) -> tuple[int, int]:
    """The first of ``count`` cells to show, and how many, when there is room for ``room``."""
    shown = max(1, min(count, room))
    return max(0, min(centre - shown // 2, count - shown)), shown
