"""The tasks that come with the package: those in TOML files beside this one, and built ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path

from coadapt.errors import InputError
from coadapt.formalism import Collaboration
from coadapt.momdp import MOMDP
from coadapt.tasks.reader import parse_task, read_task
from coadapt.tasks.task import Task
from coadapt.worlds import hallway, table_carrying


@dataclass(frozen=True)
class BuiltTask:
    """A task that no TOML file can describe, as those in which the person moves the world too.

    Attributes:
        name: short identifier.
        title: what it is, in a few words.
        about: what it is, in a few sentences.
        build: world and people.
    """

    name: str
    title: str
    about: str
    build: Callable[[], Collaboration]


BUILT: Mapping[str, BuiltTask] = {
    task.name: task
    for task in (
        BuiltTask(
            name="hallway",
            title="Two who meet in a hallway pass on one side",
            about="Human and robot walk towards each other and have to agree on a side (IJRR "
            "2017). The number of observed states, 340, is the published one, the layout ours.",
            build=lambda: Collaboration(hallway(), observed="all"),
        ),
        BuiltTask(
            name="table_carrying",
            title="Two carry a table through a door",
            about="Human and robot turn a table together, and the direction decides who walks "
            "backwards through the door. It turns when both push the same way (HRI 2016). The "
            "number of observed states, 734, is the published one, the layout ours.",
            build=lambda: Collaboration(table_carrying(), observed="closed"),
        ),
    )
}
"""Built tasks by their names."""


@cache
def task_names() -> tuple[str, ...]:
    """The names of all tasks, in order."""
    return tuple(sorted([*_shipped(), *BUILT]))


def load_task(name: str) -> Task | BuiltTask:
    """The task that comes with the package under ``name``, or the one in a TOML file.

    A name with a suffix or a directory is a file.

    Raises:
        InputError: if there is no such task, or the file cannot be used.
    """
    if name in BUILT:
        return BUILT[name]
    if name in _shipped():
        file = files(__package__ or "").joinpath(f"{name}.toml")
        return parse_task(file.read_bytes(), f"{name}.toml")
    path = Path(name)
    if not path.suffix and name == path.name:
        known = ", ".join(task_names())
        raise InputError(f"{name}: found no such task, expected a file or one of: {known}")
    return read_task(path)


def task_problem(task: Task | BuiltTask) -> MOMDP:
    """The planning problem of a task."""
    return task.build().to_momdp()


@cache
def _shipped() -> frozenset[str]:
    """The names of the TOML files."""
    directory = files(__package__ or "")
    return frozenset(
        entry.name.removesuffix(".toml")
        for entry in directory.iterdir()
        if entry.name.endswith(".toml")
    )
