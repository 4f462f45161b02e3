"""The robot's reward: goals, and a penalty for disagreement between modes (Sec. 4, Eq. 6-8)."""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.worlds import World


def disagreement(perceived: FloatArray) -> FloatArray:
    """``P(m_r != m_h | x, a_r)``: how surely a person in mode ``m_h`` sees the robot disagree.

    Args:
        perceived: ``[..., M]`` the person's distribution over robot modes, Eq. 2.

    Returns:
        ``[..., M]`` indexed by ``m_h``, in [0, 1].
    """
    return 1.0 - perceived


def reward(
    world: World, states: IntArray, perceived: FloatArray, disagreement_cost: float
) -> FloatArray:
    """``R(x, m_h, a_r)``, Eq. 6, where ``x`` is the window of the last ``k`` steps.

    Args:
        world: gives ``R_goal`` in its goal states.
        states: ``[W]`` the robot state of each window.
        perceived: ``[W, A, M]``, Eq. 2.
        disagreement_cost: ``C <= 0`` of Eq. 8.

    Returns:
        ``[W, A, M]``: ``R_goal`` in a goal state whatever the action, and elsewhere
        ``R_other = sum_{m_r} R_m(m_h, m_r) P(m_r | x, a_r)`` of Eq. 7.
    """
    rewards = disagreement_cost * disagreement(perceived)
    for goal in world.goals:
        rewards[states == goal.state] = goal.reward
    return np.ascontiguousarray(rewards)
