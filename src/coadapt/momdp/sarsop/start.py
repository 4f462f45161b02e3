"""Starting from a policy: its value, certified anew, as alpha vectors.

The numbers in a policy need not hold for the problem at hand: it may come from another discount,
other rewards, or another program. So only its choices are kept. Read as a finite-state controller
(Hansen 1998), every alpha vector is a state of the controller: it takes its action, and what is
observed next decides which vector follows, namely the best one at the belief that follows from the
belief at which the vector was first met on the way from the roots. The controller's values,

    v_i(y) = R(x_i, a_i, y)
             + gamma sum_{x', y', o} P(x', y' | x_i, y, a_i) O(o | y') v_next(i, x', o)(y'),

approached from below, are lower bounds whatever the policy was.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.jit import kernel
from coadapt.momdp.model import MOMDP
from coadapt.momdp.policy import AlphaVectorPolicy, require_fit
from coadapt.momdp.sarsop.initial import extreme_value
from coadapt.momdp.sarsop.problem import Problem, pull


class Controller(NamedTuple):
    """The states that a policy visits. Sizes: V states."""

    x: IntArray  # [V] observed state
    action: IntArray  # [V]
    first: IntArray  # [V] where its successors begin
    following: IntArray  # the state that follows, for every edge of (x, action) and observation


def require_start(problem: MOMDP, policy: AlphaVectorPolicy) -> None:
    """Refuse a policy that cannot be followed everywhere in ``problem``.

    Raises:
        ValueError: if it does not fit (`require_fit`) or has no vector for some observed state.
    """
    require_fit(problem, policy)
    empty = np.flatnonzero(np.diff(policy.start) == 0)
    if len(empty):
        raise ValueError(f"the policy has no vector for {problem.observed_names[empty[0]]}")


def controller(problem: MOMDP, policy: AlphaVectorPolicy) -> Controller:
    """The states of ``policy`` that are met from the roots of ``problem``."""
    hidden, observations = problem.shape[1], problem.shape[3]
    place: dict[int, int] = {}  # of a vector of the policy in the controller
    met: list[tuple[int, FloatArray, int]] = []  # observed state, belief, action

    def state(x: int, belief: FloatArray) -> int:
        rows = slice(int(policy.start[x]), int(policy.start[x + 1]))
        # Summed in a fixed order, as the policy itself does.
        vector = rows.start + int(np.argmax((policy.vectors[rows] * belief).sum(axis=1)))
        if vector not in place:
            place[vector] = len(met)
            met.append((x, belief, int(policy.actions[vector])))
        return place[vector]

    for root in problem.roots:
        _ = state(root.x, root.belief)
    first: list[int] = []
    following: list[int] = []
    done = 0
    while done < len(met):
        x, belief, a = met[done]
        done += 1
        first.append(len(following))
        for e in problem.edges(x, a):
            x_next = int(problem.edge_next[e])
            chances = problem.observation[problem.observation_index[a, x_next]]  # [Y, O]
            mass = problem.transition.forward(int(problem.edge_map[e]), belief)
            for o in range(observations):
                joint = mass * chances[:, o]
                if not joint.any():  # impossible here, so any choice will do
                    joint = chances[:, o] if chances[:, o].any() else np.ones(hidden)
                following.append(state(x_next, joint / joint.sum()))
    return Controller(
        x=np.array([x for x, _, _ in met], dtype=np.int64),
        action=np.array([a for _, _, a in met], dtype=np.int64),
        first=np.array(first, dtype=np.int64),
        following=np.array(following, dtype=np.int64),
    )


@kernel
def controller_values(p: Problem, c: Controller, tolerance: float, sweeps: int) -> FloatArray:
    """``[V, Y]`` lower bounds of the values of the controller's states."""
    hidden = p.reward.shape[2]
    values = np.empty((c.x.shape[0], hidden))
    values.fill(extreme_value(p, -1.0))
    new = np.empty(hidden)
    mixed = np.empty(hidden)
    spare = np.empty(hidden)
    for _ in range(sweeps):
        change = 0.0
        # The states met last come first: values travel back to the roots.
        for i in range(c.x.shape[0] - 1, -1, -1):
            x, a = c.x[i], c.action[i]
            for y in range(hidden):
                new[y] = p.reward[x, a, y]
            row = x * p.reward.shape[1] + a
            at = c.first[i]
            for e in range(p.edge_start[row], p.edge_start[row + 1]):
                table = p.table[a, p.edge_next[e]] * hidden
                for y in range(hidden):
                    mixed[y] = 0.0
                    for j in range(p.seen_start[table + y], p.seen_start[table + y + 1]):
                        mixed[y] += p.seen_chance[j] * values[c.following[at + p.seen[j]], y]
                pull(p, p.edge_map[e], p.discount, mixed, new, spare)
                at += p.observations
            for y in range(hidden):
                if new[y] > values[i, y]:
                    change = max(change, new[y] - values[i, y])
                    values[i, y] = new[y]
        if change <= tolerance:
            break
    return values
