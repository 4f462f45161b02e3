"""The files of a task's report."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from coadapt.report.figures import style
from coadapt.report.task.behaviour import behaviour
from coadapt.report.task.beliefs import beliefs
from coadapt.report.task.outcomes import outcomes
from coadapt.report.task.page import render_page
from coadapt.report.task.results import TaskResults
from coadapt.report.write import NUMBERS, PAGE

FORMAT = 1
"""Version of the JSON object."""


def make_task_files(
    found: TaskResults, progress: Callable[[str], None] | None = None
) -> dict[str, bytes]:
    """Every file of the report by its name, directories before it with a slash.

    Args:
        found: all results.
        progress: told what is being done.
    """
    if progress is not None:
        progress("Drawing the figures")
    with style.settings():
        drawn = {
            "behaviour": behaviour(found),
            "outcomes": outcomes(found),
            "beliefs": beliefs(found),
        }
        figures = {
            f"{name}.{kind}": style.render(figure, kind)
            for name, figure in drawn.items()
            for kind in ("svg", "png")
        }
    files = {f"figures/{name}": content for name, content in figures.items()}
    files[NUMBERS] = task_json(found).encode()
    svgs = {name: figures[f"{name}.svg"].decode() for name in drawn}
    return {PAGE: render_page(found, svgs, sorted(files)).encode(), **files}


def task_json(found: TaskResults) -> str:
    """All numbers as one JSON object, the same for the same settings."""
    world = found.model.world
    observed, hidden, actions, observations = found.model.to_momdp().shape
    numbers: dict[str, Any] = {
        "format": FORMAT,
        "task": found.name,
        "runs": found.settings.runs,
        "seed": found.settings.seed,
        "observed": observed,
        "hidden": hidden,
        "actions": actions,
        "observations": observations,
        "status": found.solution.status.value,
        "lower": found.solution.lower,
        "upper": found.solution.upper,
        "goals": [{"name": goal.name, "reward": goal.reward} for goal in world.goals],
        "first_mode": found.model.mode_names[found.first_mode],
        "robots": [
            {
                "robot": robot.label,
                "alpha": [p.alpha for p in robot.by_alpha],
                "reward": [p.summary.reward.mean for p in robot.by_alpha],
                "standard_error": [p.summary.reward.standard_error for p in robot.by_alpha],
                "goal_share": [p.summary.goals.tolist() for p in robot.by_alpha],
                "steps": [p.summary.steps.mean for p in robot.by_alpha],
                "disagreement": [p.summary.disagreement.mean for p in robot.by_alpha],
                "estimate": [p.estimate for p in robot.by_alpha],
            }
            for robot in found.robots
        ],
    }
    return json.dumps(numbers, indent=2) + "\n"


def task_summary(found: TaskResults) -> str:
    """The main numbers as a table of plain text."""
    rows = [["alpha", *(robot.label.lower() for robot in found.robots)]]
    for i, alpha in enumerate(p.alpha for p in found.planned.by_alpha):
        met = [robot.by_alpha[i].summary.reward for robot in found.robots]
        rows.append([f"{alpha:g}", *(f"{r.mean:.3f} +- {r.standard_error:.3f}" for r in met)])
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    first, solution = found.model.mode_names[found.first_mode], found.solution
    return "\n".join(
        [
            f"Mean reward of the goal reached; users begin in mode {first}.",
            "",
            *(
                "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True))
                for row in rows
            ),
            "",
            f"Bounds of the task's value: {solution.lower:.4f} to {solution.upper:.4f}.",
        ]
    )
