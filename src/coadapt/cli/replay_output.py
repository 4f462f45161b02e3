"""What ``coadapt replay`` prints: tables for people, or one JSON object for programs."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Protocol

import msgspec
from rich.console import Console
from rich.table import Table
from rich.text import Text

from coadapt import __version__
from coadapt.errors import printable
from coadapt.robots import Decision, Robot
from coadapt.robots.task_setup import AnySetup, differences
from coadapt.simulation.log import DecisionCells, Value
from coadapt.simulation.replay import Comparison, ReplayedTrial

MOST_RICH_ROWS = 1000
"""A trial with more steps is printed plainly, line by line."""


@dataclass(frozen=True)
class Outcome:
    """How a replay ended.

    Attributes:
        comparison: recorded and replayed decisions side by side.
        setup: the robot of the replay.
        recorded: the robot of the log, or None if the log does not say.
        version: the version of coadapt that wrote the log, or None.
        saved: where the decisions were saved.
    """

    comparison: Comparison
    setup: AnySetup
    recorded: AnySetup | None
    version: str | None
    saved: Path

    @property
    def changes(self) -> tuple[str, ...]:
        """Names of the values in which the two setups differ."""
        if self.recorded is None:
            return ()
        return tuple(differences(self.recorded, self.setup))

    @property
    def fails(self) -> bool:
        """Whether the recorded robot decides otherwise than recorded."""
        return self.recorded == self.setup and self.comparison.different > 0


class Output(Protocol):
    """Where the trials of a replay go, in order."""

    def begin(self, log: Path, setup: AnySetup) -> None:
        """Before the first trial."""
        ...

    def trial(self, trial: ReplayedTrial) -> None:
        """One trial."""
        ...

    def end(self, outcome: Outcome) -> None:
        """After the last trial."""
        ...


def open_output(stream: IO[str], as_json: bool, robot: Robot) -> Output:
    """The output that was asked for, into ``stream``, which ends up on standard output."""
    return JSONOutput(stream, robot) if as_json else TextOutput(stream, robot)


@dataclass(frozen=True)
class Column:
    """A column of the tables.

    Attributes:
        heading: its title.
        width: characters of its widest cell, the heading included.
        cell: the text for a step's number and decision.
        keep: 0 where it goes first if room is short, then 1; 2 where it stays.
    """

    heading: str
    width: int
    cell: Callable[[int, Decision], str]
    keep: int = 2


class JSONOutput:
    """One JSON object, written trial by trial."""

    def __init__(self, stream: IO[str], robot: Robot) -> None:
        self._stream = stream
        self._robot = robot
        self._cells = DecisionCells(robot)
        self._separator = ""

    def begin(self, log: Path, setup: AnySetup) -> None:
        """The setup."""
        head = _json({"log": printable(str(log)), "setup": setup})
        self._stream.write(f'{head[:-1]},"trials":[')

    def trial(self, trial: ReplayedTrial) -> None:
        """A trial with its steps."""
        episode, world = trial.episode, self._robot.model.world
        steps = [
            {
                "time": row.time,
                "input": row.human_input,
                **self._cells.values(decision),
                "mode_belief": dict(_modes(self._robot, decision)),
                "mean_adaptability": _mean_alpha(self._robot, decision),
            }
            for row, decision in zip(trial.rows, episode.decisions, strict=True)
        ]
        record = {
            "trial": trial.number,
            "goal": None if episode.goal is None else world.goals[episode.goal].name,
            "reward": episode.reward,
            "final_state": world.state_names[episode.final_state],
            "unused_inputs": trial.unused,
            "steps": steps,
        }
        self._stream.write(f"{self._separator}{_json(record)}")
        self._separator = ","

    def end(self, outcome: Outcome) -> None:
        """The comparison and the file saved."""
        compared = outcome.comparison
        comparison = {
            "same_setup": outcome.recorded == outcome.setup,
            "changed": outcome.changes,
            "steps": compared.steps,
            "different": compared.different,
            "first": compared.first,
        }
        tail = {
            "comparison": comparison if compared.steps else None,
            "saved": printable(str(outcome.saved)),
        }
        self._stream.write(f"],{_json(tail)[1:]}\n")


class TextOutput:
    """A table for each trial; with rules and colours where the terminal is wide enough."""

    def __init__(self, stream: IO[str], robot: Robot) -> None:
        self._stream = stream
        self._robot = robot
        terminal = Console(file=sys.stdout)
        self._console = Console(
            file=stream,
            width=terminal.width,
            force_terminal=terminal.is_terminal,
            no_color=terminal.no_color,
        )
        room = terminal.width if terminal.is_terminal else None
        self._columns, self._gap = _fitting(robot, room)
        self._is_rich = room is not None and _width(self._columns, self._gap) <= room
        self._steps = 0
        self._trials = 0

    def begin(self, log: Path, setup: AnySetup) -> None:
        """The heading."""
        self._line(f"{printable(str(log))} through {setup.robot}")

    def trial(self, trial: ReplayedTrial) -> None:
        """The table of a trial."""
        self._trials += 1
        self._steps += trial.episode.steps
        self._line("")
        self._line(_headline(self._robot, trial))
        if self._is_rich and trial.episode.steps <= MOST_RICH_ROWS:
            self._print_table(trial)
            return
        self._print_row([column.heading for column in self._columns])
        for step, decision in enumerate(trial.episode.decisions, start=1):
            self._print_row([column.cell(step, decision) for column in self._columns])

    def end(self, outcome: Outcome) -> None:
        """What came of it."""
        self._line("")
        steps, trials = _count(self._steps, "step"), _count(self._trials, "trial")
        self._line(f"{steps} in {trials}.")
        for line in _verdict(outcome):
            self._line(line)
        self._line(f"Saved to {printable(str(outcome.saved))}")

    def _print_row(self, cells: Sequence[str]) -> None:
        pairs = zip(cells, self._columns, strict=True)
        padded = (cell.ljust(column.width) for cell, column in pairs)
        self._line((" " * self._gap).join(padded).rstrip())

    def _print_table(self, trial: ReplayedTrial) -> None:
        table = Table(box=None, header_style="bold", pad_edge=False, padding=(0, self._gap, 0, 0))
        for column in self._columns:
            table.add_column(Text(column.heading), min_width=column.width, no_wrap=True)
        for step, decision in enumerate(trial.episode.decisions, start=1):
            style = "bold" if decision.human_input not in (None, decision.action) else ""
            style = "green" if decision.matched else style
            cells = (column.cell(step, decision) for column in self._columns)
            table.add_row(*(Text(cell, style) for cell in cells))
        self._console.print(table)

    def _line(self, text: str) -> None:
        self._stream.write(f"{text}\n")


def _fitting(robot: Robot, room: int | None) -> tuple[list[Column], int]:
    """The columns that fit into ``room`` characters, and the blanks between two of them."""
    columns = _all_columns(robot)
    for keep, gap in ((0, 2), (1, 2)):
        kept = [column for column in columns if column.keep >= keep]
        if room is None or _width(kept, gap) <= room:
            return kept, gap
    return [column for column in columns if column.keep > 1], 1


def _width(columns: Sequence[Column], gap: int) -> int:
    return sum(column.width + gap for column in columns)


def _all_columns(robot: Robot) -> list[Column]:
    world, model = robot.model.world, robot.planning_model
    names, inputs = world.action_names, robot.model.interface.names
    widest = max(len(name) for name in (*names, *inputs, "planned"))
    columns = [
        Column("step", 4, lambda step, _: str(step)),
        Column(
            "state",
            max(len(name) for name in world.state_names),
            lambda _, d: world.state_names[d.state],
        ),
        Column(
            "input", widest, lambda _, d: "-" if d.human_input is None else inputs[d.human_input]
        ),
        Column("action", widest, lambda _, d: names[d.action]),
        Column("planned", widest, lambda _, d: names[d.planned]),
        Column("match", 5, lambda _, d: "yes" if d.matched else "no"),
        Column("agree", 5, lambda _, d: f"{d.agreement:.3f}", keep=1),
    ]
    for m, mode in enumerate(model.mode_names):
        heading = f"P({mode})"
        columns.append(Column(heading, max(5, len(heading)), _chance_of_mode(m)))
    columns.append(Column("mean alpha", 10, lambda _, d: f"{_mean_alpha(robot, d):.3f}"))
    for a, alpha in enumerate(model.alpha.names):
        heading = f"a={alpha.removeprefix('alpha=')}"
        columns.append(Column(heading, max(5, len(heading)), _chance_of_alpha(a), keep=0))
    return columns


def _chance_of_mode(m: int) -> Callable[[int, Decision], str]:
    return lambda _, d: f"{d.mode_belief[m]:.3f}"


def _chance_of_alpha(a: int) -> Callable[[int, Decision], str]:
    return lambda _, d: f"{d.adaptability_belief[a]:.3f}"


def _headline(robot: Robot, trial: ReplayedTrial) -> str:
    episode, world = trial.episode, robot.model.world
    steps = _count(episode.steps, "step")
    if episode.goal is None:
        where = world.state_names[episode.final_state]
        return f"Trial {trial.number}: no goal after {steps}; the inputs end at {where}"
    goal = world.goals[episode.goal]
    headline = f"Trial {trial.number}: {goal.name} goal (reward {goal.reward:g}) after {steps}"
    if trial.unused:
        headline += f"; {_count(trial.unused, 'input')} after it left out"
    return headline


def _verdict(outcome: Outcome) -> Iterator[str]:
    compared, first = outcome.comparison, outcome.comparison.first
    if outcome.changes:
        yield f"Recorded with another setup; changed: {', '.join(outcome.changes)}."
    if compared.steps == 0:
        return
    if first is None:
        yield f"Identical to the recorded decisions, all {compared.steps} to the bit."
        return
    yield (
        f"Different from the recorded decisions in {compared.different} of {compared.steps} steps; "
        f"first in trial {first.trial}, step {first.step} (line {first.line}): {first.column} "
        f"was {_shown(first.recorded)}, is now {_shown(first.replayed)}."
    )
    if outcome.fails and outcome.version != __version__:
        wrote = printable(outcome.version or "an unknown version")
        yield f"The log was written by coadapt {wrote}; this is {__version__}."


def _modes(robot: Robot, decision: Decision) -> Iterator[tuple[str, float]]:
    belief = decision.mode_belief
    for name, chance in zip(robot.planning_model.mode_names, belief, strict=True):
        yield name, float(chance)


def _mean_alpha(robot: Robot, decision: Decision) -> float:
    return float((robot.planning_model.alpha.levels * decision.adaptability_belief).sum())


def _count(n: int, noun: str) -> str:
    return f"{n:,} {noun}" if n == 1 else f"{n:,} {noun}s"


def _shown(value: Value) -> str:
    return printable(value) if isinstance(value, str) else repr(value)


def _json(value: object) -> str:
    return msgspec.json.encode(value).decode()
