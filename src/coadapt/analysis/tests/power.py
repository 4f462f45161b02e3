"""What a sample can show: the smallest effect that an analysis of variance finds with a given
power.

Power that is computed from the effect observed says no more than p does. What an effect would have
to be like to be found says how to read "not significant".
"""

from __future__ import annotations

from collections.abc import Sequence

from scipy import stats
from scipy.optimize import brentq

from coadapt.analysis.tests.samples import CannotTest

POWER = 0.8


def smallest_effect(sizes: Sequence[int], level: float = 0.05, power: float = POWER) -> float:
    """The smallest η² in the population that a one-way ANOVA finds with probability ``power``.

    With N values in k groups the statistic has noncentrality λ = N η² / (1 - η²).

    Args:
        sizes: of the groups; what counts is their sum.
        level: p below which a finding is significant.
        power: probability of a significant finding.

    Raises:
        CannotTest: if there are fewer than two groups, or no more values than groups.
    """
    n, k = sum(sizes), len(sizes)
    if k < 2 or n <= k:
        raise CannotTest(f"needs more than {k} values in at least 2 groups, found {n}")
    df1, df2 = k - 1, n - k
    critical = float(stats.f.isf(level, df1, df2))

    def excess(share: float) -> float:
        return float(stats.ncf.sf(critical, df1, df2, n * share / (1 - share))) - power

    return float(brentq(excess, 1e-9, 1 - 1e-6, xtol=1e-12))
