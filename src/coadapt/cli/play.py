"""``coadapt play``: steer the robot with the arrow keys, in this terminal."""

from __future__ import annotations

import os
import shlex
import sys
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

import click

from coadapt.cli.options import changed_setup, setup_options
from coadapt.cli.problems import task_setup
from coadapt.errors import FileError, InputError, printable

if TYPE_CHECKING:
    from coadapt.play.session import Session
    from coadapt.robots.setup import Progress


@click.command(name="play")
@click.argument("task", required=False)
@click.option(
    "--log",
    "path",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="A new file for the log.  [coadapt-play-DATE-TIME.csv]",
)
@setup_options
def command(task: str | None, path: Path | None, **given: object) -> int:
    """Steer the robot with the arrow keys, in this terminal.

    TASK is the name of a task, see `coadapt tasks`, or a .toml file; table clearing if left out.

    You see the table, the robot, what it believes of you and why it acts. It waits for your key,
    then takes one step. Every step is saved at once in a log, which `coadapt replay` reproduces
    exactly.
    """
    from coadapt.robots.setup import RobotSetup

    setup = changed_setup(RobotSetup() if task is None else task_setup(task), given)
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise InputError("play needs a terminal: its input and output cannot be redirected")
    log = _new_log(path)

    from coadapt.play.app import PlayApp
    from coadapt.play.session import Session
    from coadapt.simulation.log_writer import LiveLog

    def begin(tell: Progress) -> Session:
        robot = setup.build(tell)
        tell("Beginning the log")
        return Session(robot, LiveLog(log, robot, setup))

    app = PlayApp(begin, setup.robot.replace("_", " "))
    try:
        code = app.run()
    finally:
        if app.session is not None:
            app.session.close()
            _report(app.session, log)
    if app.failure is not None:
        raise app.failure
    return app.return_code or 0 if code is None else code


def _new_log(path: Path | None) -> Path:
    """The path of the log, after a look at whether it can be made."""
    log = path or Path(f"coadapt-play-{datetime.now():%Y%m%d-%H%M%S}.csv")
    if os.path.lexists(log):
        raise FileError(log, None, "found an existing file, expected a new one for the log")
    if not log.parent.is_dir():
        raise FileError(log, None, f"found no directory {log.parent}, expected one for the log")
    if not os.access(log.parent, os.W_OK | os.X_OK):
        raise FileError(log, None, "found a directory that cannot be written, expected another")
    return log


def _report(session: Session, log: Path) -> None:
    steps = session.saved_steps
    if steps == 0:
        click.echo("No step was taken, so there is no log.")
        return
    # A name that begins with a dash would be taken for an option.
    name = f"./{log}" if str(log).startswith("-") else str(log)
    noun = "step" if steps == 1 else "steps"
    click.echo(f"Log of {steps} {noun} saved to {printable(name)}")
    click.echo(f"Replay it with: coadapt replay {printable(shlex.quote(name))}")
