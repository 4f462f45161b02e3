"""A planner that knows nothing of adaptation: all that is hidden is a goal that never changes.

This is assistance towards an unknown goal, the one-way robot of Sec. 6.1, written down from the
paper's equations without `coadapt.formalism`: dense arrays, a filter of its own.
"""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.human.history import Windows
from coadapt.momdp.model import MOMDP, Root
from coadapt.momdp.policy import AlphaVectorPolicy
from coadapt.worlds import World


def goal_problem(
    world: World, windows: Windows, policies: FloatArray, disagreement_cost: float, discount: float
) -> MOMDP:
    """Assistance towards one of the goals of ``world``, each worth as much as the best.

    Observed is the window ``w`` of the last steps, which ends in robot state ``x``. Hidden is the
    goal ``g``, uniform at first and constant: ``T_y`` is the identity. The person's input in ``x``
    is drawn from ``pi_g(. | x)``. A goal state pays the goals' common reward; else

        R(w, g, a) = sum_{m_r} R_m(g, m_r) P(m_r | w, a),   R_m = 0 if m_r = g else C   (Eq. 7-8)
        P(m_r | w, a) = eta prod_i pi_{m_r}(a^i | x^i) over the steps of w, a           (Eq. 2)

    Args:
        world: states, moves, goals.
        windows: what a person may remember.
        policies: ``[G, X, A]`` modal policies ``pi_g(a | x)``.
        disagreement_cost: ``C``.
        discount: gamma.
    """
    states, actions = len(windows), world.actions
    goals = len(world.goals)
    best = max(goal.reward for goal in world.goals)
    moves = np.zeros((states, actions, states))  # [W, A, W']
    reward = np.zeros((states, actions, goals))  # [W, A, G]
    for w in range(states):
        x, past = int(windows.first[w]), [int(a) for a in windows.actions[w] if a >= 0]
        likelihood = [1.0] * goals
        for a in past:
            likelihood = [likelihood[m] * policies[m, x, a] for m in range(goals)]
            x = int(world.moves[x, a])
        for a in range(actions):
            moves[w, a, windows.next[w, a, 0]] = 1.0
            weight = [likelihood[m] * policies[m, x, a] for m in range(goals)]
            total = sum(weight)
            for g in range(goals):
                for m_r in range(goals):
                    seen = weight[m_r] / total if total > 0 else 1.0 / goals
                    reward[w, a, g] += (0.0 if m_r == g else disagreement_cost) * seen
        if x in world.goal_states:
            reward[w] = best
    inputs = np.moveaxis(policies, 0, 1)  # [X, G, A_h]
    start = int(windows.beginning[world.start])
    roots: list[Root] = []
    for human_input in range(actions):
        joint = inputs[world.start, :, human_input] / goals
        if joint.sum() > 0:
            belief = joint / joint.sum()
            name = world.action_names[human_input]
            roots.append(Root(start, belief, float(joint.sum()), name))
    return MOMDP.from_arrays(
        transition_x=moves,
        transition_y=np.broadcast_to(np.eye(goals), (states, actions, goals, goals)),
        observation=np.tile(inputs[windows.state], (actions, 1, 1, 1)),
        reward=reward,
        discount=discount,
        roots=roots,
        terminal=np.flatnonzero(np.isin(windows.state, world.goal_states)).tolist(),
        hidden_names=[goal.name for goal in world.goals],
        action_names=world.action_names,
        observation_names=world.action_names,
    )


class GoalPlanner:
    """Decides from a belief over goals.

    Args:
        policies: ``[G, X, A]`` modal policies, the likelihood of inputs.
        policy: a solution of `goal_problem`.
    """

    def __init__(self, policies: FloatArray, policy: AlphaVectorPolicy) -> None:
        self.policies = policies
        self.policy = policy
        self.prior = np.full(len(policies), 1.0 / len(policies))

    def correct(self, belief: FloatArray, states: IntArray, inputs: IntArray) -> FloatArray:
        """Bayes' rule for a goal that stays: ``b(g) <- eta pi_g(a_h | x) b(g)``.

        Args:
            belief: ``[N, G]``.
            states, inputs: ``[N]``.
        """
        joint = belief * self.policies[:, states, inputs].T
        return joint / joint.sum(axis=1, keepdims=True)

    def actions(self, windows: IntArray, belief: FloatArray) -> IntArray:
        """``[N]`` actions in ``windows`` ``[N]`` under ``belief`` ``[N, G]``."""
        return self.policy.actions_at(windows, belief)
