"""Modal policies from demonstrations: which cost makes the paths that people took likeliest.

The likelihood is that of `coadapt.human.path_likelihood` (Ziebart, Maas, Bagnell, Dey 2008), over
weights ``theta >= 0``. It is concave, and its maximum is found by Newton's method: each step goes
to the maximum of the quadratic model, and is halved until the likelihood rises.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.human.path_likelihood import Demonstration, LikelihoodAt, PathLikelihood

TOLERANCE = 1e-10
"""The search ends when the likelihood cannot rise by more than this, in nats."""

LEAST_INFORMATION = 1e-8
"""A direction in which the information is below this is one that no demonstration bounds."""

MOST_STEPS = 200
"""Newton steps; on a likelihood with a maximum ten or so are enough."""

MOST_HALVINGS = 40

LARGEST_SCORE = 1e-4
"""Squared gradient by information: 0 at a maximum, and not where the search was stopped."""

BOUNDARY = (
    "the likeliest cost lies where the sum over all paths becomes infinite or a step costs "
    "nothing: the demonstrations are longer than any cost of these features explains"
)


@dataclass(frozen=True, eq=False)
class CostFit:
    """The weights under which the demonstrations are likeliest.

    Attributes:
        weights: ``[K]`` estimate of ``theta``, in nats per unit of each feature.
        covariance: ``[K, K]`` of the estimate, the inverse of minus the Hessian; NaN in the rows
            and columns of weights that are 0, at the end of their range.
        log_likelihood: of all demonstrations, in nats.
        observed: ``[K]`` features summed along all demonstrations.
        expected: ``[K]`` what the fitted model expects them to be; the same, but for weights of 0.
        demonstrations: their number.
    """

    weights: FloatArray
    covariance: FloatArray
    log_likelihood: float
    observed: FloatArray
    expected: FloatArray
    demonstrations: int

    @property
    def standard_errors(self) -> FloatArray:
        """``[K]`` of the weights; NaN where a weight is 0."""
        return np.sqrt(np.diag(self.covariance))

    def step_costs(self, features: FloatArray) -> FloatArray:
        """``[X, A]`` the cost of each step, ``theta . f(x, a)``, for `maximum_entropy_policy`.

        Args:
            features: ``[X, A, K]``.
        """
        return features @ self.weights


def fit_step_cost(
    moves: IntArray, goals: Sequence[Sequence[int]], demonstrations: Sequence[Demonstration]
) -> CostFit:
    """The step cost ``c`` under which the demonstrations are likeliest: one weight, in nats.

    Args, raises:
        As `fit_cost`.
    """
    return fit_cost(moves, goals, demonstrations, np.ones((*moves.shape, 1)))


def fit_cost(
    moves: IntArray,
    goals: Sequence[Sequence[int]],
    demonstrations: Sequence[Demonstration],
    features: FloatArray,
) -> CostFit:
    """The feature weights under which the demonstrations are likeliest.

    Args:
        moves: ``[X, A]`` the state each action leads to.
        goals: the states of each goal. They end a path.
        demonstrations: at least one, in any order and to any goals.
        features: ``[X, A, K]`` of each step.

    Raises:
        ValueError: if a demonstration is no path to its goal, if the demonstrations cannot tell the
            features apart or are explained ever better by larger weights (as paths all of which are
            shortest ones), or if the search ends where the sum over all paths becomes infinite.
    """
    return _maximise(PathLikelihood.of(moves, goals, demonstrations, features))


def _maximise(likelihood: PathLikelihood) -> CostFit:
    point = _first_point(likelihood)
    if np.linalg.eigvalsh(point.information)[0] <= 1e-10 * np.trace(point.information):
        raise ValueError(
            "the demonstrations cannot tell the features apart: some weighted sum of them is the "
            "same along every path"
        )
    for _ in range(MOST_STEPS):
        if _least_information(point) < LEAST_INFORMATION:
            raise ValueError(
                "the demonstrations have no likeliest cost: the larger the weights the better, "
                "as where every path is a shortest one; add paths with detours, or set the cost"
            )
        step = _newton_point(point) - point.weights
        promise = float(point.gradient @ step)
        if promise <= TOLERANCE:
            if _score(point) > LARGEST_SCORE:
                raise ValueError(BOUNDARY)
            return _result(likelihood, point)
        point = _better_point(likelihood, point, step, promise)
    raise ValueError(f"the fit did not settle in {MOST_STEPS} steps")


def _first_point(likelihood: PathLikelihood) -> LikelihoodAt:
    """Weights, all the same, for which the sum over all paths is finite."""
    weights = np.ones(likelihood.features.shape[2])
    for _ in range(12):
        point = likelihood.at(weights)
        if point is not None:
            return point
        weights = 2 * weights
    raise ValueError(
        "found no weights for which the sum over all paths is finite: the features make some steps "
        "cost too little"
    )


def _free(point: LikelihoodAt) -> BoolArray:
    """``[K]`` weights that are not held at 0."""
    return (point.weights > 0) | (point.gradient > 0)


def _least_information(point: LikelihoodAt) -> float:
    free = _free(point)
    inside = point.information[np.ix_(free, free)]
    return float(np.linalg.eigvalsh(inside)[0]) if free.any() else np.inf


def _score(point: LikelihoodAt) -> float:
    """``gradient . information^-1 gradient`` of the weights that are not held at 0."""
    free = _free(point)
    slope = point.gradient[free]
    return float(slope @ np.linalg.solve(point.information[np.ix_(free, free)], slope))


def _newton_point(point: LikelihoodAt) -> FloatArray:
    """Where the quadratic model of the likelihood is largest among weights of at least 0."""
    # With information L L^T the model is -|L^T theta - b|^2 / 2.
    ridge = 1e-14 * np.trace(point.information) * np.eye(len(point.weights))
    root = _root(point.information + ridge)
    target = root.T @ point.weights + np.linalg.solve(root, point.gradient)
    # Imported now: only who learns from demonstrations need wait for it.
    from scipy.optimize import nnls  # noqa: PLC0415

    return np.asarray(nnls(root.T, target)[0])


def _root(matrix: FloatArray) -> FloatArray:
    """The lower triangular ``L`` with ``L L^T = matrix``."""
    return np.asarray(np.linalg.cholesky(matrix), dtype=np.float64)  # pyright: ignore


def _better_point(
    likelihood: PathLikelihood, point: LikelihoodAt, step: FloatArray, promise: float
) -> LikelihoodAt:
    share = 1.0
    for _ in range(MOST_HALVINGS):
        new = likelihood.at(point.weights + share * step)
        if new is not None and (
            new.log_likelihood >= point.log_likelihood + 1e-4 * share * promise - 1e-12
        ):
            return new
        share /= 2
    raise ValueError(BOUNDARY)


def _result(likelihood: PathLikelihood, point: LikelihoodAt) -> CostFit:
    free = point.weights > 0
    covariance = np.full_like(point.information, np.nan)
    covariance[np.ix_(free, free)] = np.linalg.inv(point.information[np.ix_(free, free)])
    scale = likelihood.scale
    return CostFit(
        weights=point.weights / scale,
        covariance=covariance / np.outer(scale, scale),
        log_likelihood=point.log_likelihood,
        observed=likelihood.observed * scale,
        expected=(likelihood.observed + point.gradient) * scale,
        demonstrations=int(likelihood.starts.sum()),
    )
