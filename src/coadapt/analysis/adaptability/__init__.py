"""Adaptability from recordings: of each participant, and of the population they come from."""

from coadapt.analysis.adaptability.comparison import ModelScore, compare_models
from coadapt.analysis.adaptability.evidence import Evidence
from coadapt.analysis.adaptability.intervals import Interval
from coadapt.analysis.adaptability.likelihood import PersonModel
from coadapt.analysis.adaptability.population import (
    BetaPopulation,
    fit_population,
    mean_interval,
    sd_interval,
)
from coadapt.analysis.adaptability.posterior import (
    Modes,
    Posterior,
    modes_over_time,
    posterior,
)
from coadapt.analysis.adaptability.recordings import RecordedTrial, Recordings
from coadapt.analysis.adaptability.weights import WeightsFit, fit_weights

__all__ = [
    "BetaPopulation",
    "Evidence",
    "Interval",
    "ModelScore",
    "Modes",
    "PersonModel",
    "Posterior",
    "RecordedTrial",
    "Recordings",
    "WeightsFit",
    "compare_models",
    "fit_population",
    "fit_weights",
    "mean_interval",
    "modes_over_time",
    "posterior",
    "sd_interval",
]
