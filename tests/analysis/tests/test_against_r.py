"""Every number equals R's on 14 data sets, with and without ties, of equal and unequal groups.

R's numbers are in `oracles/statistics.json`, with its version; `oracles/statistics.R` printed them.
Where R's own function is less exact, for the studentised range and the noncentral F, the program
integrates and sums them itself.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from itertools import combinations

import pytest

from coadapt.analysis.scales import cronbach, reliability, spearman_brown
from coadapt.analysis.tests import (
    adjusted,
    cumulative_logit,
    equivalence,
    games_howell,
    kruskal_wallis,
    mann_whitney,
    one_way_anova,
    proportions,
    tukey,
    welch_anova,
)
from coadapt.analysis.tests.result import TestResult
from tests.analysis.oracles.data import HERE, from_r, items, samples

EXACT = {"rel": 1e-8, "abs": 1e-12}

SHAPIRO = {"rel": 2e-8, "abs": 1e-12}
"""Of p of the test by Shapiro and Wilk, in which scipy computes normal quantiles by a shorter
series than R: W differs by 4e-10, and with exact quantiles it is R's to 1e-15."""

DATASETS = sorted(samples())


def same(found: float, key: str) -> None:
    assert found == pytest.approx(from_r()[key][0], **EXACT), key


def check_p(result: TestResult, key: str) -> None:
    assert [c.p for c in result.assumptions if c.method == "Shapiro-Wilk"] == pytest.approx(
        [from_r()[f"{key}/shapiro/{name}"][1] for name in result.names], **SHAPIRO
    )


@pytest.mark.parametrize("name", DATASETS)
def test_all_groups(name: str) -> None:
    groups = samples()[name]
    found = kruskal_wallis(groups)
    same(found.statistic, f"{name}/kruskal/statistic")
    same(found.p, f"{name}/kruskal/p")
    effect = found.effects[0]
    same(effect.value, f"{name}/kruskal/effect")
    same(effect.low, f"{name}/kruskal/low")
    same(effect.high, f"{name}/kruskal/high")

    found = one_way_anova(groups)
    same(found.statistic, f"{name}/anova/statistic")
    same(found.p, f"{name}/anova/p")
    eta, omega = found.effects
    same(eta.value, f"{name}/anova/eta")
    same(omega.value, f"{name}/anova/omega")
    same(eta.low, f"{name}/anova/low")
    same(eta.high, f"{name}/anova/high")
    check_p(found, name)
    levene = found.assumptions[-1]
    assert levene.statistic is not None and levene.p is not None
    same(levene.statistic, f"{name}/levene/statistic")
    same(levene.p, f"{name}/levene/p")

    found = welch_anova(groups)
    same(found.statistic, f"{name}/welch/statistic")
    same(found.p, f"{name}/welch/p")
    same(found.df[1], f"{name}/welch/df2")


@pytest.mark.parametrize("name", DATASETS)
def test_pairs(name: str) -> None:
    groups = samples()[name]
    for result in tukey(groups):
        key = f"{name}/{'/'.join(result.names)}"
        difference, g = result.effects
        same(difference.value, f"{key}/tukey/difference")
        same(difference.low, f"{key}/tukey/low")
        same(difference.high, f"{key}/tukey/high")
        same(result.p, f"{key}/tukey/p")
        same(g.value, f"{key}/g")
        same(g.low, f"{key}/g_low")
        same(g.high, f"{key}/g_high")
    for result in games_howell(groups):
        key = f"{name}/{'/'.join(result.names)}/games_howell"
        same(result.statistic, f"{key}/statistic")
        same(result.df[1], f"{key}/df")
        same(result.p, f"{key}/p")
        same(result.effects[0].low, f"{key}/low")
        same(result.effects[0].high, f"{key}/high")
    values: list[float] = []
    for pair in combinations(groups, 2):
        key, two = f"{name}/{'/'.join(pair)}", {g: groups[g] for g in pair}
        found = mann_whitney(two)
        same(found.details["U1"], f"{key}/mann_whitney/U1")
        same(found.p, f"{key}/mann_whitney/p")
        effect = found.effects[0]
        same(effect.value, f"{key}/mann_whitney/r")
        if f"{key}/mann_whitney/low" in from_r():
            same(effect.low, f"{key}/mann_whitney/low")
            same(effect.high, f"{key}/mann_whitney/high")
        values.append(found.p)
        found = equivalence(two, 0.5)
        same(found.p, f"{key}/tost/p")
        same(found.details["t_low"], f"{key}/tost/t_low")
        same(found.details["t_high"], f"{key}/tost/t_high")
        same(found.effects[0].low, f"{key}/tost/low")
        same(found.effects[0].high, f"{key}/tost/high")
    assert adjusted(values, "holm") == pytest.approx(from_r()[f"{name}/holm"], **EXACT)
    assert adjusted(values, "bonferroni") == pytest.approx(from_r()[f"{name}/bonferroni"], **EXACT)


@pytest.mark.parametrize("name", DATASETS)
def test_proportions(name: str) -> None:
    """How many values lie above 3."""
    groups = samples()[name]
    counts = {g: (sum(v > 3 for v in values), len(values)) for g, values in groups.items()}
    if f"{name}/proportions/p" in from_r():
        found = proportions(counts)
        same(found.statistic, f"{name}/proportions/statistic")
        same(found.p, f"{name}/proportions/p")
        same(found.effects[0].low, f"{name}/proportions/low")
        same(found.effects[0].high, f"{name}/proportions/high")
    for pair in combinations(groups, 2):
        key = f"{name}/{'/'.join(pair)}/fisher"
        if f"{key}/p" in from_r():
            found = proportions({g: counts[g] for g in pair})
            same(found.p, f"{key}/p")
            same(found.effects[0].low, f"{key}/low")
            same(found.effects[0].high, f"{key}/high")


@pytest.mark.parametrize("name", [n for n in DATASETS if f"{n}/logit/statistic" in from_r()])
def test_cumulative_logit(name: str) -> None:
    # MASS::polr, which ends its search at a relative change of 1e-15.
    found = cumulative_logit(samples()[name])
    same(found.statistic, f"{name}/logit/statistic")
    same(found.p, f"{name}/logit/p")


@pytest.mark.parametrize("name", sorted(items()))
def test_scales(name: str) -> None:
    ratings = items()[name]
    alpha = cronbach(ratings)
    same(alpha.value, f"{name}/alpha")
    same(alpha.low, f"{name}/alpha_low")
    same(alpha.high, f"{name}/alpha_high")
    found = reliability(name, [f"i{i}" for i in range(ratings.shape[1])], ratings, 5)
    rest = [item.rest for item in found.items]
    assert rest == pytest.approx(from_r()[f"{name}/item_rest"], **EXACT)
    if ratings.shape[1] == 2:
        brown = spearman_brown(ratings)
        same(brown.value, f"{name}/spearman_brown")
        limits = from_r()[f"{name}/spearman_brown_limits"]
        assert [brown.low, brown.high] == pytest.approx(limits, **EXACT)


@pytest.mark.skipif(shutil.which("Rscript") is None, reason="R is not installed")
def test_r_still_says_so() -> None:
    ran = subprocess.run(
        ["Rscript", str(HERE / "statistics.R")], capture_output=True, text=True, check=False
    )
    if "there is no package called" in ran.stderr:
        pytest.skip("R's package MASS is not installed")
    assert ran.returncode == 0, ran.stderr
    assert json.loads(ran.stdout)["values"] == {
        key: pytest.approx(values, rel=1e-9, abs=1e-12) for key, values in from_r().items()
    }
