"""People who insist for some steps and then give way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from coadapt.formalism import Model
from coadapt.simulation.partners.require import require_probability
from coadapt.simulation.partners.tables import PartnerTables, first_modes, follower

MOST_STEPS = 1000


@final
@dataclass(frozen=True)
class Yielding:
    """A person who is stubborn at first: alpha is one number for some steps, then another.

    Where a person does several trials the steps are counted through all of them.

    Attributes:
        adaptability: alpha after the first steps, in [0, 1].
        steps: number of robot actions before, 0 to `MOST_STEPS`.
        before: alpha until then.
        mode: index of the first mode; drawn from the model's prior if None.

    Raises:
        ValueError: if a number is out of its range.
    """

    adaptability: float
    steps: int
    before: float = 0.0
    mode: int | None = None

    def __post_init__(self) -> None:
        require_probability("adaptability", self.adaptability)
        require_probability("adaptability before", self.before)
        if not 0 <= self.steps <= MOST_STEPS:
            raise ValueError(f"steps must be 0 to {MOST_STEPS}, not {self.steps}")

    def tables(self, model: Model) -> PartnerTables:
        """The person as arrays: a kind for each of the first steps, and one for ever after.

        Raises:
            ValueError: if the model has no such mode.
        """
        alpha = np.full(self.steps + 1, self.before)
        alpha[-1] = self.adaptability
        onwards = np.eye(self.steps + 1, k=1)
        onwards[-1, -1] = 1.0
        rate = np.repeat(alpha[:, None], len(model.world.goals), axis=1)
        return follower(model, rate, first_modes(model, self.mode), change=onwards)
