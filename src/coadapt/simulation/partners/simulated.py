"""People who follow the adaptation model (Sec. 2.1 and 3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.formalism import Model
from coadapt.human.adaptation import Adaptability
from coadapt.simulation.partners.tables import PartnerTables, first_modes, follower


@final
@dataclass(frozen=True)
class SimulatedPartner:
    """A person who follows the adaptation model, with one adaptability for good.

    Attributes:
        adaptability: alpha, in [0, 1], or one for each goal: the readiness to switch to it.
        mode: index of the first mode; drawn from the model's prior if None.

    Raises:
        ValueError: if adaptability is outside [0, 1].
    """

    adaptability: float | Sequence[float]
    mode: int | None = None

    def __post_init__(self) -> None:
        alpha = np.asarray(self.adaptability, dtype=np.float64)
        if not (alpha.size and np.all(alpha >= 0) and np.all(alpha <= 1)):
            raise ValueError(f"adaptability must lie in [0, 1], not {self.adaptability}")

    def rates(self, goals: int) -> FloatArray:
        """``[M]`` the adaptability towards each of the goals.

        Raises:
            ValueError: if it is given for another number of goals.
        """
        alpha = np.asarray(self.adaptability, dtype=np.float64)
        if alpha.shape not in ((), (goals,)):
            raise ValueError(f"adaptability is given for {alpha.size} goals, expected {goals}")
        return np.broadcast_to(alpha, (goals,))

    def mode_distribution(self, model: Model) -> FloatArray:
        """``[M]`` distribution of the first mode.

        Raises:
            ValueError: if the model has no such mode, or not as many as there are adaptabilities.
        """
        _ = self.rates(len(model.world.goals))
        return first_modes(model, self.mode)

    def tables(self, model: Model) -> PartnerTables:
        """The person as arrays.

        Raises:
            ValueError: as `mode_distribution`.
        """
        first_mode = self.mode_distribution(model)
        return follower(model, self.rates(len(model.world.goals))[None], first_mode)


@final
@dataclass(frozen=True)
class DrawnPartner:
    """A person drawn from a population, whose adaptability may change as they go.

    Each is of one of the kinds of an `Adaptability`, drawn from its prior, and changes by its
    transition ``T_alpha``. So this is also a person whose adaptability drifts, falls as they tire,
    or switches: `Adaptability.drifting`, `Adaptability.tiring`, `Adaptability.switching`.

    Attributes:
        adaptability: the population; the kind of a person is an index in its values.
        mode: index of the first mode; drawn from the model's prior if None.
    """

    adaptability: Adaptability
    mode: int | None = None

    def tables(self, model: Model) -> PartnerTables:
        """The person as arrays.

        Raises:
            ValueError: if the model has no such mode, or not as many as there are adaptabilities.
        """
        alpha = self.adaptability
        return follower(
            model,
            alpha.rates(len(model.world.goals)),
            first_modes(model, self.mode),
            alpha.prior,
            alpha.transition,
        )
