"""A policy as alpha vectors: the value of committing to a plan, linear in the belief."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.momdp.belief import predict
from coadapt.momdp.model import MOMDP


@dataclass(frozen=True)
class AlphaVectorPolicy:
    """For every observed state a set of alpha vectors over the hidden ones.

    The value of belief ``b`` in observed state ``x`` is the largest ``b . alpha`` over the
    vectors of ``x``, and the policy takes the action of the vector that attains it (the first
    one, on a tie). The value is a lower bound of what following the policy collects.

    Attributes:
        start: ``[X + 1]``; the vectors of ``x`` are rows ``start[x] : start[x + 1]``.
        vectors: ``[N, Y]``.
        actions: ``[N]`` the action of each vector.
    """

    start: IntArray
    vectors: FloatArray
    actions: IntArray

    def action(self, x: int, belief: FloatArray) -> int:
        """The action to take in observed state ``x`` under ``belief`` of shape ``[Y]``."""
        return int(self.actions[self.start[x] + np.argmax(self._values(x, belief))])

    def actions_at(self, x: IntArray, beliefs: FloatArray) -> IntArray:
        """``[N]`` the actions in observed states ``x`` ``[N]`` under ``beliefs`` ``[N, Y]``."""
        if len(x) == 1:
            return np.array([self.action(int(x[0]), beliefs[0])])
        chosen = np.empty(len(x), dtype=np.int64)
        order = np.argsort(x, kind="stable")
        states, first = np.unique(x[order], return_index=True)
        for state, rows in zip(states, np.split(order, first)[1:], strict=True):
            best = np.argmax(self._values(int(state), beliefs[rows][:, None, :]), axis=-1)
            chosen[rows] = self.actions[self.start[state] + best]
        return chosen

    def value(self, x: int, belief: FloatArray) -> float:
        """Lower bound of the expected discounted reward from ``(x, belief)``."""
        return float(np.max(self._values(x, belief)))

    def _values(self, x: int, belief: FloatArray) -> FloatArray:
        # Not a matrix product: its order of summation, and so the last bit and the choice between
        # near-equal vectors, would depend on the machine's linear algebra library.
        return (self.vectors[self.start[x] : self.start[x + 1]] * belief).sum(axis=-1)


def value_at_roots(problem: MOMDP, policy: AlphaVectorPolicy) -> float:
    """What the alpha vectors promise at the roots, weighted by the probability of each."""
    return sum(root.probability * policy.value(root.x, root.belief) for root in problem.roots)


def require_fit(problem: MOMDP, policy: AlphaVectorPolicy) -> None:
    """Refuse a policy for a problem of another shape.

    Raises:
        ValueError: if the numbers of states differ, or the policy takes an action that is not
            there.
    """
    x, y, a, _ = problem.shape
    found = (len(policy.start) - 1, policy.vectors.shape[1])
    if found != (x, y):
        raise ValueError(
            f"found a policy for {found[0]:,} observed and {found[1]:,} hidden states, "
            f"expected one for {x:,} and {y:,}"
        )
    wrong = policy.actions[(policy.actions < 0) | (policy.actions >= a)]
    if len(wrong):
        raise ValueError(f"found action {wrong[0]} in the policy, expected one of 0 to {a - 1}")


def action_values(
    problem: MOMDP, policy: AlphaVectorPolicy, x: int, belief: FloatArray
) -> FloatArray:
    """``[A]``: ``Q(x, b, a) = R(x, b, a) + gamma sum_{x', o} P(x', o | x, b, a) V(x', b')``.

    Args:
        problem: the problem that ``policy`` solves.
        policy: gives the lower bound ``V`` of the successors.
        x: observed state.
        belief: ``[Y]``.
    """
    values = (problem.reward[x] * belief).sum(axis=1)
    for a in range(len(values)):
        for x_next in np.unique([problem.edge_next[e] for e in problem.edges(x, a)]):
            mass = predict(problem, x, belief, a, int(x_next))
            likelihoods = problem.observation[problem.observation_index[a, x_next]]
            for joint in (mass[:, None] * likelihoods).T:
                # V is linear in the scale of its argument, so the probability is already in it.
                if joint.any():
                    values[a] += problem.discount * policy.value(int(x_next), joint)
    return values
