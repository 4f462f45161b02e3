"""The tests of the paper's Sec. 7 for many experiments at once; scipy does the arithmetic.

H1 (Sec. 6): teams do best in the no-adaptation condition, and better with mutual than with one-way
adaptation. It is tested by a Kruskal-Wallis test over the three conditions, then two-tailed
Mann-Whitney tests of the two neighbouring pairs, their p multiplied by the number of comparisons
(Bonferroni).
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np

from coadapt.arrays import BoolArray, FloatArray

COMPARISONS = 2
"""The pairs of H1. The published p of the second pair fits a factor of two."""

SIGNIFICANCE = 0.05


@dataclass(frozen=True, eq=False)
class H1Tests:
    """The tests of ``S`` experiments.

    Attributes:
        chi2, p: ``[S]`` of the Kruskal-Wallis test; 0 and 1 where all teams did alike.
        u_upper, p_upper: ``[S]`` no adaptation against mutual adaptation: the smaller U, as papers
            print it, and the p with its correction.
        u_lower, p_lower: ``[S]`` mutual against one-way adaptation.
        upper, lower: ``[S]`` whether the pair differs significantly and as H1 says.
    """

    chi2: FloatArray
    p: FloatArray
    u_upper: FloatArray
    p_upper: FloatArray
    u_lower: FloatArray
    p_lower: FloatArray
    upper: BoolArray
    lower: BoolArray
    significance: float

    @property
    def supported(self) -> BoolArray:
        """``[S]`` whether all of H1 is."""
        return self.upper & self.lower & (self.p < self.significance)


def h1_tests(
    no_adaptation: FloatArray,
    mutual: FloatArray,
    one_way: FloatArray,
    *,
    comparisons: int = COMPARISONS,
    significance: float = SIGNIFICANCE,
) -> H1Tests:
    """Test H1 in every experiment.

    Args:
        no_adaptation, mutual, one_way: ``[S, n]`` the performance of each team, ``n`` of any size
            in each condition.
        comparisons: the Bonferroni factor.
        significance: largest p to call a difference significant.
    """
    # Imported now: only who tests need wait for it.
    from scipy.stats import kruskal  # noqa: PLC0415

    with warnings.catch_warnings(), np.errstate(invalid="ignore", divide="ignore"):
        warnings.simplefilter("ignore", RuntimeWarning)  # where all teams did alike
        whole = kruskal(no_adaptation, mutual, one_way, axis=1)
    u_upper, p_upper, upper = _pair(no_adaptation, mutual, comparisons, significance)
    u_lower, p_lower, lower = _pair(mutual, one_way, comparisons, significance)
    return H1Tests(
        chi2=np.nan_to_num(np.asarray(whole.statistic), nan=0.0),
        p=np.nan_to_num(np.asarray(whole.pvalue), nan=1.0),
        u_upper=u_upper,
        p_upper=p_upper,
        u_lower=u_lower,
        p_lower=p_lower,
        upper=upper,
        lower=lower,
        significance=significance,
    )


def _pair(
    better: FloatArray, worse: FloatArray, comparisons: int, significance: float
) -> tuple[FloatArray, FloatArray, BoolArray]:
    from scipy.stats import mannwhitneyu  # noqa: PLC0415

    with warnings.catch_warnings(), np.errstate(invalid="ignore", divide="ignore"):
        warnings.simplefilter("ignore", RuntimeWarning)
        found = mannwhitneyu(better, worse, axis=1, method="asymptotic")
    u = np.asarray(found.statistic)
    most = better.shape[1] * worse.shape[1]
    p = np.minimum(np.nan_to_num(np.asarray(found.pvalue), nan=1.0) * comparisons, 1.0)
    return np.minimum(u, most - u), p, (p < significance) & (u > most / 2)
