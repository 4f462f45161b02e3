"""Draws from distributions, each by one uniform number, or none where nothing is open."""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray

NOTHING = -1
"""Instead of an index: the rest of a distribution that does not sum to 1."""


def draw(distribution: FloatArray, rng: np.random.Generator) -> int:
    """An index drawn from ``distribution``, by one uniform number.

    No number is taken where one index is certain.
    """
    drawn = draw_part(distribution, rng)
    # Rounding may leave a rest: it falls to the last possible index.
    return int(np.flatnonzero(distribution)[-1]) if drawn == NOTHING else drawn


def draw_part(chances: FloatArray, rng: np.random.Generator) -> int:
    """An index drawn with the probabilities ``chances``, or `NOTHING` with what is left of 1.

    No number is taken where one index is certain, or none is possible.
    """
    each = chances.tolist()
    if max(each) == 0.0:
        return NOTHING
    for i, probability in enumerate(each):
        if probability == 1.0:
            return i
    left = rng.random()
    for i, probability in enumerate(each):
        left -= probability
        if left < 0:
            return i
    return NOTHING


class Streams:
    """A source of random numbers for each of many episodes.

    That of episode ``i`` is numpy's counter-based generator `numpy.random.Philox` with the key
    ``(key, i)``. So its numbers depend on the key and ``i`` alone, however the episodes are spread,
    and compiled code can compute them by itself (`coadapt.simulation.kernels.streams`).

    Args:
        key: 0 to ``2**64 - 1``.
    """

    def __init__(self, key: int) -> None:
        self.key = key

    @classmethod
    def of(cls, rng: np.random.Generator) -> Streams:
        """Streams with a key drawn from ``rng``."""
        return cls(int(rng.integers(0, 2**64, dtype=np.uint64)))

    def __getitem__(self, i: int) -> np.random.Generator:
        """The numbers of episode ``i``, from the first on."""
        return np.random.Generator(np.random.Philox(key=np.array([self.key, i], dtype=np.uint64)))
