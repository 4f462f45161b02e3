"""Simulated participants, who take part through the same pages as real ones."""

from coadapt.study.pilot.person import Person, Population
from coadapt.study.pilot.pilot import Outcome, Piloted, pilot
from coadapt.study.pilot.server import own_server

__all__ = ["Outcome", "Person", "Piloted", "Population", "own_server", "pilot"]
