"""Populations whose adaptability has a beta distribution, from a point to the two extremes.

A population is known by its mean ``mu`` and its *spread* ``rho`` in [0, 1], the part of the largest
possible variance that it has:

    Var(alpha) = rho * mu * (1 - mu),        alpha ~ Beta(mu k, (1 - mu) k),   k = (1 - rho) / rho.

With ``rho = 0`` everybody is alike; with ``rho = 1`` the share ``mu`` has alpha 1 and the others 0.

A likelihood known at the points of a grid is interpolated between them. So a distribution is a
vector of weights on the grid: the integrals of its hat functions, which keep its mean.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from coadapt.arrays import FloatArray

GRID_POINTS = 101
"""Values of alpha at which likelihoods are evaluated."""

SMALLEST_SPREAD = 1e-7
"""Below it everybody is taken to be alike: a beta distribution so narrow is a point on any grid."""


@lru_cache
def alpha_grid(points: int = GRID_POINTS) -> FloatArray:
    """``[J]`` values of alpha from 0 to 1, ``sin(pi j / (2 J - 2))^2``: closer at the ends.

    There an alpha is known best: its standard error is smallest.
    """
    grid = np.sin(np.linspace(0.0, 0.5 * np.pi, points)) ** 2
    grid.setflags(write=False)
    return grid


def beta_weights(mean: FloatArray, spread: FloatArray, points: int = GRID_POINTS) -> FloatArray:
    """``[J, ...]`` the weights of beta populations on `alpha_grid`; each sums to 1.

    Args:
        mean: ``[...]`` in [0, 1].
        spread: ``[...]`` in [0, 1], of a shape that broadcasts with that of ``mean``.
        points: ``J``.

    Raises:
        ValueError: if a mean or spread is outside [0, 1].
    """
    # Imported now: only who fits need wait for it.
    from scipy.special import betainc  # noqa: PLC0415

    mean, spread = np.broadcast_arrays(
        np.asarray(mean, dtype=np.float64), np.asarray(spread, dtype=np.float64)
    )
    if not (np.all((mean >= 0) & (mean <= 1)) and np.all((spread >= 0) & (spread <= 1))):
        raise ValueError("the mean and spread of a population must lie in [0, 1]")
    grid = alpha_grid(points).reshape(-1, *(1,) * mean.ndim)
    step = np.diff(grid, axis=0)
    # A degenerate distribution would have a parameter of 0; its weights follow below.
    is_point = (spread < SMALLEST_SPREAD) | (mean == 0) | (mean == 1)
    is_extreme = ~is_point & (spread == 1)
    m = np.where(is_point | is_extreme, 0.5, mean)
    k = (1.0 - np.where(is_point | is_extreme, 0.5, spread)) / np.where(
        is_point | is_extreme, 0.5, spread
    )
    # Mass and first moment of every cell of the grid.
    mass = np.diff(betainc(m * k, (1 - m) * k, grid), axis=0)
    moment = m * np.diff(betainc(m * k + 1, (1 - m) * k, grid), axis=0)
    weights = np.zeros((points, *mean.shape))
    weights[:-1] += (grid[1:] * mass - moment) / step
    weights[1:] += (moment - grid[:-1] * mass) / step
    weights = np.where(is_point, _hats(mean, points), np.maximum(weights, 0.0))
    ends = np.zeros_like(weights)
    ends[0], ends[-1] = 1.0 - mean, mean
    weights = np.where(is_extreme, ends, weights)
    return weights / weights.sum(axis=0)


def _hats(value: FloatArray, points: int) -> FloatArray:
    """``[J, ...]`` the hat functions at ``value`` ``[...]``: weights of a single alpha."""
    grid = alpha_grid(points)
    cell = np.clip(np.searchsorted(grid, value, side="right") - 1, 0, points - 2)
    part = (value - grid[cell]) / (grid[cell + 1] - grid[cell])
    index = np.arange(points).reshape(-1, *(1,) * value.ndim)
    return np.where(index == cell, 1.0 - part, 0.0) + np.where(index == cell + 1, part, 0.0)


def draw_beta(mean: float, spread: float, count: int, rng: np.random.Generator) -> FloatArray:
    """``[count]`` draws from a beta population; none of ``rng`` where everybody is alike."""
    if spread == 0 or mean in (0.0, 1.0):
        return np.full(count, mean)
    if spread == 1:
        return (rng.random(count) < mean).astype(np.float64)
    k = (1.0 - spread) / spread
    return rng.beta(mean * k, (1.0 - mean) * k, count)


def standard_deviation(mean: float, spread: float) -> float:
    """The standard deviation of alpha in a beta population."""
    return float(np.sqrt(spread * mean * (1.0 - mean)))


def spread_of(mean: float, sd: float) -> float:
    """The spread of a population with this mean and standard deviation.

    Raises:
        ValueError: if no distribution over [0, 1] has them.
    """
    most = np.sqrt(mean * (1.0 - mean)) if 0 <= mean <= 1 else -1.0
    if not 0 <= sd <= most + 1e-12:
        raise ValueError(
            f"no population in [0, 1] has mean {mean:g} and standard deviation {sd:g}; "
            "it is at most sqrt(mean (1 - mean))"
        )
    return float(min(1.0, (sd / most) ** 2)) if most > 0 else 0.0
