"""The setting that a map marks: that of the task before the sweep changes anything."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from coadapt.robots.setup import RobotSetup
from coadapt.simulation.sweep import Sweep
from coadapt.simulation.sweep.cell import rewards_of
from coadapt.simulation.sweep.cells import base_setup


@dataclass(frozen=True)
class Mark:
    """A setting to be marked.

    Attributes:
        cost: C.
        gap: ``R_opt - R_sub``.
        label: whose setting it is.
    """

    cost: float
    gap: float
    label: str


def mark_of(sweep: Sweep, directory: Path | None) -> Mark | None:
    """The setting of the task of the first grid that has a figure; None if no grid has one.

    Raises:
        FieldError, FileError: if there is no such task.
    """
    grid = next((grid for grid in sweep.grid if grid.figure is not None), None)
    if grid is None:
        return None
    setup = base_setup(grid.task[0] if isinstance(grid.task, tuple) else grid.task, directory)
    rewards = sorted(rewards_of(setup).values())
    is_paper = isinstance(setup, RobotSetup)
    cost = setup.disagreement_cost if is_paper else setup.task.model.disagreement_cost
    return Mark(cost, rewards[-1] - rewards[0], "the paper" if is_paper else setup.task.name)
