"""Simulated people, episodes and their evaluation."""

from coadapt.simulation.episode import UNKNOWN_MODE, Episode, Trial, Trials
from coadapt.simulation.evaluation import Evaluation, Visits, evaluate, evaluate_all, expand
from coadapt.simulation.partner import Partner, SimulatedPartner
from coadapt.simulation.simulate import simulate

__all__ = [
    "UNKNOWN_MODE",
    "Episode",
    "Evaluation",
    "Partner",
    "SimulatedPartner",
    "Trial",
    "Trials",
    "Visits",
    "evaluate",
    "evaluate_all",
    "expand",
    "simulate",
]
