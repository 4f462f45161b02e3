"""Who takes part in an experiment: how their hands slip and how often they are absent-minded.

Adaptability has a population of its own (`coadapt.analysis.adaptability.beta`). The rates here are
independent of it and of each other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coadapt.analysis.adaptability.beta import draw_beta, spread_of
from coadapt.arrays import FloatArray
from coadapt.human import Adaptability
from coadapt.simulation.partners import DescribedPartner, DrawnPartner, Lapsing, Noisy

LAPSE_STEPS = 3.0
"""Mean number of steps that a lapse lasts, that of `coadapt.simulation.partners.KINDS`."""

ALWAYS = 1.0 - 1e-9
"""Share of the steps that somebody spends in lapses who is never attentive; theirs never end."""


@dataclass(frozen=True)
class Rates:
    """A beta distribution of a rate among people.

    Attributes:
        mean: in [0, 1].
        sd: standard deviation; with 0 the rate is the same for all.

    Raises:
        ValueError: if no distribution over [0, 1] has them.
    """

    mean: float = 0.0
    sd: float = 0.0

    def __post_init__(self) -> None:
        _ = spread_of(self.mean, self.sd)

    @property
    def varies(self) -> bool:
        """Whether people differ."""
        return self.sd > 0

    def draw(self, count: int, rng: np.random.Generator) -> FloatArray:
        """``[count]`` rates in [0, 1]. Nothing is taken from ``rng`` where all are the same."""
        return draw_beta(self.mean, spread_of(self.mean, self.sd), count, rng)


@dataclass(frozen=True)
class People:
    """How participants deviate from the adaptation model.

    Attributes:
        noise: rate of inputs other than those meant, see `Noisy`.
        lapses: share of the steps spent in lapses, see `Lapsing`.
        lapse_steps: mean number of steps that a lapse lasts, at least 1. Nobody's are shorter than
            if every step were a lapse or not by itself, ``1 / (1 - share)`` steps.

    Raises:
        ValueError: if ``lapse_steps`` is below 1.
    """

    noise: Rates = Rates()
    lapses: Rates = Rates()
    lapse_steps: float = LAPSE_STEPS

    def __post_init__(self) -> None:
        if not self.lapse_steps >= 1:
            raise ValueError(f"a lapse lasts 1 step or more, not {self.lapse_steps:g}")

    @property
    def differ(self) -> bool:
        """Whether people with the same alpha differ."""
        return self.noise.varies or self.lapses.varies

    def draw(
        self, alpha: float, mode: int | None, count: int, rng: np.random.Generator
    ) -> list[DescribedPartner]:
        """``count`` people with the same alpha and first mode, each with rates of their own."""
        noise, lapses = self.noise.draw(count, rng), self.lapses.draw(count, rng)
        return [
            self._person(alpha, mode, slips, absent)
            for slips, absent in zip(noise.tolist(), lapses.tolist(), strict=True)
        ]

    def _person(
        self, alpha: float, mode: int | None, noise: float, lapses: float
    ) -> DescribedPartner:
        person: DescribedPartner = DrawnPartner(Adaptability.over((alpha,)), mode)
        if lapses > 0:
            share = min(lapses, ALWAYS)
            person = Lapsing(person, share, max(self.lapse_steps, 1.0 / (1.0 - share)))
        return Noisy(person, noise) if noise > 0 else person
