"""The belief update of a MOMDP: predict through the action, correct by the observation.

Ong et al. 2010, Eq. 2; for the adaptation model this is Eq. 9 of Nikolaidis et al. 2017:
``b'(y') = eta O(o | a, x', y') sum_y P(x', y' | x, y, a) b(y)``.
"""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.momdp.model import MOMDP


def predict(problem: MOMDP, x: int, belief: FloatArray, a: int, x_next: int) -> FloatArray:
    """Mass ``[Y]`` on each y' after action ``a`` led from ``x`` to ``x_next``.

    The sum of the result is the probability of ``x_next``.
    """
    mass = np.zeros_like(belief)
    for e in problem.edges(x, a):
        if problem.edge_next[e] == x_next:
            mass += problem.transition.forward(int(problem.edge_map[e]), belief)
    return mass


def likelihood(problem: MOMDP, a: int, x_next: int, o: int) -> FloatArray:
    """``[Y]`` probability ``O(o | a, x', y')`` of observation ``o`` for every y'."""
    return problem.observation[problem.observation_index[a, x_next], :, o]


def update(
    problem: MOMDP, x: int, belief: FloatArray, a: int, x_next: int, o: int
) -> tuple[FloatArray, float]:
    """The belief after action ``a`` in ``x``, successor ``x_next`` and observation ``o``.

    Returns:
        The new belief ``[Y]`` and the probability of seeing ``(x_next, o)``.

    Raises:
        ValueError: if that probability is 0.
    """
    mass = predict(problem, x, belief, a, x_next) * likelihood(problem, a, x_next, o)
    probability = float(mass.sum())
    if probability <= 0.0:
        raise ValueError(
            f"observation {problem.observation_names[o]} in {problem.observed_names[x_next]} "
            f"has probability 0 after {problem.action_names[a]} in {problem.observed_names[x]}"
        )
    return mass / probability, probability
