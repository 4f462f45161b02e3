"""The power of the study: how often it would find what H1 says, by its number of participants."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from coadapt.analysis.experiment.pool import Pool
from coadapt.analysis.hypotheses import COMPARISONS, SIGNIFICANCE, h1_tests
from coadapt.analysis.shares import share_interval
from coadapt.arrays import FloatArray

QUESTIONS = ("H1", "mutual > one-way", "no adaptation > mutual")
"""What may be found: all of H1, or one of its two parts."""


@dataclass(frozen=True, eq=False)
class Conditions:
    """The people of the three conditions of Sec. 6.1."""

    no_adaptation: Pool
    mutual: Pool
    one_way: Pool


@dataclass(frozen=True)
class PowerPoint:
    """The power at one number of participants.

    Attributes:
        n: participants in each condition.
        experiments: simulated.
        power: the share of them that find each of `QUESTIONS`.
        low, high: 95 % Monte-Carlo intervals (Clopper and Pearson) of those probabilities.
        difference: mean over the experiments of how much better, in units of reward, teams did with
            mutual than with one-way adaptation.
    """

    n: int
    experiments: int
    power: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    difference: float


@dataclass(frozen=True)
class Needed:
    """The participants needed in each condition.

    Attributes:
        n: the smallest simulated number from which on the wanted power is reached, or None.
        surely: the smallest from which on all of the Monte-Carlo interval reaches it, or None.
        perhaps: the smallest at which any of the interval does, or None.
    """

    n: int | None
    surely: int | None
    perhaps: int | None


def power_curve(
    conditions: Conditions,
    weights: FloatArray,
    sizes: Sequence[int],
    experiments: int,
    rng: np.random.Generator,
    *,
    comparisons: int = COMPARISONS,
    significance: float = SIGNIFICANCE,
    tell: Callable[[int], None] | None = None,
) -> list[PowerPoint]:
    """The power at each of ``sizes``.

    Args:
        conditions: whom to draw from.
        weights: ``[J]`` the population, on the pools' grid of alpha.
        sizes: participants in each condition.
        experiments: to simulate at each size.
        rng: source of the draws.
        comparisons, significance: see `h1_tests`.
        tell: called with each size when it is done.
    """
    points: list[PowerPoint] = []
    for n in sizes:
        fixed, mutual, one_way = (
            pool.draw(weights, (experiments, n), rng).performance
            for pool in (conditions.no_adaptation, conditions.mutual, conditions.one_way)
        )
        found = h1_tests(fixed, mutual, one_way, comparisons=comparisons, significance=significance)
        counts = [int(x.sum()) for x in (found.supported, found.lower, found.upper)]
        intervals = [share_interval(count, experiments) for count in counts]
        points.append(
            PowerPoint(
                n=n,
                experiments=experiments,
                power=tuple(count / experiments for count in counts),
                low=tuple(low for low, _ in intervals),
                high=tuple(high for _, high in intervals),
                difference=float(mutual.mean() - one_way.mean()),
            )
        )
        if tell is not None:
            tell(n)
    return points


def participants_needed(points: Sequence[PowerPoint], wanted: float, question: int = 0) -> Needed:
    """The number of participants that gives the ``wanted`` power, among those simulated.

    Args:
        points: by increasing ``n``.
        wanted: power, in (0, 1).
        question: index in `QUESTIONS`.
    """

    def first(values: list[float]) -> int | None:
        reached = [value >= wanted for value in values]
        for i, point in enumerate(points):
            if all(reached[i:]):
                return point.n
        return None

    possible = [point.n for point in points if point.high[question] >= wanted]
    return Needed(
        n=first([point.power[question] for point in points]),
        surely=first([point.low[question] for point in points]),
        perhaps=possible[0] if possible else None,
    )
