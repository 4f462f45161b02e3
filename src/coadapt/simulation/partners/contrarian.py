"""People who do the opposite of what the robot seems to do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from coadapt.formalism import Model
from coadapt.simulation.partners.person import DescribedPartner
from coadapt.simulation.partners.tables import PartnerTables
from coadapt.simulation.partners.wandering import another_mode


@final
@dataclass(frozen=True)
class Contrarian:
    """An adversary: who sees the robot head for a goal wants another one.

    Our choice of an adversary. It uses nothing but what a person has: they infer the robot's mode
    as everybody does (Eq. 2), and with probability alpha they answer by a switch, not to that mode
    (Eq. 4) but to one of the others, all alike. They do so even if the mode they leave was their
    own, so the robot cannot please them.

    Attributes:
        person: the person in all other respects; their adaptability says how often they answer.
    """

    person: DescribedPartner

    def tables(self, model: Model) -> PartnerTables:
        """The person as arrays."""
        tables = self.person.tables(model)
        return tables._replace(answer=another_mode(len(tables.first_mode)) @ tables.answer)
