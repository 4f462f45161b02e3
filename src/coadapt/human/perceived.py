"""The robot mode a person perceives from the robot's recent actions (Sec. 3.3, Eq. 1-2)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.human.history import NO_ACTION


def perceived_robot_mode(
    robot_policies: FloatArray, steps: Iterable[tuple[IntArray, IntArray]]
) -> FloatArray:
    """``P(m_r | x^{t-k+1}, a^{t-k+1}, ..., x^t, a^t)``, Eq. 2, with a uniform prior over modes.

    It is proportional to ``m_r(x^{t-k+1}, a^{t-k+1}) ... m_r(x^t, a^t)``.

    Args:
        robot_policies: ``[M, X, A]`` the robot half of every modal policy.
        steps: the robot state of each step of the window and the action taken there, two arrays
            of indices that broadcast, with those of the other steps too, to the shape ``[...]`` of
            the windows. `NO_ACTION` where a window has no such step. See `Windows.steps`.

    Returns:
        ``[..., M]``, distributions over modes. Where every mode gives the window probability 0
        the window says nothing and the distribution is uniform.
    """
    by_state = np.moveaxis(robot_policies, 0, -1)  # [X, A, M]
    # The product is kept as `factor * 2 ** power`: neither a long window nor one mode far less
    # likely than another makes it vanish.
    factor, power = np.ones(len(robot_policies)), np.zeros(len(robot_policies), dtype=np.int64)
    for state, action in steps:
        chance = np.where((action == NO_ACTION)[..., None], 1.0, by_state[state, action])
        factor, more = np.frexp(factor * chance)
        power = power + more
    power = np.where(factor > 0, power, np.iinfo(np.int32).min)
    likelihood = np.ldexp(factor, np.maximum(power - power.max(axis=-1, keepdims=True), -2000))
    total = likelihood.sum(axis=-1, keepdims=True)
    uniform = np.full_like(likelihood, 1.0 / likelihood.shape[-1])
    return np.divide(likelihood, total, out=uniform, where=total > 0)
