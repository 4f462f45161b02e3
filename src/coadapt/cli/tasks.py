"""``coadapt tasks``: what tasks there are, and what one of them consists of."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import click

from coadapt.errors import printable

if TYPE_CHECKING:
    from coadapt.momdp import MOMDP
    from coadapt.tasks import BuiltTask, Task

COUNTS = ("observable", "hidden", "actions", "observations")
"""Names of the sizes of a planning problem: |X|, |Y|, |A_r|, |Omega|."""


@click.command(name="tasks")
@click.argument("task", required=False)
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")
def command(task: str | None, as_json: bool) -> None:
    """List the tasks, or show one.

    TASK is one of the names in the list, or a .toml file; without it all tasks are listed. Other
    commands take the same names and files. A task's sizes are those of its planning problem:
    observable and hidden states, the robot's actions, and observations.
    """
    from coadapt.tasks import load_task, task_names, task_problem

    if task is not None:
        found = load_task(task)
        problem = task_problem(found)
        click.echo(_json_of(found, problem) if as_json else _shown(found, problem))
        return
    rows: list[dict[str, object]] = []
    for name in task_names():
        found = load_task(name)
        sizes = dict(zip(COUNTS, task_problem(found).shape, strict=True))
        rows.append({"name": name, "title": found.title, **sizes})
    click.echo(json.dumps(rows) if as_json else _table(rows))


def _table(rows: list[dict[str, object]]) -> str:
    columns = ("name", *COUNTS, "title")
    cells = [list(columns), *([f"{row[column]}" for column in columns] for row in rows)]
    widths = [max(len(line[i]) for line in cells) for i in range(len(columns))]
    lines: list[str] = []
    for line in cells:
        numbers = [
            text.rjust(width) if 0 < i < len(columns) - 1 else text.ljust(width)
            for i, (text, width) in enumerate(zip(line, widths, strict=True))
        ]
        lines.append("  ".join(numbers).rstrip())
    return "\n".join(lines)


def _json_of(task: Task | BuiltTask, problem: MOMDP) -> str:
    import msgspec

    from coadapt.tasks import Task

    head = {"name": task.name, "title": task.title}
    sizes = dict(zip(COUNTS, problem.shape, strict=True))
    content = {"task": msgspec.to_builtins(task)} if isinstance(task, Task) else {}
    return json.dumps({**head, **sizes, **content})


def _shown(task: Task | BuiltTask, problem: MOMDP) -> str:
    """A task for people: what it is, its place, goals and parameters."""
    from coadapt.tasks import Task
    from coadapt.tasks.show import built_description, description

    x, y, a, o = problem.shape
    lines = [task.name if not task.title else f"{task.name}: {task.title}"]
    lines += description(task) if isinstance(task, Task) else built_description(task)
    lines += ["", f"{x:,} observable x {y:,} hidden states, {a:,} actions, {o:,} observations"]
    return "\n".join(printable(line) for line in lines)
