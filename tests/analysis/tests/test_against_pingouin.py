"""The same numbers by pingouin, which is installed for development alone."""

from __future__ import annotations

from importlib.util import find_spec
from itertools import combinations
from typing import Any

import pytest

from coadapt.analysis.scales import cronbach
from coadapt.analysis.tests import (
    equivalence,
    games_howell,
    kruskal_wallis,
    mann_whitney,
    one_way_anova,
    tukey,
    welch_anova,
)
from tests.analysis.oracles.data import items, samples

EXACT = {"rel": 1e-8, "abs": 1e-12}

pytestmark = [
    pytest.mark.filterwarnings("ignore"),  # of pingouin's own
    pytest.mark.skipif(find_spec("pingouin") is None, reason="pingouin is not installed"),
]


@pytest.fixture(scope="module")
def pg() -> Any:
    """pingouin: only these tests need wait for it."""
    import pingouin

    return pingouin


@pytest.fixture(scope="module")
def pd() -> Any:
    import pandas

    return pandas


def column(table: Any, *names: str) -> float:
    """A cell of the first row; the columns were renamed from one version to the next."""
    name = next(n for n in names if n in table.columns)
    return float(table[name].iloc[0])


@pytest.mark.parametrize("name", sorted(samples()))
def test_all_groups(name: str, pg: Any, pd: Any) -> None:
    groups = samples()[name]
    rows = [(g, v) for g, values in groups.items() for v in values]
    table = pd.DataFrame(rows, columns=["group", "value"])
    ours, theirs = kruskal_wallis(groups), pg.kruskal(table, dv="value", between="group")
    assert ours.statistic == pytest.approx(column(theirs, "H"), **EXACT)
    assert ours.p == pytest.approx(column(theirs, "p_unc", "p-unc"), **EXACT)
    ours, theirs = one_way_anova(groups), pg.anova(table, dv="value", between="group")
    assert ours.statistic == pytest.approx(column(theirs, "F"), **EXACT)
    assert ours.p == pytest.approx(column(theirs, "p_unc", "p-unc"), **EXACT)
    assert ours.effects[0].value == pytest.approx(column(theirs, "np2"), **EXACT)
    ours, theirs = welch_anova(groups), pg.welch_anova(table, dv="value", between="group")
    assert ours.statistic == pytest.approx(column(theirs, "F"), **EXACT)
    assert ours.df[1] == pytest.approx(column(theirs, "ddof2"), **EXACT)
    assert ours.p == pytest.approx(column(theirs, "p_unc", "p-unc"), **EXACT)


@pytest.mark.parametrize("name", sorted(samples()))
def test_pairs(name: str, pg: Any) -> None:
    groups = samples()[name]
    for pair in combinations(groups, 2):
        x, y = (groups[g] for g in pair)
        ours = mann_whitney(dict(zip(pair, (x, y), strict=True)))
        method = "exact" if "exact" in ours.notes[0] else "asymptotic"
        theirs = pg.mwu(x, y, method=method)
        assert ours.details["U1"] == pytest.approx(column(theirs, "U_val", "U-val"), **EXACT)
        assert ours.p == pytest.approx(column(theirs, "p_val", "p-val"), **EXACT)
        assert abs(ours.effects[0].value) == pytest.approx(abs(column(theirs, "RBC")), **EXACT)
        ours = equivalence(dict(zip(pair, (x, y), strict=True)), 0.5)
        theirs = pg.tost(x, y, bound=0.5, correction=True)
        assert ours.p == pytest.approx(column(theirs, "p_val", "pval"), **EXACT)


@pytest.mark.parametrize("name", sorted(samples()))
def test_families(name: str, pg: Any, pd: Any) -> None:
    groups = samples()[name]
    rows = [(g, v) for g, values in groups.items() for v in values]
    table = pd.DataFrame(rows, columns=["group", "value"])
    for ours, theirs in (
        (tukey(groups), pg.pairwise_tukey(table, dv="value", between="group")),
        (games_howell(groups), pg.pairwise_gameshowell(table, dv="value", between="group")),
    ):
        for i, result in enumerate(ours):
            row = theirs.iloc[[i]]
            assert (row["A"].iloc[0], row["B"].iloc[0]) == result.names
            difference, g = result.effects
            assert difference.value == pytest.approx(column(row, "diff"), **EXACT)
            assert result.p == pytest.approx(column(row, "p_tukey", "p-tukey", "pval"), **EXACT)
            assert g.value == pytest.approx(column(row, "hedges"), **EXACT)


@pytest.mark.parametrize("name", sorted(items()))
def test_alpha(name: str, pg: Any, pd: Any) -> None:
    ratings = items()[name]
    alpha, (low, high) = pg.cronbach_alpha(pd.DataFrame(ratings))
    ours = cronbach(ratings)
    assert ours.value == pytest.approx(alpha, **EXACT)
    # pingouin rounds its interval to three decimals.
    assert (round(ours.low, 3), round(ours.high, 3)) == (low, high)
