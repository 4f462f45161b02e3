"""Tests of means: the analysis of variance for equal variances, and Welch's for any.

F = (SS_between / (k - 1)) / (SS_within / (N - k))
η² = SS_between / SS_total
ω² = (SS_between - (k - 1) MS_within) / (SS_total + MS_within)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy import stats

from coadapt.analysis.tests import apa
from coadapt.analysis.tests.assumptions import INDEPENDENT, equal_variances, normal_within
from coadapt.analysis.tests.noncentral import explained_interval
from coadapt.analysis.tests.result import Effect, TestResult
from coadapt.analysis.tests.samples import Samples

METHOD = "noncentral F"


def one_way_anova(values: Mapping[str, Sequence[float]]) -> TestResult:
    """Whether the means of the groups differ, given equal variances (Fisher).

    η² is the share of the variance in the sample that the groups explain, ω² the less biased
    estimate of that in the population, which may fall below 0. Both have the same interval (Steiger
    2004).

    Args:
        values: by its name, each group.

    Raises:
        CannotTest: if values differ within no group, or there are too few.
    """
    samples = Samples(values)
    samples.require_spread()
    samples.require_spread_within()
    found = stats.f_oneway(*samples.arrays)
    f, p = float(found.statistic), float(found.pvalue)
    df1, df2, n = len(samples.names) - 1, samples.total - len(samples.names), samples.total
    # With F and its degrees of freedom the sums of squares are known up to their scale.
    between, within = df1 * f, float(df2)
    low, high = explained_interval(f, df1, df2, n)
    eta = Effect(name="η²", value=between / (between + within), low=low, high=high, method=METHOD)
    value = (between - df1) / (between + within + 1)
    omega = Effect(name="ω²", value=value, low=low, high=high, method=METHOD)
    return TestResult(
        test="one-way ANOVA",
        groups=samples.groups,
        symbol="F",
        statistic=f,
        df=(float(df1), float(df2)),
        p=p,
        adjusted=p,
        effects=(eta, omega),
        assumptions=(INDEPENDENT, *normal_within(samples), equal_variances(samples)),
        notes=_constant(samples),
        sentence=(
            f"A one-way ANOVA: F({df1}, {df2}) = {apa.number(f)}, {apa.p_value(p)}, "
            f"{apa.effect(eta)}, ω² = {apa.proportion(value)}."
        ),
    )


def welch_anova(values: Mapping[str, Sequence[float]]) -> TestResult:
    """Whether the means of the groups differ, whatever their variances (Welch 1951).

    ω² = (k - 1) (F - 1) / ((k - 1) (F - 1) + N), with Welch's F.

    Args:
        values: by its name, each group.

    Raises:
        CannotTest: if values of a group do not differ, or there are too few.
    """
    samples = Samples(values)
    samples.require_spread_in_each()
    found = stats.f_oneway(*samples.arrays, equal_var=False)
    f, p = float(found.statistic), float(found.pvalue)
    df1, df2, n = len(samples.names) - 1, _welch_df(samples), samples.total
    low, high = explained_interval(f, df1, df2, n)
    value = df1 * (f - 1) / (df1 * (f - 1) + n)
    omega = Effect(
        name="ω²", value=value, low=low, high=high, method=f"{METHOD}, with Welch's F (approximate)"
    )
    return TestResult(
        test="Welch's ANOVA",
        groups=samples.groups,
        symbol="F",
        statistic=f,
        df=(float(df1), df2),
        p=p,
        adjusted=p,
        effects=(omega,),
        assumptions=(INDEPENDENT, *normal_within(samples)),
        sentence=(
            f"Welch's ANOVA: F({df1}, {df2:.2f}) = {apa.number(f)}, {apa.p_value(p)}, "
            f"{apa.effect(omega)}."
        ),
    )


def _welch_df(samples: Samples) -> float:
    """Denominator degrees of freedom of Welch's F."""
    sizes = np.array([len(array) for array in samples.arrays])
    weights = sizes / np.array([np.var(array, ddof=1) for array in samples.arrays])
    rest = (1 - weights / weights.sum()) ** 2 / (sizes - 1)
    k = len(sizes)
    return float((k * k - 1) / (3 * rest.sum()))


def _constant(samples: Samples) -> tuple[str, ...]:
    if not samples.constant:
        return ()
    return (
        f"All values of {', '.join(samples.constant)} are the same: variances cannot be equal.",
    )
