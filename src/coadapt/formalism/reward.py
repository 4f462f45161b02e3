"""The robot's reward: goals, and penalties for disagreement (Sec. 4, Eq. 6-8).

The paper's penalty is for disagreement between modes: what the person believes the robot is up to.
Sec. 5.3 and 7 name another one for future work, for disagreement between actions. Ours is
``C_a (1 - m_h(a_r | x))``, at most 0: ``C_a`` times the probability that a person in mode ``m_h``
wants another action in ``x`` than the robot's. Like Eq. 7 it is an expectation given the mode, so
it needs no more state than the paper's.
"""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.worlds import World


def disagreement(alike: FloatArray) -> FloatArray:
    """``P(m_r != m_h | x, a_r)``: how surely a person in mode ``m_h`` sees the robot disagree.

    Args:
        alike: ``[..., M]`` the probability that they agree: the person's distribution over robot
            modes, Eq. 2, or the probability that they want the robot's action.

    Returns:
        ``[..., M]`` indexed by ``m_h``, in [0, 1].
    """
    return 1.0 - alike


def reward(
    world: World,
    states: IntArray,
    perceived: FloatArray,
    disagreement_cost: float,
    wishes: FloatArray | None = None,
    action_disagreement_cost: float = 0.0,
) -> FloatArray:
    """``R(x, m_h, a_r)``, Eq. 6, where ``x`` is the window of the last ``k`` steps.

    Args:
        world: gives ``R_goal`` in its goal states, and what moves cost.
        states: ``[W]`` the robot state of each window.
        perceived: ``[W, A, M]``, Eq. 2.
        disagreement_cost: ``C <= 0`` of Eq. 8.
        wishes: ``[M, X, A]`` the human half of the modal policies, where disagreement between
            actions is to be paid.
        action_disagreement_cost: ``C_a <= 0``.

    Returns:
        ``[W, A, M]``: ``R_goal`` in a goal state whatever the action, and elsewhere
        ``R_other = sum_{m_r} R_m(m_h, m_r) P(m_r | x, a_r)`` of Eq. 7 with what else is paid.
    """
    rewards = disagreement_cost * disagreement(perceived)
    if wishes is not None:
        rewards += action_disagreement_cost * disagreement(np.moveaxis(wishes, 0, -1)[states])
    if world.costs is not None:
        rewards -= world.costs[states][:, :, None]
    for goal in world.goals:
        rewards[np.isin(states, goal.states)] = goal.reward
    return np.ascontiguousarray(rewards)
