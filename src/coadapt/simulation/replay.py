"""Replay: recorded inputs through a robot, and whether it decides as recorded."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from coadapt.arrays import BoolArray, IntArray
from coadapt.errors import FileError
from coadapt.robots import Decisions, Robot
from coadapt.simulation.episode import Episode, Outcome, Trial
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

    What a task leaves to chance is as the log's states say: where a trial begins, and where an
    action led. Where the log does not say, it is the likeliest; but a last action leads to a goal
    if it can.

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
        course = _Course(robot, list(group))
        trial = Trial(robot, start=course.start)
        used: list[LogRow] = []
        unused = 0
        for i, row in enumerate(course.rows):
            if not trial.done:
                human_input = None if row.human_input is None else index[row.human_input]
                trial.step(human_input, outcome=course.outcome(i))
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


@dataclass(frozen=True)
class _Course:
    """Where a recorded trial went.

    Attributes:
        robot: decides in the replay.
        rows: of one trial.
    """

    robot: Robot
    rows: Sequence[LogRow]

    @property
    def start(self) -> int:
        """The first state."""
        starts = self.robot.model.world.start_chances
        recorded = self._state(0)
        if recorded is not None and recorded in starts:
            return recorded
        return max(starts, key=lambda x: starts[x])

    def outcome(self, i: int) -> Outcome | None:
        """What the action of row ``i`` led to; None where moves are certain."""
        world = self.robot.model.world
        if world.is_deterministic:
            return None
        following = self._state(i + 1)

        def found(decisions: Decisions) -> IntArray:
            x, action = int(decisions.state[0]), int(decisions.action[0])
            states, chances = world.outcomes[x, action], world.outcome_chances[x, action]
            wanted: BoolArray = world.ends[states] if following is None else states == following
            rank = chances + (wanted & (chances > 0))  # first those wanted, then the likeliest
            return rank.reshape(1, -1).argmax(axis=1)

        return found

    def _state(self, i: int) -> int | None:
        """The state recorded in row ``i``, if there is one."""
        name = self.rows[i].recorded.get("state") if i < len(self.rows) else None
        names = self.robot.model.world.state_names
        return names.index(name) if isinstance(name, str) and name in names else None


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
