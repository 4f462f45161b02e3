"""Whether two means are equivalent: two one-sided tests (Schuirmann 1987).

"Not significantly different" says little: a small study finds few differences. Two means are called
equivalent if their difference is significantly above -bound and significantly below +bound. With
Welch's t that is so at level 5 % if the 90 % interval of the difference lies between the bounds.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from scipy import stats

from coadapt.analysis.tests import apa
from coadapt.analysis.tests.assumptions import INDEPENDENT, normal_within
from coadapt.analysis.tests.pairs import hedges_g
from coadapt.analysis.tests.result import Effect, TestResult
from coadapt.analysis.tests.samples import CannotTest, Samples

INSIDE = 0.90
"""Level of the interval that goes with two one-sided tests at 5 %."""


def equivalence(values: Mapping[str, Sequence[float]], bound: float) -> TestResult:
    """Two one-sided Welch tests of the difference of two means.

    Args:
        values: by its name, each of two groups.
        bound: the smallest difference that would matter, in the unit of the values.

    Raises:
        CannotTest: if values differ in neither group, there are too few or not two groups, or the
            bound is not above 0.
    """
    samples = Samples(values)
    if len(samples.names) != 2:
        raise CannotTest(f"compares 2 groups, found {len(samples.names)}")
    if not (bound > 0 and math.isfinite(bound)):
        raise CannotTest(f"needs a bound above 0, found {bound:g}")
    samples.require_spread_within()
    first, second = samples.arrays
    low = stats.ttest_ind(first + bound, second, equal_var=False, alternative="greater")
    high = stats.ttest_ind(first - bound, second, equal_var=False, alternative="less")
    p, df = float(max(low.pvalue, high.pvalue)), float(low.df)
    nearer = low if low.pvalue >= high.pvalue else high
    interval = stats.ttest_ind(first, second, equal_var=False).confidence_interval(INSIDE)
    apart = Effect(
        name="difference of means",
        value=float(np.mean(first) - np.mean(second)),
        low=float(interval.low),
        high=float(interval.high),
        level=INSIDE,
        method="Welch's t",
    )
    one, two = samples.names
    return TestResult(
        test="equivalence (two one-sided Welch tests)",
        groups=samples.groups,
        symbol="t",
        statistic=float(nearer.statistic),
        df=(df,),
        p=p,
        adjusted=p,
        effects=(apart, hedges_g(first, second)),
        assumptions=(INDEPENDENT, *normal_within(samples)),
        details={
            "bound": bound,
            "t_low": float(low.statistic),
            "p_low": float(low.pvalue),
            "t_high": float(high.statistic),
            "p_high": float(high.pvalue),
        },
        notes=("p is the larger of the two one-sided ones; a small p speaks for equivalence.",),
        sentence=(
            f"{one} and {two}, equivalence within ±{bound:g} by two one-sided Welch tests: "
            f"t({df:.2f}) = {apa.number(float(nearer.statistic))}, {apa.p_value(p)}, difference "
            f"{apa.number(apart.value)}, 90% CI "
            f"[{apa.number(apart.low)}, {apa.number(apart.high)}]."
        ),
    )
