"""Who takes part in a pilot: what they are like, drawn before they come."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from coadapt.study.protocol import Item, Question, Study
from coadapt.study.session.events import Device

Leaving = Literal["vanish", "withdraw", "decline"]
"""How somebody drops out: closes the window, presses the button, or does not consent."""

DEVICES: dict[Device, float] = {"keyboard": 0.7, "touch": 0.15, "gamepad": 0.1, "switch": 0.05}
"""What people steer with, and how many of them."""

ATTENTIVE = 0.95
"""Probability of the right answer to an attention check."""


@dataclass(frozen=True)
class Population:
    """Where participants are drawn from.

    Attributes:
        adaptability: values of alpha; each is as likely as any other.
        noise: probability of an input that is drawn from all of them.
        leaves: probability of dropping out somewhere.
        reloads: probability of loading the page again in the middle of a training session or trial.
        disconnects: probability of losing the connection there.

    Raises:
        ValueError: if a probability or an adaptability is outside [0, 1].
    """

    adaptability: tuple[float, ...] = (0.0, 0.25, 0.5, 0.75, 1.0)
    noise: float = 0.05
    leaves: float = 0.06
    reloads: float = 0.04
    disconnects: float = 0.04

    def __post_init__(self) -> None:
        chances = {
            "noise": self.noise,
            "leaves": self.leaves,
            "reloads": self.reloads,
            "disconnects": self.disconnects,
        }
        for name, chance in chances.items():
            if not 0 <= chance <= 1:
                raise ValueError(f"{name} must lie in [0, 1], not {chance}")
        if not self.adaptability or not all(0 <= alpha <= 1 for alpha in self.adaptability):
            raise ValueError(f"adaptability must lie in [0, 1], not {self.adaptability}")


@dataclass
class Person:
    """A participant.

    Attributes:
        number: from 1.
        rng: of everything they do from now on.
        population: where they were drawn from.
        adaptability: alpha.
        device: what they steer with.
        leaving: how they drop out, or None.
        leaves_at: the stage at which, counted from 0.
        mood: how much they agree with statements, in points from the middle of the scale.
    """

    number: int
    rng: np.random.Generator
    population: Population
    adaptability: float
    device: Device
    leaving: Leaving | None
    leaves_at: int
    mood: float

    @classmethod
    def drawn(
        cls, number: int, population: Population, stages: int, rng: np.random.Generator
    ) -> Person:
        """Someone from ``population``, for a study with so many stages."""
        names = list(DEVICES)
        leaving: Leaving | None = None
        if rng.random() < population.leaves:
            ways: tuple[Leaving, ...] = ("vanish", "withdraw", "decline")
            leaving = ways[int(rng.choice(3, p=(0.6, 0.25, 0.15)))]
        return cls(
            number=number,
            rng=rng,
            population=population,
            adaptability=float(rng.choice(population.adaptability)),
            device=names[int(rng.choice(len(names), p=list(DEVICES.values())))],
            leaving=leaving,
            leaves_at=int(rng.integers(stages)),
            mood=float(rng.normal(0.5, 0.8)),
        )

    def chance(self, probability: float) -> bool:
        """Whether something of this probability happens."""
        return bool(self.rng.random() < probability)

    def answers(self, study: Study, names: set[str]) -> dict[str, str]:
        """What is filled in for the items and questions of these names, in the protocol's order."""
        asked: list[tuple[Item | Question, int]] = [
            (item, len(scale.points)) for scale in study.scales for item in scale.items
        ]
        asked += [(question, len(question.choices)) for question in study.questions]
        answers = {q.name: self._answer(q, points) for q, points in asked if q.name in names}
        return {name: answer for name, answer in answers.items() if answer}

    def _answer(self, asked: Item | Question, points: int) -> str:
        if isinstance(asked, Item):
            if asked.expected is not None and self.chance(ATTENTIVE):
                return f"{asked.expected}"
            mood = -self.mood if asked.reversed else self.mood
            rated = (points + 1) / 2 + mood + self.rng.normal(0, 0.7)
            return f"{int(np.clip(np.rint(rated), 1, points))}"
        if asked.choices:
            return f"{int(self.rng.integers(1, points + 1))}"
        words = ("It went well.", "The robot seemed to know better.", "I wanted to be quick.", "")
        drawn = words[int(self.rng.integers(len(words)))]
        return drawn or (words[0] if asked.required else "")

    def browser(self) -> str:
        """What their browser calls itself."""
        return "coadapt pilot"


def people(n: int, population: Population, study_stages: int, seed: int) -> list[Person]:
    """``n`` participants; the first ones are the same whatever ``n`` is."""
    generators = np.random.default_rng(seed).spawn(n)
    return [Person.drawn(i + 1, population, study_stages, rng) for i, rng in enumerate(generators)]
