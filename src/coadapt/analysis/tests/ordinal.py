"""Whether a finding on Likert scores stands without points that are equally far apart.

Cumulative logits (McCullagh 1980) use the order of the scores alone:

    log P(score ≤ j) / P(score > j) = θ_j - β_group

The groups are compared by the likelihood ratio χ² of the models with and without β. Its
distribution is that of χ² in large samples only. In groups of 17, with many different scores, it is
too large in 5.8 % of the studies without a difference, not in 5 %; so χ² / (k - 1) is compared with
F(k - 1, N - k) for ``k`` groups with ``N`` values, which tends to the same and has the longer tail.
"""

# statsmodels and pandas have no types.
# pyright: reportMissingTypeStubs=false, reportUnknownMemberType=false
# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence

import numpy as np
from scipy import stats

from coadapt.analysis.tests import apa
from coadapt.analysis.tests.assumptions import INDEPENDENT
from coadapt.analysis.tests.result import LEVEL, Check, Effect, TestResult
from coadapt.analysis.tests.samples import CannotTest, Samples

LARGEST_LOG_ODDS = 12.0
"""A log odds ratio beyond this means that the groups do not overlap: there is no best fit."""

STEEPEST = 1e-3
"""Slope of the log likelihood at its maximum, as found."""


def cumulative_logit(values: Mapping[str, Sequence[float]]) -> TestResult:
    """Whether the groups differ in an ordinal outcome, by cumulative logits.

    The effects are the odds ratios of higher scores of each group against the first.

    Args:
        values: by its name, each group. Only the order of the values counts.

    Raises:
        CannotTest: if all values are the same, there are too few, the groups do not overlap so that
            no odds ratio is best, or statsmodels is not installed.
    """
    samples = Samples(values)
    samples.require_spread()
    levels, ranks = np.unique(samples.pooled, return_inverse=True)
    n, k = samples.total, len(samples.names)
    if n <= len(levels) + k - 2:
        raise CannotTest(f"needs more values than {len(levels) + k - 2} parameters, found {n}")
    design = np.zeros((n, k - 1))
    begin = np.cumsum([0, *(len(array) for array in samples.arrays)])
    for j in range(1, k):
        design[begin[j] : begin[j + 1], j - 1] = 1.0
    slopes, errors, fitted = _fit(ranks, design)
    _, counts = np.unique(ranks, return_counts=True)
    without = float((counts * np.log(counts / n)).sum())
    statistic, df = max(0.0, 2 * (fitted - without)), k - 1
    # Not the χ² distribution, see above.
    p = float(stats.f.sf(statistic / df, df, n - k))
    z = float(stats.norm.isf((1 - LEVEL) / 2))
    effects = tuple(
        Effect(
            name=f"odds ratio, {name} to {samples.names[0]}",
            value=math.exp(b),
            low=math.exp(b - z * s),
            high=math.exp(b + z * s),
            method="Wald",
        )
        for name, b, s in zip(samples.names[1:], slopes, errors, strict=True)
    )
    return TestResult(
        test="cumulative logit",
        groups=samples.groups,
        symbol="χ²",
        statistic=statistic,
        df=(float(df),),
        p=p,
        adjusted=p,
        effects=effects,
        assumptions=(
            INDEPENDENT,
            Check(
                assumption="proportional odds",
                method="not tested: groups this small would not show it",
                note="β is the same at every threshold",
            ),
        ),
        details={"log_likelihood": fitted, "log_likelihood_without": without},
        sentence=(
            f"Cumulative logits, likelihood ratio: χ²({df}, N = {n}) = {apa.number(statistic)}, "
            f"{apa.p_value(p)} by F({df}, {n - k}); {'; '.join(map(apa.effect, effects))}."
        ),
    )


def _fit(ranks: np.ndarray, design: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Slopes, their standard errors, and the log likelihood."""
    try:
        # Imported now: it takes a second, and who has no statsmodels can do all else.
        from coadapt.analysis.tests.proportional_odds import ProportionalOdds  # noqa: PLC0415
    except ImportError:
        raise CannotTest("statsmodels is not installed: pip install 'coadapt[study]'") from None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what matters of them is looked at below
        model = ProportionalOdds(ranks, design, distr="logit")
        found = model.fit(method="bfgs", gtol=1e-6, maxiter=500, disp=False)
        slope = np.abs(np.asarray(model.score(found.params))).max()
        slopes = np.asarray(found.params)[: design.shape[1]]
        errors = np.asarray(found.bse)[: design.shape[1]]
    usable = np.isfinite(slopes).all() and np.isfinite(errors).all() and np.isfinite(found.llf)
    if not usable or slope > STEEPEST or np.abs(slopes).max() > LARGEST_LOG_ODDS:
        raise CannotTest("the groups do not overlap: no odds ratio fits best")
    return slopes, errors, float(found.llf)
