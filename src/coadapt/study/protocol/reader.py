"""Reading a protocol from its file, and the file that a new study starts from."""

from __future__ import annotations

import os
from importlib.resources import files
from pathlib import Path

from coadapt.errors import FileError, InputError
from coadapt.requirements import require
from coadapt.study.protocol.study import Study
from coadapt.tasks import BuiltTask, Task, load_task
from coadapt.toml import read_toml

FILE = "study.toml"
"""The file of a study's directory that holds its protocol."""


def read_study(directory: str | os.PathLike[str]) -> Study:
    """The protocol of the study in ``directory``, found usable.

    Raises:
        FileError: if it cannot be read or used; names the line where there is one.
    """
    path = Path(directory) / FILE
    study, places = read_toml(path, Study, "the protocol of a study")
    with places.named():
        try:
            goals = len(study_task(study, directory).goals)
        except InputError as error:
            raise FileError(path, places.line(("task",)), f"task: {error}") from error
        require(("task",), goals == 2, "a task with two goals", f"one with {goals}")
    return study


def study_task(study: Study, directory: str | os.PathLike[str]) -> Task:
    """The task of ``study``, found beside its file in ``directory`` or among the shipped ones.

    Raises:
        InputError: if there is none, or none in which the robot alone moves.
    """
    beside = Path(directory) / study.task
    task = load_task(str(beside) if Path(study.task).suffix else study.task)
    if isinstance(task, BuiltTask):
        raise InputError(f"{study.task} is no task for a study: the person moves the world too")
    return task


def template() -> bytes:
    """The protocol that a new study starts from: that of Sec. 6."""
    return files(__package__ or "").joinpath("template.toml").read_bytes()
