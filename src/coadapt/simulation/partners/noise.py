"""People whose hand slips."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from coadapt.formalism import Model
from coadapt.simulation.partners.person import DescribedPartner
from coadapt.simulation.partners.require import require_probability
from coadapt.simulation.partners.tables import PartnerTables


@final
@dataclass(frozen=True)
class Noisy:
    """A person who now and then gives another input than they mean to.

    With probability ``rate`` the input is one of the others, all alike. A slip is no input where
    there was to be one, nor the other way round.

    Attributes:
        person: the person in all other respects.
        rate: probability of a slip in each step, in [0, 1].

    Raises:
        ValueError: if the rate is out of its range.
    """

    person: DescribedPartner
    rate: float

    def __post_init__(self) -> None:
        require_probability("rate of slips", self.rate)

    def tables(self, model: Model) -> PartnerTables:
        """The person as arrays."""
        tables = self.person.tables(model)
        inputs = tables.inputs.copy()
        meant = inputs[..., :-1].copy()
        others: int = meant.shape[-1] - 1
        if others > 0:
            slipped = (meant.sum(axis=-1, keepdims=True) - meant) / others
            inputs[..., :-1] = (1.0 - self.rate) * meant + self.rate * slipped
        return tables._replace(inputs=inputs)
