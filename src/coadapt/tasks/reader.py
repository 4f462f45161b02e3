"""Reading a task from a TOML file."""

from __future__ import annotations

import os

from coadapt.tasks.task import Task
from coadapt.toml import Places, parse_toml, read_toml


def read_task(path: str | os.PathLike[str]) -> Task:
    """The task in a TOML file, found usable: its model can be built.

    Raises:
        FileError: if it cannot be read or used; names the line where there is one.
    """
    return _usable(*read_toml(path, Task, "a task"))


def parse_task(raw: bytes, path: str | os.PathLike[str]) -> Task:
    """The task in the TOML text ``raw``; ``path`` is for messages.

    Raises:
        FileError: as `read_task`.
    """
    return _usable(*parse_toml(raw, path, Task, "a task"))


def _usable(task: Task, places: Places) -> Task:
    with places.named():
        _ = task.build()
    return task
