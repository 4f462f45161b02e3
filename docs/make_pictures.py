"""Writes the picture of every task's page: docs/images/tasks/NAME.png.

Each shows the task's map with what the robot does there with simulated people, the first figure of
``coadapt reproduce --task NAME``. Run it after a change of a task or of the robots.
"""

from __future__ import annotations

import io
from pathlib import Path

from PIL import Image

from coadapt.report.figures import style
from coadapt.report.task.behaviour import behaviour
from coadapt.report.task.results import TaskSettings, task_results
from coadapt.tasks import load_task, task_names

DIRECTORY = Path(__file__).parent / "images" / "tasks"

DOTS = 120
"""Per inch."""

COLORS = 32


def main() -> None:
    """Draw all of them."""
    DIRECTORY.mkdir(parents=True, exist_ok=True)
    for name in task_names():
        task = load_task(name)
        found = task_results(name, task.title, task.about, task.build(), TaskSettings(runs=500))
        buffer = io.BytesIO()
        with style.settings():
            behaviour(found).savefig(buffer, format="png", dpi=DOTS)
        picture = Image.open(buffer).convert("RGB").quantize(COLORS)
        picture.save(DIRECTORY / f"{name}.png", optimize=True)
        print(name)


if __name__ == "__main__":
    main()
