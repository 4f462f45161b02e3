"""Models of people against each other: fixed alpha, one alpha, a population; memories of k steps.

"No adaptation" is alpha 0 for everybody, whatever they remember, and "full adaptation" alpha 1.
These two leave nothing to fit. "All alike" is any one alpha, and the population a beta
distribution.

All are judged by the same inputs: the largest log likelihood, AIC and BIC (participants count as
the independent observations), the log of the evidence with uniform priors over the parameters, of
which differences are logs of Bayes factors, and the log likelihood of each participant under the
population fitted to the others (leave one out).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, log

import numpy as np

from coadapt.analysis.adaptability.beta import beta_weights
from coadapt.analysis.adaptability.evidence import Evidence
from coadapt.analysis.adaptability.likelihood import PersonModel
from coadapt.analysis.adaptability.recordings import Recordings
from coadapt.arrays import FloatArray

MEANS, SPREADS = 41, 21
"""Size of the grid over populations that evidence and leave-one-out average over."""

IMPOSSIBLE = -1e9
"""Stands for the log likelihood of what cannot be, where sums are compared."""

MEMORIES = (1, 2, 3)


@dataclass(frozen=True)
class ModelScore:
    """How well a model of people fits.

    Attributes:
        name: of the model.
        memory: ``k``.
        parameters: number of free parameters.
        log_likelihood: the largest, nats.
        aic, bic: smaller is better.
        log_evidence: nats, the parameters averaged over.
        left_out: nats, the sum over participants of the log likelihood under the most likely
            parameters of the others.
    """

    name: str
    memory: int
    parameters: int
    log_likelihood: float
    aic: float
    bic: float
    log_evidence: float
    left_out: float


def compare_models(
    person: PersonModel, recordings: Recordings, memories: Sequence[int] = MEMORIES
) -> list[ModelScore]:
    """Every model with every memory; those who never adapt need no memory but one."""
    scores: list[ModelScore] = []
    for memory in memories:
        model = replace(person.model, memory=memory)
        evidence = Evidence.of(replace(person, model=model), recordings)
        if not scores:
            scores.append(_score("no adaptation", memory, 0, evidence, np.array([0.0]), None))
        scores.append(_score("full adaptation", memory, 0, evidence, np.array([1.0]), None))
        scores.append(_score("all alike", memory, 1, evidence, np.linspace(0, 1, 201), None))
        mean, spread = np.linspace(0, 1, MEANS), np.linspace(0, 1, SPREADS)
        scores.append(_score("beta population", memory, 2, evidence, mean, spread))
    return scores


def _score(
    name: str,
    memory: int,
    parameters: int,
    evidence: Evidence,
    mean: FloatArray,
    spread: FloatArray | None,
) -> ModelScore:
    if spread is None:
        weights = beta_weights(mean, np.zeros(()), evidence.points)
    else:
        weights = beta_weights(mean[:, None], spread[None, :], evidence.points)
        weights = weights.reshape(len(weights), -1)
    each = evidence.by_participant(weights)  # [P, K]
    total = each.sum(axis=0)
    best = float(total.max())
    averaging = _trapezoid(mean)
    if spread is not None:
        averaging = np.outer(averaging, _trapezoid(spread)).ravel()
    mean_ratio = float(np.exp(total - best) @ averaging) if best > -inf else 0.0
    possible = np.maximum(each, IMPOSSIBLE)
    others = (possible.sum(axis=0) - possible).argmax(axis=1)
    return ModelScore(
        name=name,
        memory=memory,
        parameters=parameters,
        log_likelihood=best,
        aic=2 * parameters - 2 * best,
        bic=parameters * log(len(evidence)) - 2 * best,
        log_evidence=best + log(mean_ratio) if mean_ratio > 0 else -inf,
        left_out=float(np.take_along_axis(each, others[:, None], axis=1).sum()),
    )


def _trapezoid(grid: FloatArray) -> FloatArray:
    """Weights that average over an even grid, ends half."""
    weights = np.ones(len(grid))
    if len(grid) > 1:
        weights[[0, -1]] = 0.5
    return weights / weights.sum()
