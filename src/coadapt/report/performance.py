"""How well a robot does with partners of different adaptability (Sec. 5.4): exact and simulated.

Performance is the reward of the goal reached. The exact numbers come from expanding the beliefs a
robot can reach, the simulated ones from drawing episodes; neither knows of the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from coadapt.robots import Robot
from coadapt.simulation import (
    Evaluation,
    SimulatedPartner,
    Summary,
    evaluate_all,
    simulate_batch,
    summarize,
)

ALPHAS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Adaptability of the simulated users (Sec. 5.4 and 6.5)."""

FINE_ALPHAS = tuple(i / 10 for i in range(11))
"""Adaptability at which the curves between those points are evaluated."""

CURVE_TOLERANCE = 1e-2
"""Probability of episodes that the evaluation of a curve may leave unfinished."""


@dataclass(frozen=True)
class Curve:
    """The exact performance between the points, for drawing.

    Attributes:
        alpha: adaptability of the partners.
        reward: expected reward with each, to within ``error``.
        error: largest distance of a value from the true one.
    """

    alpha: tuple[float, ...]
    reward: tuple[float, ...]
    error: float


@dataclass(frozen=True)
class RobotResult:
    """One robot with partners of every adaptability, all starting in the same mode.

    Attributes:
        key: short identifier.
        label: what the report calls it.
        condition: the condition of Sec. 6.1 it belongs to.
        match_rule: whether it follows the match rule of Sec. 5.3; None where that makes no sense.
        alpha: adaptability of the partners.
        exact: one `Evaluation` for each partner.
        simulated: one `Summary` for each partner, or none where episodes were not drawn.
        optimal_goal: index of the optimal goal in ``exact[i].goal_probability``.
        curve: exact performance on a finer grid, or None.
    """

    key: str
    label: str
    condition: str
    match_rule: bool | None
    alpha: tuple[float, ...]
    exact: tuple[Evaluation, ...]
    simulated: tuple[Summary, ...]
    optimal_goal: int
    curve: Curve | None = None

    @property
    def optimal(self) -> tuple[float, ...]:
        """Probability of the optimal goal with each partner.

        As in ``reward``, episodes not followed to their end count half.
        """
        return tuple(
            float(e.goal_probability[self.optimal_goal]) + e.unresolved / 2 for e in self.exact
        )


def evaluate_curve(robot: Robot, mode: int, alphas: Sequence[float] = FINE_ALPHAS) -> Curve:
    """The exact performance of ``robot`` with partners who start in ``mode``."""
    partners = [SimulatedPartner(alpha, mode) for alpha in alphas]
    evaluations = evaluate_all(robot, partners, tolerance=CURVE_TOLERANCE)
    return Curve(
        alpha=tuple(alphas),
        reward=tuple(e.reward for e in evaluations),
        error=max(e.reward_error for e in evaluations),
    )


def simulate_partner(
    robot: Robot, partner: SimulatedPartner, runs: int, rng: np.random.Generator
) -> Summary:
    """What ``runs`` episodes of ``robot`` with ``partner`` came to; at least one run."""
    return summarize(simulate_batch(robot, partner, runs, rng), robot.model)


def distances(result: RobotResult, worst: float, best: float) -> tuple[float, ...]:
    """How far each simulated mean lies from the exact one, in standard errors of a true mean.

    The standard error is that of the exact distribution, ``(best - worst) sqrt(p (1 - p) / n)``;
    where it is 0 the distance is 0 if the means agree and infinite otherwise.
    """
    found: list[float] = []
    for exact, p, simulated in zip(result.exact, result.optimal, result.simulated, strict=True):
        error = (best - worst) * sqrt(max(p * (1 - p), 0.0) / simulated.runs)
        apart = abs(simulated.reward.mean - exact.reward)
        if apart <= exact.reward_error + 1e-9:
            found.append(0.0)
        else:
            found.append(apart / error if error > 0 else float("inf"))
    return tuple(found)
