"""What a command takes for PROBLEM or TASK: a file, or one of the tasks that are built in."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from coadapt.errors import InputError

if TYPE_CHECKING:
    from coadapt.momdp import MOMDP
    from coadapt.robots.task_setup import TaskSetup


def load_problem(problem: str) -> MOMDP:
    """The planning problem of the task or the file that ``problem`` names.

    A name with a suffix or a directory is a file: a task if it ends in ``.toml``.

    Raises:
        InputError: if there is no such task, or the file cannot be used.
    """
    path = Path(problem)
    if path.suffix == ".toml" or (not path.suffix and problem == path.name):
        from coadapt.tasks import load_task, task_problem

        return task_problem(load_task(problem))
    from coadapt.momdp.files import read_pomdp

    return read_pomdp(path)


def task_setup(name: str) -> TaskSetup:
    """The setup of a robot for the task that ``name`` names, see `load_problem`.

    Raises:
        InputError: if there is no such task, the file cannot be used, or the task is one for which
            there is no such robot.
    """
    from coadapt.robots.task_setup import TaskSetup
    from coadapt.tasks import Task, load_task

    task = load_task(name)
    if not isinstance(task, Task):
        raise InputError(
            f"{name}: found a task in which the person moves the world too, expected one that a "
            "robot carries out"
        )
    return TaskSetup(task=task)
