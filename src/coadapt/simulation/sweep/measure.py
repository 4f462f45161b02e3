"""What is found out about one cell: the numbers in its rows of the table.

Measures of simulated episodes are means over the people, one row for each trial; those that are
exact are of the first trial.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.robots import Robot
from coadapt.simulation.batch import simulate_batch
from coadapt.simulation.conduct import insisting_steps
from coadapt.simulation.evaluation import evaluate
from coadapt.simulation.partners import AnyPartner, SimulatedPartner
from coadapt.simulation.sweep.cell import Cell
from coadapt.simulation.sweep.people import partner_of
from coadapt.worlds.world import NO_GOAL

Row = dict[str, float | None]
"""Values of one row by the names in `MEASURES`; those that do not apply are left out."""


@dataclass(frozen=True)
class Measure:
    """A column of the table.

    Attributes:
        name: of the column.
        meaning: in a few words.
        has_error: whether a column with its standard error stands beside it, ``NAME_se``.
    """

    name: str
    meaning: str
    has_error: bool = False

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of its columns."""
        return (self.name, f"{self.name}_se") if self.has_error else (self.name,)


MEASURES = (
    Measure("reward", "reward of the goal reached, 0 without a goal; mean of the episodes", True),
    Measure("optimal", "share of episodes that end at the best goal", True),
    Measure("no_goal", "share of episodes that end at no goal"),
    Measure("switched", "share of episodes in which the person changes their goal", True),
    Measure("steps", "robot actions", True),
    Measure("disagreement", "steps in which the person sees the robot in another mode", True),
    Measure("overridden", "steps in which the robot does not do what was asked", True),
    Measure("exact_reward", "expected reward of the goal reached"),
    Measure("exact_reward_error", "how far that may lie from the truth"),
    Measure("exact_return", "expected discounted sum of rewards and penalties"),
    Measure("exact_optimal", "probability of ending at the best goal"),
    Measure("exact_steps", "expected robot actions"),
    Measure("exact_disagreement", "expected steps in which the robot is seen in another mode"),
    Measure("exact_overridden", "expected steps in which it does not do what was asked"),
    Measure("exact_insisting", "expected steps in which it insists; for people with alpha 0"),
    Measure("exact_unresolved", "probability of the episodes not followed to their end"),
)
"""Every measure in the order of the columns."""


def measure(cell: Cell, robot: Robot) -> list[Row]:
    """The rows of a cell, one for each trial.

    Args:
        cell: the cell.
        robot: built from its setup.

    Raises:
        ValueError: if the cell's partner does not go with its task.
    """
    partner = partner_of(cell.partner, robot.model)
    rows: list[Row] = [{} for _ in range(cell.trials)]
    if cell.episodes:
        rows = _simulated(cell, robot, partner)
    if cell.exact:
        rows[0] |= _exact(cell, robot, partner)
    return rows


def _simulated(cell: Cell, robot: Robot, partner: AnyPartner) -> list[Row]:
    batch = simulate_batch(
        robot,
        partner,
        cell.episodes,
        cell.rng(),
        trials=cell.trials,
        carry_belief=cell.carry_belief,
        max_steps=cell.max_steps,
    )
    best = robot.model.world.optimal_goal
    values = {
        "reward": batch.reward,
        "optimal": batch.goal == best,
        "no_goal": batch.goal == NO_GOAL,
        "steps": batch.steps,
        "disagreement": batch.disagreement,
        "overridden": batch.overridden,
        "switched": batch.switched,
    }
    names = {column for measure in MEASURES for column in measure.columns}
    rows: list[Row] = []
    for trial in range(cell.trials):
        row = _means({name: found[:, trial].astype(np.float64) for name, found in values.items()})
        rows.append({name: value for name, value in row.items() if name in names})
    return rows


def _means(values: Mapping[str, FloatArray]) -> Row:
    """Means and standard errors of values ``[n]``."""
    row: Row = {}
    for name, found in values.items():
        row[name] = float(found.mean())
        if len(found) > 1:
            row[f"{name}_se"] = float(found.std(ddof=1) / np.sqrt(len(found)))
    return row


def _exact(cell: Cell, robot: Robot, partner: AnyPartner) -> Row:
    if not isinstance(partner, SimulatedPartner):
        return {}
    found = evaluate(robot, partner, tolerance=cell.tolerance, max_steps=cell.max_steps)
    row: Row = {
        "exact_reward": found.reward,
        "exact_reward_error": found.reward_error,
        "exact_return": found.discounted_return,
        "exact_optimal": float(found.goal_probability[robot.model.world.optimal_goal]),
        "exact_steps": found.steps,
        "exact_disagreement": found.disagreement,
        "exact_overridden": found.overridden,
        "exact_unresolved": found.unresolved,
    }
    if not np.any(partner.adaptability):
        row["exact_insisting"] = insisting_steps(robot, partner)
    return row
