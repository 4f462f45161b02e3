"""Everything that recordings say of adaptability, in one result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from coadapt.analysis.adaptability.comparison import MEMORIES, ModelScore, compare_models
from coadapt.analysis.adaptability.evidence import Evidence
from coadapt.analysis.adaptability.intervals import LEVEL, Interval
from coadapt.analysis.adaptability.likelihood import PersonModel, log_likelihoods
from coadapt.analysis.adaptability.population import (
    BetaPopulation,
    fit_population,
    mean_interval,
    sd_interval,
)
from coadapt.analysis.adaptability.posterior import Modes, Posterior, modes_over_time, posterior
from coadapt.analysis.adaptability.recordings import Recordings
from coadapt.analysis.adaptability.weights import WeightsFit, fit_weights
from coadapt.formalism.shared_autonomy import PAPER_ADAPTABILITY

Prior = Literal["uniform", "population"]
"""What is taken for known of a participant before they begin."""


@dataclass(frozen=True, eq=False)
class AdaptabilityFit:
    """What was found.

    Attributes:
        person: what participants were taken for.
        recordings: what they did.
        level: of all intervals.
        prior: of the posteriors.
        population: the most likely beta population.
        mean, sd: of alpha in it, with confidence intervals.
        weights: the population over a few values.
        posterior: of each participant.
        modes: of each participant over time.
        models: how well other models of people do.
    """

    person: PersonModel
    recordings: Recordings
    level: float
    prior: Prior
    population: BetaPopulation
    mean: Interval
    sd: Interval
    weights: WeightsFit
    posterior: Posterior
    modes: Modes
    models: tuple[ModelScore, ...]


def fit_adaptability(
    person: PersonModel,
    recordings: Recordings,
    *,
    prior: Prior = "uniform",
    values: Sequence[float] = PAPER_ADAPTABILITY,
    level: float = LEVEL,
    memories: Sequence[int] = MEMORIES,
) -> AdaptabilityFit:
    """Fit participants and population.

    Args:
        person: what participants are taken for.
        recordings: what they did; at least one participant.
        prior: of the posteriors: every alpha alike, or the population that is fitted.
        values: of alpha, for the population's weights.
        level: of the intervals.
        memories: of the models to compare.

    Raises:
        ValueError: if there are no participants or inputs are impossible.
    """
    if len(recordings) == 0:
        raise ValueError("there are no participants to fit")
    evidence = Evidence.of(person, recordings)
    population = fit_population(evidence)
    before = population.weights(evidence.points) if prior == "population" else None
    known = posterior(evidence, before)
    at_values = log_likelihoods(person, recordings, np.array(values, dtype=np.float64))
    return AdaptabilityFit(
        person=person,
        recordings=recordings,
        level=level,
        prior=prior,
        population=population,
        mean=mean_interval(evidence, population, level),
        sd=sd_interval(evidence, population, level),
        weights=fit_weights(at_values, values, level),
        posterior=known,
        modes=modes_over_time(person, recordings, known),
        models=tuple(compare_models(person, recordings, memories)),
    )
