"""False positives in 5 % of simulated studies, and intervals that hold what is there.

A small version of `benchmarks/likert_studies.py`, which runs thousands.
"""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import likert_studies as likert
from coadapt.analysis.tests import kruskal_wallis, mann_whitney, one_way_anova, welch_anova

STUDIES = 300


def test_false_positives() -> None:
    rng = np.random.default_rng(5)
    hits = dict.fromkeys(("rank", "pair", "mean", "Welch"), 0)
    for _ in range(STUDIES):
        groups = likert.study((0.0, 0.0, 0.0), rng)
        two = {name: groups[name] for name in ("a", "b")}
        hits["rank"] += kruskal_wallis(groups).p < likert.LEVEL
        hits["pair"] += mann_whitney(two).p < likert.LEVEL
        hits["mean"] += one_way_anova(groups).p < likert.LEVEL
        hits["Welch"] += welch_anova(groups).p < likert.LEVEL
    # 5 % of 300 are 15, three standard deviations 11.3.
    assert all(4 <= count <= 26 for count in hits.values()), hits


def test_intervals_hold_the_population_s_effects() -> None:
    rng = np.random.default_rng(6)
    # Of a million participants with these shifts, as `likert_studies.population` finds them.
    true = likert.population(np.random.default_rng(7))
    held = dict.fromkeys(("η², ANOVA", "ε², Kruskal-Wallis", "r of c and a"), 0)
    means: list[float] = []
    runs = 100
    for _ in range(runs):
        groups = likert.study(likert.SHIFTS, rng)
        anova = one_way_anova(groups)
        effects = {
            "η², ANOVA": anova.effects[1],
            "ε², Kruskal-Wallis": kruskal_wallis(groups).effects[0],
            "r of c and a": mann_whitney({name: groups[name] for name in ("c", "a")}).effects[0],
        }
        means.append(anova.effects[1].value)
        for name, effect in effects.items():
            held[name] += effect.low <= true[name] <= effect.high
    # 95 % of 100 are 95; four standard deviations below are 86. The intervals are approximate.
    assert all(count >= 85 for count in held.values()), held
    # ω² estimates the population's share without bias; its error here is some .09 / √100.
    assert np.mean(means) == pytest.approx(true["η², ANOVA"], abs=0.03)
