"""People who are absent-minded for a while."""

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
class Lapsing:
    """A person who lapses: for some steps they neither mind their goal nor see the robot.

    In a lapse every input is as likely as the others, and the robot's actions change nothing about
    their mode. Lapses come and go by a Markov chain.

    Attributes:
        person: the person in all other respects.
        rate: share of the steps spent in lapses, in [0, 1).
        length: mean number of steps that a lapse lasts, at least 1; None if each step is or is not
            a lapse by itself, whatever came before.

    Raises:
        ValueError: if a number is out of its range, or lapses so short cannot fill so many steps.
    """

    person: DescribedPartner
    rate: float
    length: float | None = None

    def __post_init__(self) -> None:
        require_probability("rate of lapses", self.rate)
        begins, ends = self._changes()
        if self.rate == 1 or not (0 <= begins <= 1 and 0 < ends <= 1):
            raise ValueError(
                f"lapses of {self.length} steps on average cannot fill {self.rate:g} of all steps"
            )

    def _changes(self) -> tuple[float, float]:
        """The probabilities that a lapse begins and ends after a step."""
        ends = 1.0 - self.rate if self.length is None else 1.0 / max(self.length, 1e-300)
        return (self.rate * ends / (1.0 - self.rate) if self.rate < 1 else np.inf), ends

    def tables(self, model: Model) -> PartnerTables:
        """The person as arrays: each of their kinds twice, the second time in a lapse."""
        tables = self.person.tables(model)
        ways = len(tables.inputs)
        given = 1.0 - tables.inputs[..., -1:]
        absent = tables.inputs.copy()
        absent[..., :-1] = given / (tables.inputs.shape[-1] - 1)
        begins, ends = self._changes()
        lapse = np.array([[1.0 - begins, begins], [ends, 1.0 - ends]])
        return tables._replace(
            first_kind=np.kron([1.0 - self.rate, self.rate], tables.first_kind),
            inputs=np.concatenate([tables.inputs, absent]),
            uses=np.concatenate([tables.uses, tables.uses + ways]),
            rate=np.concatenate([tables.rate, np.zeros_like(tables.rate)]),
            change=np.kron(lapse, tables.change),
        )
