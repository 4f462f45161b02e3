"""The model against the published study: fitted to a few of its counts, it predicts the rest.

Published (Sec. 7): of 16 participants with mutual adaptation 12 ended at the optimal goal at least
once and 9 in the last of three trials; of 17 with one-way adaptation 2 did at least once. The
participants who are optimal in the last trial are among those who are so at least once, so the 16
fall into three groups of 9, 3 and 4.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coadapt.analysis.adaptability.beta import beta_weights, standard_deviation
from coadapt.analysis.experiment.pool import Pool
from coadapt.analysis.experiment.power import Conditions
from coadapt.analysis.hypotheses import H1Tests, h1_tests
from coadapt.arrays import FloatArray

PARTICIPANTS = {"no_adaptation": 19, "mutual_adaptation": 16, "one_way_adaptation": 17}
"""In each condition. Sec. 6.4 says 51 in all; the published tests need 19 without adaptation."""

MUTUAL_ONCE, MUTUAL_LAST, ONE_WAY_ONCE = 12, 9, 2

RECONSTRUCTED = {
    "mutual_adaptation": (4, 7, 2, 3),
    "one_way_adaptation": (15, 1, 1, 0),
}
"""Participants by their number of optimal trials, 0 to 3: the only table for groups of 19, 16 and
17 that gives the published chi-squared and both U. A reconstruction, not the authors' data."""

CHI2, U_UPPER, U_LOWER = 39.84, 28.5, 49.5
"""Statistics of Sec. 7; a U is the smaller of the two."""

MEANS, SPREADS = 101, 41
"""Size of the grid of populations."""


@dataclass(frozen=True, eq=False)
class PublishedFit:
    """The population that fits the published counts best, and what it predicts.

    Attributes:
        mean, sd: of alpha.
        log_likelihood: of the counts, nats.
        saturated: the largest log likelihood any model could have, nats.
        counts: probabilities of 0 to 3 optimal trials, by condition.
        groups: probabilities of the groups fitted: mutual optimal in the last trial, earlier only,
            never; one-way at least once.
    """

    mean: float
    sd: float
    spread: float
    log_likelihood: float
    saturated: float
    counts: dict[str, FloatArray]
    groups: FloatArray

    @property
    def deviance(self) -> float:
        """Twice the log likelihood that is missing to a perfect fit."""
        return 2.0 * (self.saturated - self.log_likelihood)


def fit_published(mutual: Pool, one_way: Pool) -> PublishedFit:
    """Fit a beta population to the published counts."""
    mean = np.linspace(0, 1, MEANS)[:, None]
    spread = np.linspace(0, 1, SPREADS)[None, :]
    weights = beta_weights(mean, spread, mutual.points)
    with_mutual = np.tensordot(mutual.patterns(), weights, axes=(0, 0))  # [2 ** T, U, R]
    with_one_way = np.tensordot(one_way.patterns(), weights, axes=(0, 0))
    last = np.arange(len(with_mutual)) >= len(with_mutual) // 2
    groups = np.stack(
        [
            with_mutual[last].sum(axis=0),
            with_mutual[1:][~last[1:]].sum(axis=0),
            with_mutual[0],
            1.0 - with_one_way[0],
        ]
    )
    never = PARTICIPANTS["mutual_adaptation"] - MUTUAL_ONCE
    observed = (MUTUAL_LAST, MUTUAL_ONCE - MUTUAL_LAST, never, ONE_WAY_ONCE)
    one_way_never = PARTICIPANTS["one_way_adaptation"] - ONE_WAY_ONCE
    with np.errstate(divide="ignore"):
        value = sum(count * np.log(p) for count, p in zip(observed, groups, strict=True))
        value = value + one_way_never * np.log(1.0 - groups[3])
    i, k = np.unravel_index(int(np.argmax(value)), value.shape)
    best_mean, best_spread = float(mean[i, 0]), float(spread[0, k])
    return PublishedFit(
        mean=best_mean,
        sd=standard_deviation(best_mean, best_spread),
        spread=best_spread,
        log_likelihood=float(value[i, k]),
        saturated=_saturated((*observed[:3],)) + _saturated((ONE_WAY_ONCE, one_way_never)),
        counts={
            "mutual_adaptation": _by_count(with_mutual[:, i, k]),
            "one_way_adaptation": _by_count(with_one_way[:, i, k]),
        },
        groups=groups[:, i, k],
    )


def predict_tests(
    conditions: Conditions, fit: PublishedFit, experiments: int, rng: np.random.Generator
) -> H1Tests:
    """The tests of simulated studies of the published size, with the fitted population."""
    weights = beta_weights(np.array(fit.mean), np.array(fit.spread), conditions.mutual.points)
    drawn = [
        pool.draw(weights, (experiments, PARTICIPANTS[name]), rng).performance
        for name, pool in (
            ("no_adaptation", conditions.no_adaptation),
            ("mutual_adaptation", conditions.mutual),
            ("one_way_adaptation", conditions.one_way),
        )
    ]
    return h1_tests(drawn[0], drawn[1], drawn[2])


def _by_count(patterns: FloatArray) -> FloatArray:
    """``[T + 1]`` probabilities of each number of optimal trials."""
    ones = np.array([pattern.bit_count() for pattern in range(len(patterns))])
    return np.bincount(ones, weights=patterns).astype(np.float64)


def _saturated(counts: tuple[int, ...]) -> float:
    total = sum(counts)
    return float(sum(count * np.log(count / total) for count in counts if count))
