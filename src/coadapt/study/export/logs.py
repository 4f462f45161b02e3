"""The trials of an export as logs, which `coadapt fit` and `coadapt replay` read."""

from __future__ import annotations

import re
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

from coadapt.robots.task_setup import TaskSetup
from coadapt.simulation.log import DECISION_COLUMNS
from coadapt.simulation.log_writer import LogWriter
from coadapt.study.export.names import Names
from coadapt.study.export.tables import StepRow
from coadapt.study.protocol import Study
from coadapt.study.robots import setup_of
from coadapt.tasks import Task

PARTICIPANT = "participant"
"""Name of the column that says who steered."""


class Logs:
    """A log for each condition and chosen goal, for each has a robot of its own.

    A context; logs without a trial are not there once it is left.

    Args:
        folder: where they are written.
        study, task, names: of the study.
    """

    def __init__(self, folder: Path, study: Study, task: Task, names: Names) -> None:
        self._folder, self._names = folder, names
        self._setups: dict[tuple[str, str], TaskSetup] = {
            (condition.name, goal): setup_of(study, task, condition, choice)
            for condition in study.conditions
            for choice, goal in enumerate(names.goals)
        }
        self._writers: dict[tuple[str, str], LogWriter] = {}
        self._trials: dict[tuple[str, str], int] = {}
        self._stack = ExitStack()

    def write(self, condition: str, choice: str, steps: list[StepRow]) -> None:
        """Add a trial: its steps, of which there is at least one."""
        robot = condition, choice
        if robot not in self._writers:
            self._writers[robot] = self._open(*robot)
        self._trials[robot] = number = self._trials.get(robot, 0) + 1
        states = self._names.model.world.state_names
        for step in steps:
            values = {
                PARTICIPANT: step.participant,
                "state": states[step.state],
                "action": step.action or "",
                "planned": step.planned or "",
                "matched": bool(step.matched),
                "agreement": step.agreement or 0.0,
            }
            self._writers[robot].write(step.time, step.input, number, values)

    def _open(self, condition: str, choice: str) -> LogWriter:
        self._folder.mkdir(exist_ok=True)
        name = f"{condition}-{re.sub(r'[^0-9A-Za-z]+', '_', choice)}.csv"
        file = (self._folder / name).open("w", encoding="utf-8", newline="")
        stream = self._stack.enter_context(file)
        setup = self._setups[condition, choice]
        return LogWriter(stream, setup, (PARTICIPANT, *DECISION_COLUMNS))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stack.close()
