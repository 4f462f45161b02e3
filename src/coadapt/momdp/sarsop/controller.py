"""A policy read as a finite-state controller, and its value, certified anew.

The numbers in a policy need not hold for the problem at hand: it may come from another discount,
other rewards, or another program. So only its choices are kept. Read as a finite-state controller
(Hansen 1998), every alpha vector is a state of the controller: it takes its action, and what is
observed next decides which vector follows, namely the best one at the belief that follows from the
belief at which the vector was first met on the way from the roots. The controller's values,

    v_i(y) = R(x_i, a_i, y)
             + gamma sum_{x', y', o} P(x', y' | x_i, y, a_i) O(o | y') v_next(i, x', o)(y'),

approached from below, are lower bounds whatever the policy was. Search can start from them, and
they are a policy themselves, most often a much smaller one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coadapt.arrays import FloatArray, Int32Array, IntArray
from coadapt.jit import bare, kernel
from coadapt.momdp.model import MOMDP, return_range
from coadapt.momdp.policy import AlphaVectorPolicy, require_fit
from coadapt.momdp.sarsop.episodes import Columns, as_columns, best_vector, correct, support_of
from coadapt.momdp.sarsop.initial import extreme_value
from coadapt.momdp.sarsop.problem import Problem, as_arrays, pull, push

NOT_MET = -1
"""Instead of a state of the controller."""

SWEEPS = 10_000
"""Most sweeps of its values."""

SETTLED = 1e-6
"""They end when no value is further from settled than about this part of the largest reward."""


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


def controller(problem: MOMDP, p: Problem, policy: AlphaVectorPolicy) -> Controller:
    """The states of ``policy`` that are met from the roots of ``problem``, with arrays ``p``."""
    columns = as_columns(policy)
    count = len(policy.vectors)
    fan = int(np.diff(p.edge_start).max(initial=0)) * p.observations
    c = Controller(
        x=np.empty(count, dtype=np.int64),
        action=np.empty(count, dtype=np.int64),
        first=np.empty(count, dtype=np.int64),
        following=np.empty(count * fan, dtype=np.int64),
    )
    root_x = np.array([root.x for root in problem.roots])
    root_belief = np.stack([root.belief for root in problem.roots])
    hidden = problem.shape[1]
    room = Meeting(
        place=np.full(count, NOT_MET),
        belief=np.empty((count, hidden)),
        values=np.empty(int(np.diff(columns.start).max())),
        support=np.empty(hidden, dtype=np.int32),
        mass=np.empty(hidden),
        moved=np.empty(hidden),
        joint=np.empty(hidden),
        spare=np.empty(hidden),
    )
    met = meet(p, columns, root_x, root_belief, c, room)
    return Controller(c.x[:met], c.action[:met], c.first[:met], c.following)


def condensed(problem: MOMDP, policy: AlphaVectorPolicy) -> AlphaVectorPolicy:
    """``policy`` as the states of its controller: often a tenth of the alpha vectors.

    Each of the new vectors is a lower bound of what following the new policy earns, whatever the
    old ones were. A vector that was best at several beliefs is followed as at the first of them, so
    the bound at the roots may be a little lower than before. It may be higher too, since an old
    vector knows only what was known when it was made. Observed states that are never met from the
    roots keep one action.

    Raises:
        ValueError: if ``policy`` does not fit the problem's states and actions, or has no vector
            for some observed state.
    """
    require_start(problem, policy)
    p = as_arrays(problem)
    c = controller(problem, p, policy)
    values = controller_values(p, c)
    states, _, hidden = p.reward.shape
    others = np.flatnonzero(np.bincount(c.x, minlength=states) == 0)
    x = np.concatenate([c.x, others])
    order = np.argsort(x, kind="stable")
    worst = np.full((len(others), hidden), return_range(problem)[0])
    return AlphaVectorPolicy(
        start=np.concatenate([[0], np.cumsum(np.bincount(x, minlength=states))]),
        vectors=np.concatenate([values, worst])[order],
        actions=np.concatenate([c.action, policy.actions[policy.start[others]]])[order],
    )


class Meeting(NamedTuple):
    """Room to find the states in. Sizes: N vectors of the policy, Y hidden states."""

    place: IntArray  # [N] of each vector in the controller, or NOT_MET
    belief: FloatArray  # [N, Y] at which each state was first met
    values: FloatArray  # as many as vectors of one observed state
    support: Int32Array  # [Y]
    mass: FloatArray  # [Y]
    moved: FloatArray  # [Y]
    joint: FloatArray  # [Y]
    spare: FloatArray  # [Y]


@kernel
def meet(
    p: Problem,
    policy: Columns,
    root_x: IntArray,
    root_belief: FloatArray,
    c: Controller,
    room: Meeting,
) -> int:
    """Fill ``c`` with the states that are met from the roots; their number.

    ``root_x`` ``[R]`` and ``root_belief`` ``[R, Y]`` are the roots.
    """
    index, mass = room.support, room.mass
    moved, joint = room.moved, room.joint
    hidden = joint.shape[0]
    met = at = done = 0
    for r in range(root_x.shape[0]):
        met = max(met, 1 + state_at(policy, c, room, met, root_x[r], root_belief[r]))
    while done < met:
        c.first[done] = at
        a = c.action[done]
        row = c.x[done] * p.reward.shape[1] + a
        for e in range(p.edge_start[row], p.edge_start[row + 1]):
            x_next = p.edge_next[e]
            size = support_of(room.belief[done], index, mass)
            push(p, p.edge_map[e], index[:size], mass[:size], moved, room.spare)
            table = p.table[a, x_next] * hidden
            for o in range(p.observations):
                for y in range(hidden):
                    joint[y] = moved[y]
                # Where the observation is impossible any belief will do.
                if correct(p, table, o, joint) == 0.0:
                    joint[:] = 1.0 / hidden
                    if correct(p, table, o, joint) == 0.0:
                        joint[:] = 1.0 / hidden
                state = state_at(policy, c, room, met, x_next, joint)
                met = max(met, 1 + state)
                c.following[at] = state
                at += 1
        done += 1
    return met


@bare
def state_at(
    policy: Columns, c: Controller, room: Meeting, met: int, x: int, belief: FloatArray
) -> int:
    """The state of the best vector of ``x`` at ``belief``; if new, ``met``."""
    hidden = belief.shape[0]
    size = support_of(belief, room.support, room.mass)
    v = best_vector(policy, x, room.support[:size], room.mass[:size], hidden, room.values)
    if room.place[v] == NOT_MET:
        room.place[v] = met
        c.x[met] = x
        c.action[met] = policy.action[v]
        for y in range(hidden):
            room.belief[met, y] = belief[y]
    return int(room.place[v])


@kernel
def controller_values(p: Problem, c: Controller) -> FloatArray:
    """``[V, Y]`` lower bounds of the values of the controller's states."""
    hidden = p.reward.shape[2]
    tolerance = SETTLED * (1.0 - p.discount) * max(1e-6, np.max(np.abs(p.reward)))
    values = np.empty((c.x.shape[0], hidden))
    values.fill(extreme_value(p, -1.0))
    new = np.empty(hidden)
    mixed = np.empty(hidden)
    spare = np.empty(hidden)
    for _ in range(SWEEPS):
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
