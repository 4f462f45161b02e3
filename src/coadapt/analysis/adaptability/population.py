"""The distribution of adaptability among people: mean and spread by maximum likelihood.

The likelihood of a population is ``prod_p sum_j w_j(mu, rho) P(inputs of p | alpha_j)``, with the
beta weights of `coadapt.analysis.adaptability.beta`. It is maximised over the whole square of means
and spreads, its edges included, by a grid that closes in on the best cell: no derivative exists at
the edges, where the best population often lies.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from coadapt.analysis.adaptability.beta import beta_weights, standard_deviation
from coadapt.analysis.adaptability.evidence import Evidence
from coadapt.analysis.adaptability.intervals import LEVEL, Interval, profile_interval
from coadapt.arrays import FloatArray

COARSE_MEANS, COARSE_SPREADS = 41, 17
"""Size of the first grid over means and spreads."""

FINE = 9
"""Size of each further grid, along either axis."""

ZOOMS = 3
"""Number of further grids; each is four times as fine as the one before. After three the angle of a
mean (`_part`) is known to 1/2500, far within its standard error with thousands of people."""


@dataclass(frozen=True)
class BetaPopulation:
    """A beta distribution of adaptability.

    Attributes:
        mean: of alpha, in [0, 1].
        spread: in [0, 1], the variance as a part of the largest possible one, ``mean (1 - mean)``.
        log_likelihood: of the recordings it was fitted to, nats.
    """

    mean: float
    spread: float
    log_likelihood: float

    @property
    def sd(self) -> float:
        """Standard deviation of alpha."""
        return standard_deviation(self.mean, self.spread)

    def weights(self, points: int) -> FloatArray:
        """``[J]`` its weights on a grid of alpha."""
        return beta_weights(np.array(self.mean), np.array(self.spread), points)


def fit_population(
    evidence: Evidence, *, mean: float | None = None, spread: float | None = None
) -> BetaPopulation:
    """The most likely beta population.

    Args:
        evidence: what the recordings say.
        mean: hold the mean here, else it is free.
        spread: hold the spread here, else it is free; 0 for people who are all alike.
    """
    u = np.linspace(0, 1, COARSE_MEANS) if mean is None else np.array([_angle(mean)])
    v = np.linspace(0, 1, COARSE_SPREADS) if spread is None else np.array([_angle(spread)])
    weights = None
    if mean is None and spread is None:
        weights = _coarse_weights(evidence.points)
    best = (-np.inf, 0.0, 0.0)
    for zoom in range(ZOOMS + 1):
        if weights is None:
            weights = beta_weights(_part(u)[:, None], _part(v)[None, :], evidence.points)
        values = evidence.of_populations(weights)
        i, k = np.unravel_index(int(values.argmax()), values.shape)
        if zoom == 0 or values[i, k] > best[0]:
            best = (float(values[i, k]), float(u[i]), float(v[k]))
        u, v = (_closer(axis, centre) for axis, centre in ((u, best[1]), (v, best[2])))
        weights = None
    value, at_u, at_v = best
    return BetaPopulation(
        mean=float(_part(at_u)) if mean is None else mean,
        spread=float(_part(at_v)) if spread is None else spread,
        log_likelihood=value,
    )


def fit_given_sd(evidence: Evidence, sd: float) -> BetaPopulation:
    """The most likely beta population with this standard deviation, at most 1/2."""
    if not 0 <= sd <= 0.5:
        raise ValueError(f"a standard deviation in [0, 1] is at most 0.5, not {sd}")
    # mean (1 - mean) >= sd^2
    reach = float(np.sqrt(0.25 - sd**2))
    mean: FloatArray = np.linspace(0.5 - reach, 0.5 + reach, COARSE_MEANS)
    best = (-np.inf, 0.5, 0.0)
    for _ in range(ZOOMS + 1):
        most = mean * (1.0 - mean)
        ratio = np.divide(sd**2, most, out=np.zeros_like(most), where=most > 0)
        spread = np.clip(ratio, 0.0, 1.0)
        values = evidence.of_populations(beta_weights(mean, spread, evidence.points))
        i = int(values.argmax())
        if values[i] > best[0]:
            best = (float(values[i]), float(mean[i]), float(spread[i]))
        step = float(mean[1] - mean[0])
        low, high = max(0.5 - reach, best[1] - step), min(0.5 + reach, best[1] + step)
        mean = np.linspace(low, high, FINE)
    return BetaPopulation(mean=best[1], spread=best[2], log_likelihood=best[0])


def mean_interval(evidence: Evidence, fitted: BetaPopulation, level: float = LEVEL) -> Interval:
    """The confidence interval of the mean adaptability, whatever the spread."""
    return profile_interval(
        lambda mean: fit_population(evidence, mean=mean).log_likelihood,
        fitted.mean,
        fitted.log_likelihood,
        (0.0, 1.0),
        level,
    )


def sd_interval(evidence: Evidence, fitted: BetaPopulation, level: float = LEVEL) -> Interval:
    """The confidence interval of the standard deviation of adaptability, whatever the mean."""
    return profile_interval(
        lambda sd: fit_given_sd(evidence, sd).log_likelihood,
        fitted.sd,
        fitted.log_likelihood,
        (0.0, 0.5),
        level,
    )


def _closer(axis: FloatArray, centre: float) -> FloatArray:
    if len(axis) == 1:
        return axis
    step = axis[1] - axis[0]
    return np.linspace(max(0.0, centre - step), min(1.0, centre + step), FINE)


@lru_cache
def _coarse_weights(points: int) -> FloatArray:
    u, v = np.linspace(0, 1, COARSE_MEANS), np.linspace(0, 1, COARSE_SPREADS)
    return beta_weights(_part(u)[:, None], _part(v)[None, :], points)


def _part(angle: FloatArray | float) -> FloatArray:
    """Even steps of the angle are steps of a proportion as fine as its standard error there."""
    return np.sin(0.5 * np.pi * np.asarray(angle)) ** 2


def _angle(part: float) -> float:
    return float(np.arcsin(np.sqrt(part)) / (0.5 * np.pi))
