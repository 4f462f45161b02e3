"""People whose adaptability changes as they go."""

from __future__ import annotations

import numpy as np

from coadapt.human.adaptation import Adaptability
from coadapt.simulation.partners.simulated import DrawnPartner

POINTS = 11
"""Values of alpha between which a person drifts: 0, 0.1, ... 1."""


def drifting(
    adaptability: float, rate: float, mode: int | None = None, points: int = POINTS
) -> DrawnPartner:
    """A person whose alpha walks at random over a grid, see `Adaptability.drifting`.

    Args:
        adaptability: alpha at the start, in [0, 1]; joins the grid.
        rate: probability of a move to a neighbouring value after each step, in [0, 1].
        mode: index of the first mode; drawn from the model's prior if None.
        points: number of values in the grid, at least 2.

    Raises:
        ValueError: if a number is out of its range.
    """
    return DrawnPartner(_from(adaptability, points).drifting(rate), mode)


def tiring(
    adaptability: float, rate: float, mode: int | None = None, points: int = POINTS
) -> DrawnPartner:
    """As `drifting`, but alpha only falls, see `Adaptability.tiring`."""
    return DrawnPartner(_from(adaptability, points).tiring(rate), mode)


def _from(adaptability: float, points: int) -> Adaptability:
    if points < 2:
        raise ValueError(f"a grid needs at least 2 points, not {points}")
    values = np.unique([*np.linspace(0.0, 1.0, points).tolist(), float(adaptability)])
    return Adaptability.over(values, (values == adaptability).astype(np.float64))
