"""The robot mode a person perceives from the robot's recent actions (Sec. 3.3, Eq. 1-2)."""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray, IntArray


def perceived_robot_mode(
    robot_policies: FloatArray, states: IntArray, actions: IntArray
) -> FloatArray:
    """``P(m_r | x^{t-k+1}, a^{t-k+1}, ..., x^t, a^t)``, Eq. 2, with a uniform prior over modes.

    Args:
        robot_policies: ``[M, X, A]`` the robot half of every modal policy.
        states: ``[..., k]`` the robot states of the window, oldest first.
        actions: ``[..., k]`` the robot action taken in each.

    Returns:
        ``[..., M]``, distributions over modes. Where every mode gives the window probability 0
        the window says nothing and the distribution is uniform.
    """
    likelihood = robot_policies[:, states, actions].prod(axis=-1)
    likelihood = np.moveaxis(likelihood, 0, -1)
    total = likelihood.sum(axis=-1, keepdims=True)
    uniform = np.full_like(likelihood, 1.0 / likelihood.shape[-1])
    return np.divide(likelihood, total, out=uniform, where=total > 0)
