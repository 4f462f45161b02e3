"""Every pair of means after an analysis of variance, with the family's error held.

p and the intervals of the differences come from the studentised range over all groups: Tukey and
Kramer's for equal variances, Games and Howell's for any. They hold for all k (k - 1) / 2 pairs
together. The effect is Hedges' g with the pooled deviation of the pair.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache
from itertools import combinations

import numpy as np
from scipy import stats

from coadapt.analysis.tests import apa
from coadapt.analysis.tests.assumptions import INDEPENDENT, equal_variances, normal_within
from coadapt.analysis.tests.noncentral import difference_interval
from coadapt.analysis.tests.result import LEVEL, Check, Effect, TestResult
from coadapt.analysis.tests.samples import CannotTest, Samples

RANGE = "studentised range"


def tukey(values: Mapping[str, Sequence[float]]) -> tuple[TestResult, ...]:
    """Tukey and Kramer's comparison of each pair of means, given equal variances.

    Args:
        values: by its name, each group.

    Returns:
        A result for each pair, in the order of the groups; the differences are first minus second.

    Raises:
        CannotTest: if values differ within no group, or there are too few.
    """
    samples = Samples(values)
    samples.require_spread()
    samples.require_spread_within()
    checks = (INDEPENDENT, *normal_within(samples), equal_variances(samples))
    return _compared(samples, "Tukey's HSD", checks, equal=True)


def games_howell(values: Mapping[str, Sequence[float]]) -> tuple[TestResult, ...]:
    """Games and Howell's comparison of each pair of means, whatever the variances.

    Args:
        values: by its name, each group.

    Raises:
        CannotTest: if values of a group do not differ, or there are too few.
    """
    samples = Samples(values)
    samples.require_spread_in_each()
    return _compared(samples, "Games-Howell", (INDEPENDENT, *normal_within(samples)), equal=False)


def hedges_g(first: np.ndarray, second: np.ndarray, level: float = LEVEL) -> Effect:
    """Hedges' g: the difference of means in pooled deviations, less its bias in small samples.

    g = d (1 - 3 / (4 (n1 + n2) - 9)); the interval is that of d by the noncentral t, times the
    same.

    Raises:
        CannotTest: if values differ in neither sample.
    """
    n1, n2 = len(first), len(second)
    df = n1 + n2 - 2
    pooled = (
        float(np.var(first, ddof=1)) * (n1 - 1) + float(np.var(second, ddof=1)) * (n2 - 1)
    ) / df
    if pooled == 0:
        raise CannotTest("values differ in neither group: there is no deviation to measure by")
    d = float(np.mean(first) - np.mean(second)) / math.sqrt(pooled)
    shrink = 1 - 3 / (4 * (n1 + n2) - 9)
    low, high = difference_interval(d / math.sqrt(1 / n1 + 1 / n2), df, n1, n2, level)
    return Effect(
        name="g",
        value=d * shrink,
        low=low * shrink,
        high=high * shrink,
        level=level,
        method="noncentral t",
    )


def _compared(
    samples: Samples, test: str, checks: tuple[Check, ...], *, equal: bool
) -> tuple[TestResult, ...]:
    k = len(samples.names)
    pairs = list(combinations(range(k), 2))
    results: list[TestResult] = []
    for i, j in pairs:
        apart = float(np.mean(samples.arrays[i]) - np.mean(samples.arrays[j]))
        error, df = _error(samples, i, j, equal=equal)
        q = abs(apart) / error
        p = float(stats.studentized_range.sf(q, k, df))
        reach = _point(k, df) * error
        low, high = apart - reach, apart + reach
        difference = Effect(
            name="difference of means", value=apart, low=low, high=high, method=f"{test}, all pairs"
        )
        effects, notes = (difference,), ()
        try:
            effects = (difference, hedges_g(samples.arrays[i], samples.arrays[j]))
        except CannotTest as reason:
            notes = (f"No Hedges' g: {reason}.",)
        one, two = samples.groups[i], samples.groups[j]
        results.append(
            TestResult(
                test=test,
                groups=(one, two),
                symbol="q",
                statistic=q,
                df=(float(k), df),
                p=p,
                comparisons=len(pairs),
                correction=RANGE,
                adjusted=p,
                effects=effects,
                assumptions=checks,
                notes=notes,
                sentence=(
                    f"{one.name} (M = {apa.number(one.mean)}) and {two.name} "
                    f"(M = {apa.number(two.mean)}), {test} over {len(pairs)} pairs: difference "
                    f"{apa.number(apart)}, 95% CI [{apa.number(low)}, {apa.number(high)}], "
                    f"{apa.p_value(p)}"
                    + (f", {apa.effect(effects[1])}." if len(effects) > 1 else ".")
                ),
            )
        )
    return tuple(results)


@cache
def _point(k: int, df: float) -> float:
    """What the studentised range exceeds with probability 5 %; finding it takes a while."""
    return float(stats.studentized_range.isf(1 - LEVEL, k, df))


def _error(samples: Samples, i: int, j: int, *, equal: bool) -> tuple[float, float]:
    """The error that the studentised range divides by, and its degrees of freedom.

    The square of the error is half the variance of the difference of the two means.
    """
    first, second = samples.arrays[i], samples.arrays[j]
    n1, n2 = len(first), len(second)
    if equal:
        df = samples.total - len(samples.names)
        within = sum(float(np.var(x, ddof=1)) * (len(x) - 1) for x in samples.arrays) / df
        return math.sqrt(within / 2 * (1 / n1 + 1 / n2)), float(df)
    a, b = float(np.var(first, ddof=1)) / n1, float(np.var(second, ddof=1)) / n2
    return math.sqrt((a + b) / 2), (a + b) ** 2 / (a * a / (n1 - 1) + b * b / (n2 - 1))
