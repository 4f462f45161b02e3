"""People who change their goal for reasons of their own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from coadapt.formalism import Model
from coadapt.simulation.partners.person import DescribedPartner
from coadapt.simulation.partners.require import require_probability
from coadapt.simulation.partners.tables import PartnerTables


@final
@dataclass(frozen=True)
class Wandering:
    """A person who now and then wants another goal, whatever the robot does.

    Attributes:
        person: the person in all other respects.
        rate: probability after each step of a change to one of the other goals, all alike, in
            [0, 1].

    Raises:
        ValueError: if the rate is out of its range.
    """

    person: DescribedPartner
    rate: float

    def __post_init__(self) -> None:
        require_probability("rate of changes of goal", self.rate)

    def tables(self, model: Model) -> PartnerTables:
        """The person as arrays."""
        tables = self.person.tables(model)
        modes = len(tables.first_mode)
        wander = (1.0 - self.rate) * np.eye(modes) + self.rate * another_mode(modes)
        return tables._replace(wander=tables.wander @ wander)


def another_mode(modes: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """``[M, M]`` each of the other modes alike; the same one where there is no other."""
    if modes == 1:
        return np.ones((1, 1))
    return (1.0 - np.eye(modes)) / (modes - 1)
