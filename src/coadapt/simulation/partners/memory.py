"""People who remember more or less of the robot than it assumes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from coadapt.formalism import Model
from coadapt.simulation.partners.person import DescribedPartner
from coadapt.simulation.partners.tables import PartnerTables, remembering


@final
@dataclass(frozen=True)
class OwnMemory:
    """A person with a memory of their own: they infer the robot's goal from other steps (Eq. 1-2).

    Attributes:
        person: the person in all other respects.
        memory: ``k`` of the person, at least 1.
    """

    person: DescribedPartner
    memory: int

    def tables(self, model: Model) -> PartnerTables:
        """The person as arrays.

        Raises:
            ValueError: if there are too many windows of so many steps.
        """
        return remembering(self.person.tables(model), replace(model, memory=self.memory))
