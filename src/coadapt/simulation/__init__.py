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

__all__ = [
    "UNKNOWN_MODE",
    "AnyPartner",
    "Batch",
    "DescribedPartner",
    "DrawnPartner",
    "Episode",
    "Evaluation",
    "Partner",
    "PartnerTables",
    "Person",
    "SimulatedPartner",
    "Trial",
    "Trials",
    "Visits",
    "evaluate",
    "evaluate_all",
    "expand",
    "simulate",
    "simulate_batch",
]
