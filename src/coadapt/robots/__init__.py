"""Robots: what decides online, one for each condition of Sec. 6.1."""

from coadapt.robots.collaborator import Collaborator
from coadapt.robots.fixed import NoAdaptation
from coadapt.robots.match import NEVER_MATCH, MatchRule
from coadapt.robots.mutual import MutualAdaptation
from coadapt.robots.one_way import OneWayAdaptation
from coadapt.robots.robot import NO_INPUT, Decider, Decision, Decisions, Robot

__all__ = [
    "NEVER_MATCH",
    "NO_INPUT",
    "Collaborator",
    "Decider",
    "Decision",
    "Decisions",
    "MatchRule",
    "MutualAdaptation",
    "NoAdaptation",
    "OneWayAdaptation",
    "Robot",
]
