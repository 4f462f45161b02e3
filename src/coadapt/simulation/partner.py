"""Simulated people."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.formalism import Model


class Partner(Protocol):
    """Somebody who steers: a simulated person, or a program that stands in for a real one.

    A partner is a description; what changes during an episode is its mode, which the episode
    loop holds. `mode` is the index of the goal it is heading for.
    """

    def first_mode(self, model: Model, rng: np.random.Generator) -> int:
        """The mode at the start of an episode."""
        ...

    def act(self, model: Model, state: int, mode: int, rng: np.random.Generator) -> int | None:
        """The input in robot state ``state``, or None for no input."""
        ...

    def next_mode(
        self, model: Model, window: int, mode: int, action: int, rng: np.random.Generator
    ) -> int:
        """The mode after the robot took ``action``, with the last steps in ``model.windows``."""
        ...


@dataclass(frozen=True)
class SimulatedPartner:
    """A person who follows the adaptation model (Sec. 2.1 and 3).

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
        modes = len(model.world.goals)
        _ = self.rates(modes)
        if self.mode is None:
            return model.prior.sum(axis=0)
        if not 0 <= self.mode < modes:
            raise ValueError(f"mode {self.mode} is not one of 0 to {modes - 1}")
        return np.eye(modes)[self.mode]

    def first_mode(self, model: Model, rng: np.random.Generator) -> int:
        """The given mode, or a draw from the model's prior."""
        return draw(self.mode_distribution(model), rng)

    def act(self, model: Model, state: int, mode: int, rng: np.random.Generator) -> int | None:
        """An input, or None, drawn for the human half of the modal policy."""
        drawn = draw(model.input_likelihood[state, :, mode], rng)
        return drawn if drawn < len(model.input_names) else None

    def next_mode(
        self, model: Model, window: int, mode: int, action: int, rng: np.random.Generator
    ) -> int:
        """Switch to the perceived robot mode with probability alpha (Eq. 3-4)."""
        perceived = draw(model.perceived[window, action], rng)
        alpha = self.adaptability
        if not isinstance(alpha, float | int):
            alpha = alpha[perceived]
        if rng.random() < alpha:
            return perceived
        kept = model.kept_modes(window, action)[mode]
        return mode if kept[mode] == 1 else draw(kept, rng)


def draw(distribution: FloatArray, rng: np.random.Generator) -> int:
    """An index drawn from ``distribution``, by one uniform number."""
    left = rng.random()
    for i, probability in enumerate(distribution.tolist()):
        left -= probability
        if left < 0:
            return i
    return int(np.flatnonzero(distribution)[-1])
