"""Tests of how many of each group did something, for example changed their strategy."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product

import numpy as np
from scipy import stats
from scipy.stats.contingency import odds_ratio

from coadapt.analysis.tests import apa
from coadapt.analysis.tests.assumptions import INDEPENDENT
from coadapt.analysis.tests.noncentral import cramer_interval
from coadapt.analysis.tests.result import LEVEL, Check, Effect, TestResult
from coadapt.analysis.tests.samples import CannotTest, Group
from coadapt.arrays import IntArray

FEWEST_EXPECTED = 5.0
"""Smallest expected count for which χ² is a usual approximation; below it Fisher's test is
exact."""

MOST_TABLES = 200_000
"""Tables with given margins that Fisher's test goes through."""

Counts = Mapping[str, tuple[int, int]]
"""By the name of each group: how many did it, of how many."""


def proportions(counts: Counts) -> TestResult:
    """Whether the groups' proportions differ: χ², or Fisher's exact test where counts are small.

    Two groups are compared by Fisher's test in any case. It is used, too, where an expected count
    is below `FEWEST_EXPECTED`; with more than two groups it is that of Freeman and Halton (1951).

    Args:
        counts: by the name of each group, how many did it and how many there are.

    Raises:
        CannotTest: if all did it or none, a group is empty, or there are fewer than two.
    """
    names, table = _table(counts)
    expected = table.sum(axis=1, keepdims=True) * table.sum(axis=0, keepdims=True) / table.sum()
    check = Check(
        assumption="χ² approximates the distribution of the statistic",
        method=f"smallest expected count of at least {FEWEST_EXPECTED:g}",
        statistic=float(expected.min()),
        holds=bool(expected.min() >= FEWEST_EXPECTED),
    )
    if len(names) == 2:
        return _two(names, table, check)
    n, k = int(table.sum()), len(names)
    found = stats.chi2_contingency(table, correction=False)
    chi2, df = float(found.statistic), k - 1
    low, high = cramer_interval(chi2, df, n, 2)
    v = Effect(
        name="V",
        value=math.sqrt(chi2 / n),
        low=low,
        high=high,
        method="noncentral χ² (approximate)",
    )
    exact = not check.holds
    p = _freeman_halton(table) if exact else float(found.pvalue)
    if exact:
        said = f"Fisher-Freeman-Halton exact test (N = {n}): {apa.p_value(p)}"
    else:
        said = (
            f"A χ² test of independence: χ²({df}, N = {n}) = {apa.number(chi2)}, {apa.p_value(p)}"
        )
    return TestResult(
        test="Fisher-Freeman-Halton" if exact else "χ² test of independence",
        groups=_groups(names, table),
        symbol="χ²",
        statistic=chi2,
        df=(float(df),),
        p=p,
        adjusted=p,
        effects=(v,),
        assumptions=(INDEPENDENT, check),
        notes=("p is exact, for counts are small.",) if exact else (),
        sentence=f"{said}, {apa.effect(v)}. {_said(names, table)}.",
    )


def difference(first: tuple[int, int], second: tuple[int, int], level: float = LEVEL) -> Effect:
    """The difference of two proportions with Newcombe's hybrid score interval (1998, method 10)."""
    p1, p2 = first[0] / first[1], second[0] / second[1]
    (l1, u1), (l2, u2) = _wilson(*first, level), _wilson(*second, level)
    return Effect(
        name="difference of proportions",
        value=p1 - p2,
        low=p1 - p2 - math.hypot(p1 - l1, u2 - p2),
        high=p1 - p2 + math.hypot(u1 - p1, p2 - l2),
        level=level,
        method="Newcombe (1998), method 10",
    )


def _two(names: tuple[str, ...], table: IntArray, check: Check) -> TestResult:
    p = float(stats.fisher_exact(table).pvalue)
    counts = [(did, did + rest) for did, rest in table.tolist()]
    apart = difference(counts[0], counts[1])
    details: dict[str, float] = {}
    notes: tuple[str, ...] = ()
    if (table > 0).all():
        odds = odds_ratio(table, kind="conditional")
        interval = odds.confidence_interval(LEVEL)
        details = {
            "odds_ratio": float(odds.statistic),
            "odds_ratio_low": float(interval.low),
            "odds_ratio_high": float(interval.high),
        }
    else:
        notes = ("The odds ratio is 0 or without bound: a count is 0.",)
    return TestResult(
        test="Fisher's exact test",
        groups=_groups(names, table),
        symbol="difference",
        statistic=apart.value,
        p=p,
        adjusted=p,
        effects=(apart,),
        assumptions=(INDEPENDENT, check),
        details=details,
        notes=notes,
        sentence=(
            f"Fisher's exact test: {apa.p_value(p)}, {apa.effect(apart)}. {_said(names, table)}."
        ),
    )


def _table(counts: Counts) -> tuple[tuple[str, ...], IntArray]:
    """A row for each group: how many did it, how many did not."""
    if len(counts) < 2:
        raise CannotTest(f"needs at least 2 groups, found {len(counts)}")
    for name, (did, total) in counts.items():
        if not 0 <= did <= total:
            raise CannotTest(f"{did} of {total} in {name} is no proportion")
        if total == 0:
            raise CannotTest(f"there is nobody in {name}")
    table = np.array([(did, total - did) for did, total in counts.values()], dtype=np.int64)
    if not table.sum(axis=0).all():
        who = "none" if table[:, 0].sum() == 0 else "all"
        raise CannotTest(f"{who} of {int(table.sum())} did it: nothing differs")
    return tuple(counts), table


def _freeman_halton(table: IntArray) -> float:
    """The probability of all tables with these margins that are not likelier than this one."""
    totals, did = table.sum(axis=1), int(table[:, 0].sum())
    size = math.prod(int(min(n, did)) + 1 for n in totals[:-1])
    if size > MOST_TABLES:
        raise CannotTest(f"has {size:,} tables to go through, more than {MOST_TABLES:,}")
    ranges = [range(int(min(n, did)) + 1) for n in totals[:-1]]
    heads = np.array(list(product(*ranges)), dtype=np.int64)
    last = did - heads.sum(axis=1)
    usable = (last >= 0) & (last <= totals[-1])
    tables = np.column_stack([heads[usable], last[usable]])
    chances = stats.multivariate_hypergeom.pmf(tables, totals, did)
    own = stats.multivariate_hypergeom.pmf(table[:, 0], totals, did)
    # As R does: chances that differ by rounding alone are equal.
    return min(1.0, float(np.sum(chances, where=chances <= own * (1 + 1e-7))))


def _wilson(did: int, total: int, level: float) -> tuple[float, float]:
    found = stats.binomtest(did, total).proportion_ci(level, method="wilson")
    return float(found.low), float(found.high)


def _groups(names: tuple[str, ...], table: IntArray) -> tuple[Group, ...]:
    """Each group's values are 1 for who did it and 0 for who did not."""
    found: list[Group] = []
    for name, (did, rest) in zip(names, table.tolist(), strict=True):
        n = did + rest
        share = did / n
        sd = math.sqrt(share * (1 - share) * n / (n - 1)) if n > 1 else None
        found.append(Group(name, n, share, sd, float(np.median([1] * did + [0] * rest))))
    return tuple(found)


def _said(names: tuple[str, ...], table: IntArray) -> str:
    pairs = zip(names, table.tolist(), strict=True)
    return ", ".join(f"{did} of {did + rest} in {name}" for name, (did, rest) in pairs)
