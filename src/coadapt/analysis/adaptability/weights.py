"""The distribution of adaptability over given values, whatever its shape, by the EM algorithm.

With weights ``w_j`` of values ``alpha_j`` the likelihood is ``prod_p sum_j w_j L_pj``. Expectation:
the probability of each value for each participant, ``r_pj = w_j L_pj / sum_i w_i L_pi``.
Maximisation: ``w_j`` is the mean of ``r_pj`` over participants. The log likelihood is concave in
``w``, so EM, begun inside, climbs to its maximum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coadapt.analysis.adaptability.intervals import LEVEL, Interval, profile_interval
from coadapt.analysis.kernels.adaptability import em_weights
from coadapt.arrays import FloatArray

TOLERANCE = 1e-10
"""EM stops when no weight changes by more in an iteration."""

MOST_ITERATIONS = 20_000


@dataclass(frozen=True)
class WeightsFit:
    """How many people have each of some values of alpha.

    Attributes:
        values: ``J`` values of alpha.
        weights: of each, with confidence intervals by profile likelihood.
        mean, sd: of alpha under the most likely weights.
        log_likelihood: nats.
    """

    values: tuple[float, ...]
    weights: tuple[Interval, ...]
    mean: float
    sd: float
    log_likelihood: float


def fit_weights(
    log_likelihood: FloatArray, values: Sequence[float], level: float = LEVEL
) -> WeightsFit:
    """The most likely weights of ``values``.

    Args:
        log_likelihood: ``[P, J]`` of each participant's inputs at each value, nats.
        values: ``J`` values of alpha.
        level: of the intervals.
    """
    best = log_likelihood.max(axis=1)
    likelihood = np.exp(log_likelihood - best[:, None])
    count = len(values)
    free = _climb(likelihood, -1, 0.0)
    top = _value(likelihood, free)

    def given(j: int, weight: float) -> float:
        return top if count == 1 else _value(likelihood, _climb(likelihood, j, weight))

    intervals = tuple(
        profile_interval(lambda w, j=j: given(j, w), float(free[j]), top, (0.0, 1.0), level)
        for j in range(count)
    )
    alpha = np.array(values)
    mean = float(free @ alpha)
    return WeightsFit(
        values=tuple(values),
        weights=intervals,
        mean=mean,
        sd=float(np.sqrt(max(free @ (alpha - mean) ** 2, 0.0))),
        log_likelihood=top + float(best.sum()),
    )


def _climb(likelihood: FloatArray, held: int, weight: float) -> FloatArray:
    """The best weights ``[J]``; with ``held >= 0`` the one of that value is ``weight``."""
    count = likelihood.shape[1]
    weights = np.full(count, 1.0 / count)
    if held >= 0:
        weights[:] = (1.0 - weight) / max(count - 1, 1)
        weights[held] = weight
    em_weights(likelihood, held, TOLERANCE, MOST_ITERATIONS, weights)
    return weights


def _value(likelihood: FloatArray, weights: FloatArray) -> float:
    with np.errstate(divide="ignore"):
        return float(np.log(likelihood @ weights).sum())
