"""Tests by ranks: Kruskal and Wallis for all groups, Mann and Whitney for two.

With ties both are corrected for them:

    H = (N - 1) · SS_between / SS_total            of the ranks
    U1 = number of pairs in which the first group's value is larger, ties counting half
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy import stats
from scipy.optimize import brentq

from coadapt.analysis.tests import apa
from coadapt.analysis.tests.assumptions import INDEPENDENT, ties
from coadapt.analysis.tests.noncentral import explained_interval
from coadapt.analysis.tests.result import LEVEL, Check, Effect, TestResult
from coadapt.analysis.tests.samples import CannotTest, Samples

EXACT_BELOW = 50
"""Groups smaller than this are compared exactly where no values are tied, as in R."""

FEWEST_FOR_CHI2 = 5
"""Smallest group for which χ² is a usual approximation of the distribution of H."""


def kruskal_wallis(values: Mapping[str, Sequence[float]]) -> TestResult:
    """Whether the groups differ, by ranks (Kruskal and Wallis 1952).

    The effect is ε² = H / (N - 1), the share of the variance of ranks that the groups explain. Its
    interval inverts the noncentral F of the analysis of variance of the ranks.

    Args:
        values: by its name, each group.

    Raises:
        CannotTest: if all values are the same, or there are too few.
    """
    samples = Samples(values, fewest=1)
    n, k = samples.total, len(samples.names)
    if n <= k:
        raise CannotTest(f"needs more than {k} values in {k} groups, found {n}")
    samples.require_spread()
    found = stats.kruskal(*samples.arrays)
    h, p, df = float(found.statistic), float(found.pvalue), k - 1
    share = min(1.0, h / (n - 1))
    f = np.inf if share >= 1 - 1e-12 else (share / df) / ((1 - share) / (n - k))
    low, high = explained_interval(float(f), df, n - k, n)
    effect = Effect(
        name="ε²",
        value=share,
        low=low,
        high=high,
        method="noncentral F of the ranks' analysis of variance (approximate)",
    )
    smallest = min(len(array) for array in samples.arrays)
    approximate = Check(
        assumption="χ² approximates the distribution of H",
        method=f"smallest group of at least {FEWEST_FOR_CHI2}",
        statistic=smallest,
        holds=smallest >= FEWEST_FOR_CHI2,
    )
    notes: tuple[str, ...] = ()
    if samples.constant:
        notes = (f"All values of {', '.join(samples.constant)} are the same.",)
    return TestResult(
        test="Kruskal-Wallis",
        groups=samples.groups,
        symbol="χ²",
        statistic=h,
        df=(float(df),),
        p=p,
        adjusted=p,
        effects=(effect,),
        assumptions=(INDEPENDENT, ties(samples), approximate),
        notes=notes,
        sentence=(
            f"A Kruskal-Wallis test: χ²({df}, N = {n}) = {apa.number(h)}, {apa.p_value(p)}, "
            f"{apa.effect(effect)}."
        ),
    )


def mann_whitney(values: Mapping[str, Sequence[float]]) -> TestResult:
    """Whether the values of one of two groups tend to be larger (Mann and Whitney 1947).

    p is two-sided: exact if no values are tied and both groups have fewer than `EXACT_BELOW`, else
    by the normal distribution, corrected for ties and continuity. Papers print U1, U2 or the
    smaller of them; all three are given. The effect is the rank-biserial correlation r = 2 U1 / (n1
    n2) - 1: the chance that the first is larger minus the chance that it is smaller (Kerby 2014).

    Args:
        values: by its name, each of two groups.

    Raises:
        CannotTest: if all values are the same, or there are not two groups with values.
    """
    samples = Samples(values, fewest=1)
    if len(samples.names) != 2:
        raise CannotTest(f"compares 2 groups, found {len(samples.names)}")
    samples.require_spread()
    first, second = samples.arrays
    n1, n2 = len(first), len(second)
    pooled = samples.pooled
    tied = len(np.unique(pooled)) < len(pooled)
    exact = not tied and max(n1, n2) < EXACT_BELOW
    method = "exact" if exact else "asymptotic"
    found = stats.mannwhitneyu(first, second, alternative="two-sided", method=method)
    u1, p = float(found.statistic), float(found.pvalue)
    u2 = n1 * n2 - u1
    effect = rank_biserial(u1, n1, n2)
    details = {"U1": u1, "U2": u2, "U_min": min(u1, u2)}
    if not exact:
        details["z"] = _z(pooled, u1, n1, n2)
    how = "exact" if exact else "normal approximation, corrected for ties and continuity"
    one, two = samples.names
    return TestResult(
        test="Mann-Whitney",
        groups=samples.groups,
        symbol="U",
        statistic=min(u1, u2),
        p=p,
        adjusted=p,
        effects=(effect,),
        assumptions=(INDEPENDENT, ties(samples)),
        details=details,
        notes=(f"p is {how}.", f"U is the smaller of U1 = {u1:g} ({one}) and U2 = {u2:g} ({two})."),
        sentence=(
            f"{one} ({_medians(samples, 0)}) and {two} ({_medians(samples, 1)}), Mann-Whitney "
            f"test: U = {min(u1, u2):g}, {apa.p_value(p)}, {apa.effect(effect)}."
        ),
    )


def rank_biserial(u1: float, n1: int, n2: int, level: float = LEVEL) -> Effect:
    """The rank-biserial correlation of two groups with Newcombe's interval.

    The interval is that of θ = U1 / (n1 n2) by method 5 of Newcombe (2006), which solves
    ``|θ̂ - θ| = z √V(θ)`` and so has some width also where all pairs agree; r = 2 θ - 1.
    """
    theta, z = u1 / (n1 * n2), float(stats.norm.isf((1 - level) / 2))
    size = (n1 + n2) / 2

    low, high = _newcombe(theta, size, z * z / (n1 * n2))
    return Effect(
        name="r",
        value=2 * theta - 1,
        low=2 * low - 1,
        high=2 * high - 1,
        level=level,
        method="Newcombe (2006), method 5",
    )


def _newcombe(theta: float, size: float, scale: float) -> tuple[float, float]:
    """Both solutions of (θ̂ - θ)² = scale · θ (1 - θ) (1 + (size - 1) (...))."""

    def variance(at: float) -> float:
        return scale * at * (1 + (size - 1) * ((1 - at) / (2 - at) + at / (1 + at)))

    def excess(at: float) -> float:
        return (theta - at) ** 2 - (1 - at) * variance(at)

    if theta in (0.0, 1.0):
        # One solution is the estimate; the other solves what is left after dividing by 1 - θ.
        other = float(brentq(lambda at: 1 - at - variance(at), 0.0, 1.0, xtol=1e-14))
        return (other, 1.0) if theta == 1 else (0.0, 1 - other)
    low = float(brentq(excess, 0.0, theta, xtol=1e-14))
    return low, float(brentq(excess, theta, 1.0, xtol=1e-14))


def _z(pooled: np.ndarray, u1: float, n1: int, n2: int) -> float:
    """U1 as a standard normal value, corrected for ties and continuity."""
    n = n1 + n2
    _, counts = np.unique(pooled, return_counts=True)
    correction = float((counts**3 - counts).sum()) / (n * (n - 1))
    deviation = np.sqrt(n1 * n2 / 12 * (n + 1 - correction))
    apart = u1 - n1 * n2 / 2
    return float((apart - np.sign(apart) * min(0.5, abs(apart))) / deviation)


def _medians(samples: Samples, i: int) -> str:
    group = samples.groups[i]
    return f"Mdn = {apa.number(group.median)}, n = {group.n}"
