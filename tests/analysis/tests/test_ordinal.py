"""Cumulative logits: the slope of the likelihood, and the distribution p comes from."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from scipy.optimize import approx_fprime

from coadapt.analysis.tests import cumulative_logit
from coadapt.analysis.tests.proportional_odds import ProportionalOdds


@pytest.mark.parametrize("levels", [2, 3, 9])
def test_the_slope_is_that_of_the_likelihood(levels: int) -> None:
    rng = np.random.default_rng(levels)
    scores = np.concatenate([np.arange(levels), rng.integers(0, levels, 60)])
    design = rng.normal(size=(len(scores), 2))
    model = ProportionalOdds(scores, design, distr="logit")
    for _ in range(5):
        at = model.start_params + rng.normal(0, 0.3, len(model.start_params))
        expected = approx_fprime(at, model.loglike, 1e-7)
        assert model.score(at) == pytest.approx(expected, rel=1e-4, abs=1e-4)


def test_p_has_the_longer_tail_of_small_groups() -> None:
    groups = {"a": [1.0, 2, 2, 3, 4], "b": [2.0, 3, 4, 4, 5], "c": [3.0, 3, 4, 5, 5]}
    found = cumulative_logit(groups)
    assert found.p == pytest.approx(float(stats.f.sf(found.statistic / 2, 2, 12)))
    assert found.p > float(stats.chi2.sf(found.statistic, 2))
    assert "by F(2, 12)" in found.sentence
