"""People who did the study's trials in one condition, many for every alpha: what experiments draw.

An experiment is a draw: an alpha for each participant from the population, then what one of the
people with that alpha did. So one simulation serves any population of alpha and any number of
participants. How else people differ (`coadapt.analysis.experiment.people`) is drawn in the pool.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coadapt.analysis.adaptability.beta import alpha_grid
from coadapt.analysis.experiment.people import People
from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.robots import Robot
from coadapt.simulation import simulate_batch

POOL_POINTS = 21
"""Values of alpha, closer at the ends."""

POOL_PEOPLE = 1000
"""For each value of alpha."""

ALIKE = 5
"""So many people with the same alpha share the rates drawn for them, where rates vary: to begin
with another person takes as long as the trials of some twenty."""


@dataclass(frozen=True)
class Protocol:
    """What participants do.

    Attributes:
        trials: how many each does.
        carry_belief: whether the robot keeps its belief of a person from trial to trial.
        keep_mode: whether a person keeps their mode from trial to trial.
        first_mode: index of the goal they want at first, or None for a draw from the model's prior.
    """

    trials: int = 3
    carry_belief: bool = True
    keep_mode: bool = True
    first_mode: int | None = None


@dataclass(frozen=True, eq=False)
class Pool:
    """What people did in one condition.

    Attributes:
        performance: ``[J, K]`` the mean reward over the trials of ``K`` people with each alpha.
        optimal: ``[J, K, T]`` which of the trials ended at the optimal goal.
    """

    performance: FloatArray
    optimal: BoolArray

    @property
    def points(self) -> int:
        """``J``, the values of alpha on `alpha_grid`."""
        return len(self.performance)

    def patterns(self) -> FloatArray:
        """``[J, 2 ** T]`` probability of each course of trials; bit ``t`` is trial ``t``."""
        trials = self.optimal.shape[2]
        code = np.zeros(self.performance.shape, dtype=np.int64)
        for t in range(trials):
            code += self.optimal[:, :, t].astype(np.int64) << t
        counts = [np.bincount(code[j], minlength=1 << trials) for j in range(self.points)]
        return np.stack(counts) / self.optimal.shape[1]

    def draw(self, weights: FloatArray, shape: tuple[int, ...], rng: np.random.Generator) -> Drawn:
        """People drawn from a population with ``weights`` ``[J]``."""
        bounds = np.cumsum(weights)
        points: FloatArray = rng.random(shape) * bounds[-1]
        who = np.minimum(np.searchsorted(bounds, points, side="right"), self.points - 1)
        which = rng.integers(self.performance.shape[1], size=shape)
        return Drawn(self.performance[who, which], self.optimal[who, which].sum(axis=-1))


@dataclass(frozen=True, eq=False)
class Drawn:
    """Participants of experiments.

    Attributes:
        performance: ``[...]`` mean reward over their trials.
        optimal_trials: ``[...]`` how many of the trials ended at the optimal goal.
    """

    performance: FloatArray
    optimal_trials: IntArray


def simulate_pool(
    robot: Robot,
    protocol: Protocol,
    rng: np.random.Generator,
    *,
    who: People | None = None,
    points: int = POOL_POINTS,
    people: int = POOL_PEOPLE,
) -> Pool:
    """Simulate ``people`` with each of ``points`` values of alpha.

    Args:
        robot: whom they work with.
        protocol: what they do.
        rng: source of the draws.
        who: how they deviate from the adaptation model; not at all if None.
        points: values of alpha.
        people: with each.
    """
    who = who or People()
    together = min(people, ALIKE) if who.differ else people
    begins = range(0, people, together)
    optimal_goal = robot.model.world.optimal_goal
    performance = np.empty((points, people))
    optimal = np.empty((points, people, protocol.trials), dtype=np.bool_)
    for j, alpha in enumerate(alpha_grid(points).tolist()):
        drawn = who.draw(alpha, protocol.first_mode, len(begins), rng)
        for begin, person in zip(begins, drawn, strict=True):
            some = slice(begin, min(begin + together, people))
            found = simulate_batch(
                robot,
                person,
                some.stop - begin,
                rng,
                trials=protocol.trials,
                carry_belief=protocol.carry_belief,
                keep_mode=protocol.keep_mode,
            )
            performance[j, some] = found.reward.mean(axis=1)
            optimal[j, some] = found.goal == optimal_goal
    return Pool(performance, optimal)
