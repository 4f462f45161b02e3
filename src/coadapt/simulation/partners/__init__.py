"""Simulated people: one protocol, those who follow the model and those who break it."""

from coadapt.simulation.partners.acting import ActingPartner, acting
from coadapt.simulation.partners.contrarian import Contrarian
from coadapt.simulation.partners.drift import drifting, tiring
from coadapt.simulation.partners.lapse import Lapsing
from coadapt.simulation.partners.memory import OwnMemory
from coadapt.simulation.partners.noise import Noisy
from coadapt.simulation.partners.person import (
    NEW_MODE,
    AnyPartner,
    DescribedPartner,
    Partner,
    Person,
)
from coadapt.simulation.partners.registry import KINDS, PartnerError, partner_from
from coadapt.simulation.partners.simulated import DrawnPartner, SimulatedPartner
from coadapt.simulation.partners.tables import PartnerTables, follower
from coadapt.simulation.partners.temperature import Tempered
from coadapt.simulation.partners.wandering import Wandering
from coadapt.simulation.partners.yielding import Yielding

__all__ = [
    "KINDS",
    "NEW_MODE",
    "ActingPartner",
    "AnyPartner",
    "Contrarian",
    "DescribedPartner",
    "DrawnPartner",
    "Lapsing",
    "Noisy",
    "OwnMemory",
    "Partner",
    "PartnerError",
    "PartnerTables",
    "Person",
    "SimulatedPartner",
    "Tempered",
    "Wandering",
    "Yielding",
    "acting",
    "drifting",
    "follower",
    "partner_from",
    "tiring",
]
