"""Intervals of effect sizes by inverting noncentral distributions (Steiger 2004).

An effect size grows with the noncentrality λ of its test statistic. The interval of λ holds those
for which the observed statistic lies between the 2.5 and the 97.5 % point of its distribution.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from scipy import stats
from scipy.optimize import brentq

from coadapt.analysis.tests.result import LEVEL

LARGEST = 1e6
"""A noncentrality beyond which an effect is as large as effects can be."""


def explained_interval(
    f: float, df1: float, df2: float, n: int, level: float = LEVEL
) -> tuple[float, float]:
    """The interval of the share of variance explained, λ / (λ + n), from a statistic F.

    Args:
        f: the statistic; infinite where nothing is left unexplained.
        df1, df2: its degrees of freedom.
        n: number of all values.
        level: of the interval.
    """
    if math.isinf(f):
        return 1.0, 1.0

    def below(noncentrality: float) -> float:
        if noncentrality == 0:
            return float(stats.f.cdf(f, df1, df2))
        return float(stats.ncf.cdf(f, df1, df2, noncentrality))

    low, high = _limits(below, level, 0.0)
    return low / (low + n), high / (high + n)


def cramer_interval(
    statistic: float, df: int, n: int, smaller: int, level: float = LEVEL
) -> tuple[float, float]:
    """The interval of Cramér's V, √(λ / (n (min(r, c) - 1))), from a statistic χ².

    Args:
        statistic: χ².
        df: its degrees of freedom.
        n: number of all counts.
        smaller: the smaller number of rows or columns.
        level: of the interval.
    """

    def below(noncentrality: float) -> float:
        if noncentrality == 0:
            return float(stats.chi2.cdf(statistic, df))
        return float(stats.ncx2.cdf(statistic, df, noncentrality))

    low, high = _limits(below, level, 0.0)
    scale = n * (smaller - 1)
    return min(1.0, math.sqrt(low / scale)), min(1.0, math.sqrt(high / scale))


def difference_interval(
    t: float, df: float, n1: int, n2: int, level: float = LEVEL
) -> tuple[float, float]:
    """The interval of a standardised mean difference, λ √(1/n1 + 1/n2), from a statistic t."""

    def below(noncentrality: float) -> float:
        if noncentrality == 0:
            return float(stats.t.cdf(t, df))
        return float(stats.nct.cdf(t, df, noncentrality))

    low, high = _limits(below, level, -math.inf)
    scale = math.sqrt(1 / n1 + 1 / n2)
    return low * scale, high * scale


def _limits(below: Callable[[float], float], level: float, least: float) -> tuple[float, float]:
    """The noncentralities at which the statistic is the upper and the lower point of ``level``."""
    tail = (1 - level) / 2
    return _where(below, 1 - tail, least), _where(below, tail, least)


def _where(below: Callable[[float], float], share: float, least: float) -> float:
    """The noncentrality that leaves ``share`` below the statistic; ``below`` falls with it."""
    if least == 0 and below(0.0) <= share:
        return 0.0
    low, high = (0.0 if least == 0 else -1.0), 1.0
    while below(high) > share and high < LARGEST:
        high *= 2
    while low < 0 and below(low) < share and low > -LARGEST:
        low *= 2
    if high >= LARGEST:
        return high
    return float(brentq(lambda at: below(at) - share, low, high, xtol=1e-12, rtol=1e-14))
