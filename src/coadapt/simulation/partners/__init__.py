"""Simulated people: one protocol, those who follow the model and those who break it."""

from coadapt.simulation.partners.acting import ActingPartner, acting
from coadapt.simulation.partners.person import (
    NEW_MODE,
    AnyPartner,
    DescribedPartner,
    Partner,
    Person,
)
from coadapt.simulation.partners.simulated import DrawnPartner, SimulatedPartner
from coadapt.simulation.partners.tables import PartnerTables, follower

__all__ = [
    "NEW_MODE",
    "ActingPartner",
    "AnyPartner",
    "DescribedPartner",
    "DrawnPartner",
    "Partner",
    "PartnerTables",
    "Person",
    "SimulatedPartner",
    "acting",
    "follower",
]
