"""People who choose more or less at random than the robot assumes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from coadapt.formalism import Collaboration, Model
from coadapt.simulation.partners.person import DescribedPartner
from coadapt.simulation.partners.tables import PartnerTables, inputs_of


@final
@dataclass(frozen=True)
class Tempered:
    """A person whose inputs are a Boltzmann choice of another temperature.

    A path of ``n`` steps to their goal has probability proportional to ``exp(-c n / T)``, where
    ``c`` is the step cost of the model's modal policies (`coadapt.human.modal`). So ``T`` above 1
    makes detours likelier, and small ``T`` leaves the shortest paths alone. What they take the
    robot's actions for stays as it was.

    Attributes:
        person: the person in all other respects; their inputs are replaced.
        temperature: ``T``, above 0.

    Raises:
        ValueError: if the temperature is out of its range.
    """

    person: DescribedPartner
    temperature: float

    def __post_init__(self) -> None:
        if not 0 < self.temperature < float("inf"):
            raise ValueError(f"temperature must be above 0, not {self.temperature:g}")

    def tables(self, model: Model) -> PartnerTables:
        """The person as arrays.

        Raises:
            ValueError: if the model's inputs do not come from maximum-entropy policies, or the
                sum over all paths is infinite at this temperature.
        """
        tables = self.person.tables(model)
        if isinstance(model, Collaboration):
            given = not model.hidden_modes or model.human_policies is not None
        else:
            given = model.policies is not None or model.human_policies is not None
        if given:
            raise ValueError("the model's inputs have no temperature: its policies are given")
        warm = inputs_of(replace(model, step_cost=model.step_cost / self.temperature))
        return tables._replace(inputs=warm[None].repeat(len(tables.inputs), axis=0))
