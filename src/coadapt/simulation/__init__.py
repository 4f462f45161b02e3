"""Simulated people, episodes and their evaluation."""

from coadapt.simulation.batch import Batch, simulate_batch
from coadapt.simulation.episode import UNKNOWN_MODE, Episode, Trial, Trials
from coadapt.simulation.evaluation import Evaluation, Visits, evaluate, evaluate_all, expand
from coadapt.simulation.partners import (
    AnyPartner,
    DescribedPartner,
    DrawnPartner,
    Partner,
    PartnerTables,
    Person,
    SimulatedPartner,
)
from coadapt.simulation.simulate import simulate
from coadapt.simulation.summary import Mean, Summary, summarize

__all__ = [
    "UNKNOWN_MODE",
    "AnyPartner",
    "Batch",
    "DescribedPartner",
    "DrawnPartner",
    "Episode",
    "Evaluation",
    "Mean",
    "Partner",
    "PartnerTables",
    "Person",
    "SimulatedPartner",
    "Summary",
    "Trial",
    "Trials",
    "Visits",
    "evaluate",
    "evaluate_all",
    "expand",
    "simulate",
    "simulate_batch",
    "summarize",
]
