"""Sums over simulated episodes: shares of the goals and means, with their standard errors."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.formalism import Model
from coadapt.simulation.batch import Batch

Z95 = 1.959963984540054
"""Half-width of a 95 % interval, in standard errors."""


@dataclass(frozen=True)
class Mean:
    """A mean over episodes.

    Attributes:
        mean: the mean.
        standard_error: ``s / sqrt(n)``; NaN of a single episode.
    """

    mean: float
    standard_error: float

    @classmethod
    def of(cls, values: FloatArray | IntArray | BoolArray) -> Mean:
        """The mean of at least one number."""
        count = values.size
        error = float(values.std(ddof=1)) / sqrt(count) if count > 1 else float("nan")
        return cls(float(values.mean()), error)


@dataclass(frozen=True, eq=False)
class Summary:
    """What some episodes came to.

    Attributes:
        runs: number of episodes.
        reward: reward of the goal reached, the performance of Sec. 5.4.
        low, high: 95 % interval of its expectation, see `reward_interval`.
        goals: ``[G]`` share of the episodes that ended at each goal.
        no_goal: share of the others.
        discounted_return, steps, disagreement, overridden: as in `coadapt.simulation.Batch`.
        switched: share of the episodes in which the person's mode changed.
        adaptability: the robot's last estimate of alpha, its posterior mean; None if the batch did
            not keep beliefs.
    """

    runs: int
    reward: Mean
    low: float
    high: float
    goals: FloatArray
    no_goal: float
    discounted_return: Mean
    steps: Mean
    disagreement: Mean
    overridden: Mean
    switched: Mean
    adaptability: Mean | None


def summarize(
    batch: Batch, model: Model, *, trial: int | None = None, levels: FloatArray | None = None
) -> Summary:
    """Sum up a batch of at least one person.

    Args:
        batch: the episodes.
        model: of the robot.
        trial: which trial of each person, from 0; all of them if None.
        levels: ``[A]`` the values of alpha that the robot's beliefs are about; those of ``model``
            if None.

    Raises:
        ValueError: if there are no episodes.
    """
    if batch.people == 0:
        raise ValueError("there are no episodes to sum up")
    part = slice(None) if trial is None else slice(trial, trial + 1)
    goal = batch.goal[:, part]
    goals = len(model.world.goals)
    ends = np.bincount(goal[goal >= 0].ravel(), minlength=goals)
    reward = Mean.of(batch.reward[:, part])
    low, high = reward_interval(ends, goal.size, [g.reward for g in model.world.goals], reward)
    adaptability = None
    if batch.belief is not None:
        values = model.alpha.levels if levels is None else levels
        adaptability = Mean.of(batch.belief[:, part].sum(axis=-1) @ values)
    return Summary(
        runs=goal.size,
        reward=reward,
        low=low,
        high=high,
        goals=ends / goal.size,
        no_goal=1.0 - int(ends.sum()) / goal.size,
        discounted_return=Mean.of(batch.discounted_return[:, part]),
        steps=Mean.of(batch.steps[:, part]),
        disagreement=Mean.of(batch.disagreement[:, part]),
        overridden=Mean.of(batch.overridden[:, part]),
        switched=Mean.of(batch.switched[:, part]),
        adaptability=adaptability,
    )


def reward_interval(
    ends: IntArray, runs: int, rewards: list[float], reward: Mean
) -> tuple[float, float]:
    """95 % interval of the expected reward.

    Where all episodes ended at one of two goals the mean is ``worst + (best - worst) p`` and the
    interval is Wilson's for ``p``, which stays sensible where all ended alike. Otherwise it is the
    mean and `Z95` standard errors.

    Args:
        ends: ``[G]`` number of episodes that ended at each goal.
        runs: number of episodes.
        rewards: ``G`` rewards.
        reward: the mean.
    """
    if len(rewards) != 2 or ends.sum() < runs:
        spread = Z95 * reward.standard_error
        return reward.mean - spread, reward.mean + spread
    worst, best = sorted(rewards)
    share = float(ends[int(np.argmax(rewards))]) / runs
    spread = Z95 * sqrt(share * (1 - share) / runs + Z95**2 / (4 * runs**2))
    middle = share + Z95**2 / (2 * runs)
    scale = (best - worst) / (1 + Z95**2 / runs)
    low, high = worst + scale * (middle - spread), worst + scale * (middle + spread)
    return max(worst, low), min(best, high)
