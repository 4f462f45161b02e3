"""The tests of H1: the published statistics, and scipy's one experiment at a time."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from coadapt.analysis.experiment.published import (
    CHI2,
    PARTICIPANTS,
    RECONSTRUCTED,
    U_LOWER,
    U_UPPER,
)
from coadapt.analysis.hypotheses import h1_tests
from coadapt.analysis.shares import share_interval


def performance(counts: tuple[int, ...]) -> np.ndarray:
    """``[1, n]`` mean reward of people with 0 to 3 optimal trials, worth 11 instead of 10."""
    return 10 + np.repeat(np.arange(len(counts)), counts)[None] / 3


def test_the_reconstructed_table_gives_the_published_statistics() -> None:
    found = h1_tests(
        performance((0, 0, 0, PARTICIPANTS["no_adaptation"])),
        performance(RECONSTRUCTED["mutual_adaptation"]),
        performance(RECONSTRUCTED["one_way_adaptation"]),
    )
    assert found.chi2[0] == pytest.approx(CHI2, abs=0.005)  # Sec. 7
    assert (found.u_upper[0], found.u_lower[0]) == (U_UPPER, U_LOWER)
    assert found.p[0] < 0.001
    assert round(found.p_lower[0], 3) == 0.001
    assert found.supported.tolist() == [True]


def test_many_experiments_are_tested_as_one_by_one() -> None:
    rng = np.random.default_rng(0)
    fixed, mutual, one_way = (rng.integers(0, 4, (30, n)) / 3.0 for n in (7, 5, 6))
    found = h1_tests(fixed, mutual, one_way, comparisons=3)
    for s in range(30):
        whole = stats.kruskal(fixed[s], mutual[s], one_way[s])
        assert found.chi2[s] == pytest.approx(whole.statistic)
        assert found.p[s] == pytest.approx(whole.pvalue)
        pair = stats.mannwhitneyu(mutual[s], one_way[s], method="asymptotic")
        assert found.u_lower[s] == min(pair.statistic, 30 - pair.statistic)
        assert found.p_lower[s] == pytest.approx(min(1.0, 3 * pair.pvalue))


def test_where_all_did_alike_nothing_is_found() -> None:
    same = np.ones((1, 4))
    found = h1_tests(same, same, same)
    assert (found.chi2[0], found.p[0], found.p_upper[0]) == (0.0, 1.0, 1.0)
    assert not found.supported[0]


def test_a_difference_the_other_way_does_not_support_h1() -> None:
    low, high = np.zeros((1, 30)), np.ones((1, 30))
    found = h1_tests(low, high, low)
    assert found.p_upper[0] < 0.05
    assert found.upper.tolist() == [False]
    assert found.lower.tolist() == [True]
    assert found.supported.tolist() == [False]


def test_intervals_of_shares() -> None:
    # No hit of n: 1 - 0.025 ** (1 / n) by the binomial distribution.
    assert share_interval(0, 20) == (0.0, pytest.approx(1 - 0.025 ** (1 / 20)))
    with pytest.raises(ValueError, match="2 of 1 is no share"):
        share_interval(2, 1)
