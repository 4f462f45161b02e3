"""Replay: recorded inputs through a robot, and whether it decides as recorded."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby

from coadapt.errors import FileError
from coadapt.robots import Robot
from coadapt.simulation.episode import Episode, Trial
from coadapt.simulation.log import DecisionCells, LogRow, Value


class InputAfterGoal(FileError):
    """A log has an input in a trial that is over."""


@dataclass(frozen=True)
class ReplayedTrial:
    """One trial of a log, run through a robot.

    Attributes:
        number: the trial's number in the log, from 1.
        rows: the rows of which the inputs were used, one for each decision.
        episode: what the robot did with them; without a goal if the inputs ended before.
        unused: number of inputs recorded after the robot had reached a goal.
    """

    number: int
    rows: tuple[LogRow, ...]
    episode: Episode
    unused: int


@dataclass(frozen=True)
class Difference:
    """A decision that is not as recorded.

    Attributes:
        trial: number of the trial, from 1.
        step: number of the step within the trial, from 1.
        line: line of the log.
        column: the first column that differs.
        recorded: what the log says.
        replayed: what the robot decided now.
    """

    trial: int
    step: int
    line: int
    column: str
    recorded: Value
    replayed: Value


def replay(
    robot: Robot,
    rows: Iterable[LogRow],
    path: str | os.PathLike[str],
    *,
    skip_rest: bool = False,
) -> Iterator[ReplayedTrial]:
    """Run the inputs of a log through a robot, whose belief starts anew in every trial.

    Args:
        robot: decides.
        rows: the log, for example `LogReader.rows`.
        path: the log's file, for messages.
        skip_rest: leave out inputs that come after the robot reached a goal. Another robot than
            the recorded one may be there sooner.

    Yields:
        The trials in order, each when its last row is read.

    Raises:
        InputAfterGoal: at an input after the goal, unless ``skip_rest``.
    """
    world = robot.model.world
    index = {name: i for i, name in enumerate(robot.model.interface.names)}
    for number, group in groupby(rows, key=lambda row: row.trial):
        trial = Trial(robot)
        used: list[LogRow] = []
        unused = 0
        for row in group:
            if not trial.done:
                trial.step(None if row.human_input is None else index[row.human_input])
                used.append(row)
            elif skip_rest:
                unused += 1
            else:
                goal = world.goal_at(trial.state)
                name = "" if goal is None else f" {world.goals[goal].name}"
                raise InputAfterGoal(
                    path,
                    row.line,
                    f"found an input after the robot reached the goal{name} in trial {number}, "
                    f"expected trial {number + 1}",
                )
        yield ReplayedTrial(number, tuple(used), trial.episode(), unused)


class Comparison:
    """Recorded and replayed decisions side by side, trial by trial.

    Args:
        robot: the robot of the replay.

    Attributes:
        steps: number of decisions compared: those of which the log recorded something.
        different: number of them that are not the same in all that was recorded.
        first: the first difference, or None.
    """

    def __init__(self, robot: Robot) -> None:
        self._cells = DecisionCells(robot)
        self.steps = 0
        self.different = 0
        self.first: Difference | None = None

    def add(self, trial: ReplayedTrial) -> None:
        """Compare one more trial. Numbers are the same if they are so to the bit."""
        pairs = zip(trial.rows, trial.episode.decisions, strict=True)
        for step, (row, decision) in enumerate(pairs, start=1):
            if not row.recorded:
                continue
            replayed = self._cells.values(decision)
            # Columns of a belief that this robot does not hold say nothing about it.
            recorded = {c: v for c, v in row.recorded.items() if c in replayed}
            column = next((c for c, v in recorded.items() if repr(v) != repr(replayed[c])), None)
            self.steps += bool(recorded)
            if column is None:
                continue
            self.different += 1
            if self.first is None:
                self.first = Difference(
                    trial.number, step, row.line, column, recorded[column], replayed[column]
                )
