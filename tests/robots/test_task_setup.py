"""Setups of robots for tasks, compared."""

from __future__ import annotations

import msgspec

from coadapt.robots.task_setup import TaskSetup, _differences, differences
from coadapt.tasks import Task, load_task


def test_setups_differ_in_the_values_that_differ() -> None:
    task = load_task("table_clearing_small")
    assert isinstance(task, Task)
    one = TaskSetup(task=task)
    first = msgspec.structs.replace(task.goals[0], reward=3.0)
    other = msgspec.structs.replace(task, goals=(first, *task.goals[1:]))
    assert list(differences(one, TaskSetup(task=other, gap=0.5))) == [
        "gap",
        "task.goals[0].reward",
    ]
    assert list(differences(one, one)) == []


def test_rows_of_other_lengths_differ_as_a_whole() -> None:
    task = load_task("grasp_selection")
    assert isinstance(task, Task)
    assert len(task.goals) > 1
    one = {"goals": msgspec.to_builtins(task.goals), "name": "one"}
    assert list(_differences(one, {**one, "goals": one["goals"][1:]}, "")) == ["goals"]
