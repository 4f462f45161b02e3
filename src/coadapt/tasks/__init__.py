"""Tasks: written in TOML, shipped with the package or the user's own."""

from coadapt.tasks.registry import BuiltTask, load_task, task_names, task_problem
from coadapt.tasks.requirements import TaskError
from coadapt.tasks.task import Task
from coadapt.tasks.toml import parse_task, read_task

__all__ = [
    "BuiltTask",
    "Task",
    "TaskError",
    "load_task",
    "parse_task",
    "read_task",
    "task_names",
    "task_problem",
]
