"""Robots with policies that were not planned: any will do where it is the loop that is tested."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from coadapt import AlphaVectorPolicy, Collaboration, SharedAutonomy
from coadapt.formalism import Model
from coadapt.robots import (
    Collaborator,
    Decider,
    MatchRule,
    MutualAdaptation,
    NoAdaptation,
    OneWayAdaptation,
)


def random_policy(model: Model, rng: np.random.Generator, vectors: int = 4) -> AlphaVectorPolicy:
    """A policy with up to some vectors for each window."""
    seen = isinstance(model, Collaboration) and not model.hidden_modes
    hidden = len(model.alpha.values) if seen else model.prior.size
    counts = rng.integers(1, vectors + 1, size=len(model.windows))
    return AlphaVectorPolicy(
        start=np.concatenate(([0], np.cumsum(counts))),
        vectors=rng.random((counts.sum(), hidden)),
        actions=rng.integers(model.world.actions, size=counts.sum()),
    )


def robots_for(model: Model, rng: np.random.Generator) -> list[Decider]:
    """A robot of each kind for ``model``."""
    if isinstance(model, SharedAutonomy):
        robots: list[Decider] = [
            MutualAdaptation(model, random_policy(model, rng), MatchRule(0.6)),
            OneWayAdaptation(model, random_policy(model.one_way(), rng)),
        ]
        with suppress(ValueError):  # in a world at random the optimal goal may be out of reach
            robots.append(NoAdaptation(model))
        return robots
    return [Collaborator(model, random_policy(model, rng))]
