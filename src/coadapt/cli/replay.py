"""``coadapt replay``: a recorded log of human inputs through a robot."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Mapping
from pathlib import Path
from tempfile import SpooledTemporaryFile
from typing import TYPE_CHECKING

import click

from coadapt.cli.options import changed_setup, setup_options
from coadapt.cli.problems import task_setup
from coadapt.cli.progress import progress_line
from coadapt.errors import InputError

if TYPE_CHECKING:
    from coadapt.robots.task_setup import AnySetup

DIFFERS = 1
"""Exit code where the recorded robot decides otherwise than recorded."""

HELD_IN_MEMORY = 1 << 24
"""Bytes of output; more is held in a temporary file. Nothing is printed before all went well."""


@click.command(name="replay")
@click.argument("log", type=click.Path(path_type=Path))
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Where to save the decisions.  [LOG.ROBOT.csv beside the log]",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of tables.")
@click.option(
    "--skip-rest", is_flag=True, help="Leave out inputs that come after the goal in a trial."
)
@click.option(
    "--task",
    metavar="TASK",
    help="Name of a task or a .toml file.  [that of the log, else table clearing]",
)
@setup_options
def command(
    log: Path,
    out: Path | None,
    as_json: bool,
    skip_rest: bool,
    task: str | None,
    **given: object,
) -> int:
    """Run a recorded log of human inputs through a robot.

    LOG is a CSV file with the columns time (seconds) and input (for table clearing left, forward,
    right or nothing), and trial if there are several. The robot's actions and beliefs are printed
    and saved step by step.

    Where LOG holds the setup of a robot, it is the default of the options below. Where it holds
    decisions, they are compared: the exit code is 1 if the same robot decides otherwise.

    If the log or an option cannot be used the exit code is 2 and nothing is written.
    """
    from coadapt.cli.replay_output import Outcome, open_output
    from coadapt.simulation.log import PARTICIPANT
    from coadapt.simulation.log_reader import open_log
    from coadapt.simulation.log_writer import whole_log
    from coadapt.simulation.replay import Comparison, InputAfterGoal, replay

    # Read it all once before the planning: a bad log is refused without a wait.
    with open_log(log) as reader:
        recorded = reader.setup
        setup = _setup(recorded, task, given)
        target = log.with_name(f"{log.stem}.{setup.robot}.csv") if out is None else out
        _require_other(log, target)
        for _ in reader.rows(setup.model().interface.names):
            pass
    # Another robot may be at the goal sooner than the recorded one; that is no fault of the log.
    skip_rest = skip_rest or recorded not in (None, setup)
    with (
        open_log(log) as reader,
        SpooledTemporaryFile(HELD_IN_MEMORY, "w+", encoding="utf-8", newline="") as held,
    ):
        with progress_line() as tell:
            robot = setup.build(tell)
            tell("Replaying")
            comparison = Comparison(robot)
            output = open_output(held, as_json, robot)
            output.begin(log, setup)
            rows = reader.rows(robot.model.interface.names)
            several = PARTICIPANT in reader.columns
            with whole_log(target, robot, setup, participants=several) as saved:
                try:
                    for trial in replay(robot, rows, log, skip_rest=skip_rest):
                        for row, decision in zip(trial.rows, trial.episode.decisions, strict=True):
                            saved.write(row.time, trial.number, decision, row.participant)
                        comparison.add(trial)
                        output.trial(trial)
                        tell(f"Replaying: {trial.number:,} trials")
                except InputAfterGoal as error:
                    raise InputError(f"{error} (--skip-rest leaves such inputs out)") from error
        outcome = Outcome(comparison, setup, recorded, reader.version, target)
        output.end(outcome)
        held.seek(0)
        shutil.copyfileobj(held, sys.stdout)
    return DIFFERS if outcome.fails else 0


def _setup(recorded: AnySetup | None, task: str | None, given: Mapping[str, object]) -> AnySetup:
    from coadapt.robots.setup import RobotSetup

    base = recorded or RobotSetup()
    return changed_setup(base if task is None else task_setup(task), given)


def _require_other(log: Path, target: Path) -> None:
    if target.exists() and target.samefile(log):
        raise InputError(f"{target}: found the log itself, expected another file for --out")
