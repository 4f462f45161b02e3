"""First bounds, before any search.

Upper: the value with the hidden state known (MDP), then the fast informed bound (Hauskrecht 2000),

    F_a(x, y) = R(x, a, y) + gamma sum_{x', o} max_{a'} sum_{y'} P(x', y' | x, y, a) O(o | y')
                F_{a'}(x', y'),

iterated from above. Lower: the values of policies that look at the observed state alone, iterated
from below. Each iterate is a bound, so both may stop early.
"""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.momdp.sarsop.jit import kernel
from coadapt.momdp.sarsop.problem import Problem, pull

SETTLED = 1e-4
"""Sweeps end when no value moves by more than this part of the largest reward."""


@kernel
def mdp_values(p: Problem, tolerance: float, sweeps: int) -> FloatArray:
    """``[X, A, Y]`` upper bounds of ``Q`` with the hidden state known to the robot."""
    states, actions, hidden = p.reward.shape
    largest = p.reward.max()
    start = max(largest, largest / (1.0 - p.discount))
    value = np.full((states, hidden), start)
    q = np.empty((states, actions, hidden))
    for sweep in range(sweeps):
        change = 0.0
        for i in range(states):
            # Alternate directions: values travel along either order of the states in one sweep.
            x = i if sweep % 2 == 0 else states - 1 - i
            for a in range(actions):
                backed_up_value(p, x, a, value, q[x, a])
            for y in range(hidden):
                best = q[x, 0, y]
                for a in range(1, actions):
                    best = max(best, q[x, a, y])
                change = max(change, value[x, y] - best)
                value[x, y] = best
        if change <= tolerance:
            break
    return q


@kernel
def backed_up_value(p: Problem, x: int, a: int, value: FloatArray, out: FloatArray) -> None:
    """Write ``R(x, a, .) + gamma sum P(x', y' | x, ., a) value(x', y')`` to ``out`` ``[Y]``."""
    out[:] = p.reward[x, a]
    row = x * p.reward.shape[1] + a
    for e in range(p.edge_start[row], p.edge_start[row + 1]):
        pull(p, p.edge_map[e], p.discount, value[p.edge_next[e]], out)


@kernel
def fast_informed_bound(p: Problem, q: FloatArray, tolerance: float, sweeps: int) -> None:
    """Tighten ``q`` ``[X, A, Y]``, an upper bound such as `mdp_values`, in place."""
    states, actions, hidden = p.reward.shape
    observations = p.observation.shape[1]
    weighted = np.empty(hidden)
    candidate = np.empty(hidden)
    best = np.empty(hidden)
    new = np.empty(hidden)
    for sweep in range(sweeps):
        change = 0.0
        for i in range(states):
            x = i if sweep % 2 == 0 else states - 1 - i
            for a in range(actions):
                new[:] = p.reward[x, a]
                row = x * actions + a
                for e in range(p.edge_start[row], p.edge_start[row + 1]):
                    x_next = p.edge_next[e]
                    table = p.observation[p.observation_index[a, x_next]]
                    for o in range(observations):
                        if not table[o].any():
                            continue
                        best[:] = -np.inf
                        for a_next in range(actions):
                            candidate[:] = 0.0
                            for y in range(hidden):
                                weighted[y] = table[o, y] * q[x_next, a_next, y]
                            pull(p, p.edge_map[e], p.discount, weighted, candidate)
                            for y in range(hidden):
                                best[y] = max(best[y], candidate[y])
                        for y in range(hidden):
                            new[y] += best[y]
                for y in range(hidden):
                    if new[y] < q[x, a, y]:
                        change = max(change, q[x, a, y] - new[y])
                        q[x, a, y] = new[y]
        if change <= tolerance:
            break


@kernel
def policy_values(p: Problem, policy: IntArray, tolerance: float, sweeps: int) -> FloatArray:
    """``[X, Y]`` lower bounds of the value of taking action ``policy[x]`` in each ``x``."""
    states, _, hidden = p.reward.shape
    smallest = p.reward.min()
    start = min(smallest, smallest / (1.0 - p.discount))
    value = np.full((states, hidden), start)
    new = np.empty(hidden)
    for sweep in range(sweeps):
        change = 0.0
        for i in range(states):
            x = i if sweep % 2 == 0 else states - 1 - i
            backed_up_value(p, x, policy[x], value, new)
            for y in range(hidden):
                change = max(change, new[y] - value[x, y])
                value[x, y] = new[y]
        if change <= tolerance:
            break
    return value


def observed_policies(q: FloatArray, limit: int) -> list[IntArray]:
    """Policies ``[X]`` of the observed state alone: every constant one, and for up to ``limit``
    hidden states, evenly spread, the best one if it were known and stayed."""
    states, actions, hidden = q.shape
    policies = [np.full(states, a, dtype=np.int64) for a in range(actions)]
    count = min(limit, hidden)
    for y in (i * (hidden - 1) // max(count - 1, 1) for i in range(count)):
        policies.append(np.argmax(q[:, :, y], axis=1).astype(np.int64))
    distinct = {policy.tobytes(): policy for policy in policies}
    return list(distinct.values())
