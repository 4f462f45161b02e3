"""The paper's statistics of performance, from the counts that are reconstructed from them.

The counts (optimal-goal trials of three, by participant) are those of the only table for groups of
19, 16 and 17 that gives the published χ²(2) = 39.84 and U = 28.5 and 49.5 (Sec. 7.1).
"""

from __future__ import annotations

import numpy as np
import pytest

from coadapt.analysis.hypotheses import h1_tests
from coadapt.analysis.tests import TestResult, correct, kruskal_wallis, mann_whitney, proportions

NO = [3.0] * 19
MUTUAL = [0.0] * 4 + [1.0] * 7 + [2.0] * 2 + [3.0] * 3
ONE_WAY = [0.0] * 15 + [1.0, 2.0]


def test_performance() -> None:
    found = kruskal_wallis({"no": NO, "mutual": MUTUAL, "one-way": ONE_WAY})
    assert round(found.statistic, 2) == 39.84
    assert found.df == (2,)
    assert found.p < 0.001
    assert found.sentence.startswith("A Kruskal-Wallis test: χ²(2, N = 52) = 39.84, p < .001")
    # ε² = H / (N - 1)
    assert found.effects[0].value == pytest.approx(found.statistic / 51)


def test_pairs() -> None:
    two = [
        mann_whitney({"no": NO, "mutual": MUTUAL}),
        mann_whitney({"mutual": MUTUAL, "one-way": ONE_WAY}),
    ]
    first, second = correct(two, "bonferroni")
    assert isinstance(first, TestResult) and isinstance(second, TestResult)
    assert (first.details["U_min"], second.details["U_min"]) == (28.5, 49.5)
    # U1 + U2 = n1 n2
    assert (first.details["U1"], second.details["U1"]) == (19 * 16 - 28.5, 16 * 17 - 49.5)
    assert first.comparisons == second.comparisons == 2
    assert first.adjusted < 0.001
    assert round(second.adjusted, 3) == 0.001
    assert "U = 49.5, p = .001 (Bonferroni-corrected for 2 comparisons" in second.sentence
    # r = 2 U1 / (n1 n2) - 1
    assert first.effects[0].value == pytest.approx(1 - 2 * 28.5 / (19 * 16))


def test_at_the_optimal_goal_at_least_once() -> None:
    # Of Sec. 7.1: 12 of 16 in Mutual-adaptation; 15 of 17 never in One-way adaptation.
    counts = {
        "mutual": (sum(v > 0 for v in MUTUAL), len(MUTUAL)),
        "one-way": (sum(v > 0 for v in ONE_WAY), len(ONE_WAY)),
    }
    assert counts == {"mutual": (12, 16), "one-way": (2, 17)}
    assert "12 of 16 in mutual, 2 of 17 in one-way" in proportions(counts).sentence


def test_the_same_as_for_many_experiments_at_once() -> None:
    groups = [np.array([given]) for given in (NO, MUTUAL, ONE_WAY)]
    fast = h1_tests(*groups)
    overall = kruskal_wallis({"no": NO, "mutual": MUTUAL, "one-way": ONE_WAY})
    assert (fast.chi2[0], fast.p[0]) == pytest.approx((overall.statistic, overall.p))
    two = [
        mann_whitney({"no": NO, "mutual": MUTUAL}),
        mann_whitney({"mutual": MUTUAL, "one-way": ONE_WAY}),
    ]
    first, second = correct(two, "bonferroni")
    assert isinstance(first, TestResult) and isinstance(second, TestResult)
    assert (fast.u_upper[0], fast.p_upper[0]) == pytest.approx((first.statistic, first.adjusted))
    assert (fast.u_lower[0], fast.p_lower[0]) == pytest.approx((second.statistic, second.adjusted))
