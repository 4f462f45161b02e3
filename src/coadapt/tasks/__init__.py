"""Tasks: written in TOML, shipped with the package or the user's own."""

from coadapt.tasks.reader import parse_task, read_task
from coadapt.tasks.registry import BuiltTask, load_task, task_names, task_problem
from coadapt.tasks.task import Task

__all__ = [
    "BuiltTask",
    "Task",
    "load_task",
    "parse_task",
    "read_task",
    "task_names",
    "task_problem",
]
