"""Many episodes of a problem under a policy, step by step, with the belief tracked exactly."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, Int32Array, IntArray
from coadapt.jit import bare, kernel
from coadapt.momdp.policy import AlphaVectorPolicy
from coadapt.momdp.sarsop.bounds import lane_totals
from coadapt.momdp.sarsop.problem import Problem, push, row_of

OVER = -1
"""Instead of an observed state: the episode has ended."""

NO_VECTOR = -1
"""Instead of a number of steps: the policy has no vector for an observed state it came to."""


class Columns(NamedTuple):
    """A policy's alpha vectors, those of one observed state side by side."""

    start: IntArray  # [X + 1] of the vectors of each x
    value: FloatArray  # [N * Y]; vector v of x has alpha(y) at start[x] * Y + y * (number at x) + v
    action: IntArray  # [N]


class Episodes(NamedTuple):
    """Where each of N episodes stands."""

    x: IntArray  # [N] observed state, or OVER
    y: IntArray  # [N] hidden state
    belief: FloatArray  # [N, Y]
    total: FloatArray  # [N] discounted reward so far


def as_columns(policy: AlphaVectorPolicy) -> Columns:
    """The arrays of ``policy``."""
    start = policy.start.astype(np.int64)
    parts = [policy.vectors[a:b].T.ravel() for a, b in pairwise(start)]
    return Columns(start, np.concatenate(parts), policy.actions.astype(np.int64))


@kernel
def mark_ended(p: Problem) -> BoolArray:
    """``[X, Y]`` the states from which no reward follows, whatever is done."""
    states, actions, hidden = p.reward.shape
    ended = np.ones((states, hidden), dtype=np.bool_)
    index = np.empty(hidden, dtype=np.int64)
    chance = np.empty(hidden)
    for x in range(states):
        for a in range(actions):
            for y in range(hidden):
                if p.reward[x, a, y] != 0.0:
                    ended[x, y] = False
    changed = True
    while changed:
        changed = False
        for x in range(states):
            for y in range(hidden):
                if ended[x, y] and leads_on(p, ended, x, y, index, chance):
                    ended[x, y] = False
                    changed = True
    return ended


@bare
def leads_on(
    p: Problem, ended: BoolArray, x: int, y: int, index: IntArray, chance: FloatArray
) -> bool:
    """Whether some action leads from ``(x, y)`` to a state that is not ``ended``.

    ``index`` and ``chance`` ``[Y]`` are scratch.
    """
    actions = p.reward.shape[1]
    for row in range(x * actions, (x + 1) * actions):
        for e in range(p.edge_start[row], p.edge_start[row + 1]):
            size = row_of(p, p.edge_map[e], y, index, chance)
            for i in range(size):
                if chance[i] > 0.0 and not ended[p.edge_next[e], index[i]]:
                    return True
    return False


@bare
def stays(p: Problem, row: int, x: int, y: int, into: IntArray, chance: FloatArray) -> bool:
    """Whether ``row`` of the edges leads from hidden state ``y`` to ``(x, y)`` and nowhere else.

    ``into`` and ``chance`` ``[Y]`` are scratch.
    """
    if p.edge_start[row] == p.edge_start[row + 1]:
        return False
    for e in range(p.edge_start[row], p.edge_start[row + 1]):
        size = row_of(p, p.edge_map[e], y, into, chance)
        for i in range(size):
            if chance[i] > 0.0 and (p.edge_next[e] != x or into[i] != y):
                return False
    return True


@kernel
def run_steps(
    p: Problem,
    policy: Columns,
    ended: BoolArray,
    now: Episodes,
    weight: float,
    uniform: FloatArray,
) -> int:
    """Let every episode of ``now`` that goes on take up to ``T`` steps.

    Args:
        p: the problem.
        policy: the policy.
        ended: ``[X, Y]``, from `mark_ended`; an episode that comes there is over.
        now: is brought up to date.
        weight: of the first reward: the discount of the steps before.
        uniform: ``[N, T, 2]`` numbers in [0, 1): for each step one that draws the successor and
            one that draws the observation.

    Returns:
        The number of steps taken, or `NO_VECTOR`.
    """
    hidden = p.reward.shape[2]
    # The belief's support; successors.
    index = np.empty(hidden, dtype=np.int32)
    mass = np.empty(hidden)
    chance = np.empty(hidden)
    into = np.empty(hidden, dtype=np.int64)
    moved = np.empty(hidden)
    spare = np.empty(hidden)
    values = np.empty(np.max(policy.start[1:] - policy.start[:-1]))
    taken = 0
    for n in range(uniform.shape[0]):
        scale = weight
        for t in range(uniform.shape[1]):
            x = now.x[n]
            if x == OVER:
                break
            if policy.start[x] == policy.start[x + 1]:
                return NO_VECTOR
            taken += 1
            size = support_of(now.belief[n], index, mass)
            a = policy.action[best_vector(policy, x, index[:size], mass[:size], hidden, values)]
            reward = p.reward[x, a, now.y[n]]
            now.total[n] += scale * reward
            scale *= p.discount
            row = x * p.reward.shape[1] + a
            if size == 1 and reward == 0.0 and stays(p, row, x, now.y[n], into, chance):
                now.x[n] = OVER  # the same belief, action and reward for ever
                break
            x_next = draw_successor(p, row, now.y[n], uniform[n, t, 0], into, chance)
            if x_next == OVER or ended[x_next, into[0]]:
                now.x[n] = OVER
                break
            now.x[n] = x_next
            now.y[n] = into[0]
            o = draw_observation(p, p.table[a, x_next] * hidden + now.y[n], uniform[n, t, 1])
            follow(p, row, x_next, index[:size], mass[:size], moved, spare, now.belief[n])
            correct(p, p.table[a, x_next] * hidden, o, now.belief[n])
    return taken


@bare
def support_of(belief: FloatArray, index: Int32Array, mass: FloatArray) -> int:
    """Write where ``belief`` ``[Y]`` is positive to ``index``, and how much to ``mass``; the number
    of these hidden states."""
    size = 0
    for y in range(belief.shape[0]):
        if belief[y] > 0.0:
            index[size] = y
            mass[size] = belief[y]
            size += 1
    return size


@bare
def best_vector(
    policy: Columns, x: int, index: Int32Array, mass: FloatArray, hidden: int, values: FloatArray
) -> int:
    """The best vector of ``x`` at the belief with ``mass`` on ``index``.

    ``values`` is scratch with room for all vectors of one observed state.
    """
    first, last = policy.start[x], policy.start[x + 1]
    count = last - first
    table = policy.value[first * hidden : last * hidden].reshape((hidden, count))
    lane_totals(table, index, mass, values[:count])
    best = 0
    for v in range(1, count):
        if values[v] > values[best]:
            best = v
    return int(first) + best


@bare
def draw_successor(
    p: Problem, row: int, y: int, uniform: float, into: IntArray, chance: FloatArray
) -> int:
    """The observed state that follows hidden state ``y`` in ``row`` of the edges, or `OVER`.

    The hidden one is written to ``into[0]``. ``into`` and ``chance`` are ``[Y]``.
    """
    x_next = OVER
    y_next = y
    left = uniform
    for e in range(p.edge_start[row], p.edge_start[row + 1]):
        size = row_of(p, p.edge_map[e], y, into, chance)
        for i in range(size):
            if chance[i] > 0.0:
                # Rounding may leave a rest of `uniform`: it falls to the last successor.
                x_next = p.edge_next[e]
                y_next = into[i]
                left -= chance[i]
                if left < 0.0:
                    into[0] = y_next
                    return x_next
    into[0] = y_next
    return x_next


@bare
def draw_observation(p: Problem, row: int, uniform: float) -> int:
    """An observation of ``row`` of the observation tables."""
    o = 0
    left = uniform
    for j in range(p.seen_start[row], p.seen_start[row + 1]):
        if p.seen_chance[j] > 0.0:
            o = p.seen[j]
            left -= p.seen_chance[j]
            if left < 0.0:
                break
    return o


@bare
def follow(
    p: Problem,
    row: int,
    x_next: int,
    index: Int32Array,
    mass: FloatArray,
    moved: FloatArray,
    spare: FloatArray,
    out: FloatArray,
) -> None:
    """Write the mass that ``row`` of the edges carries to ``x_next`` to ``out`` ``[Y]``.

    ``moved`` and ``spare`` ``[Y]`` are scratch.
    """
    out[:] = 0.0
    for e in range(p.edge_start[row], p.edge_start[row + 1]):
        if p.edge_next[e] == x_next:
            push(p, p.edge_map[e], index, mass, moved, spare)
            for y in range(out.shape[0]):
                out[y] += moved[y]


@bare
def correct(p: Problem, first: int, o: int, belief: FloatArray) -> float:
    """Weigh ``belief`` by the chance of ``o`` in the table that begins at ``first``; normalise.

    Returns:
        The chance of ``o``. Where it is 0 nothing is left of the belief.
    """
    total = 0.0
    for y in range(belief.shape[0]):
        if belief[y] > 0.0:
            likelihood = 0.0
            for j in range(p.seen_start[first + y], p.seen_start[first + y + 1]):
                if p.seen[j] == o:
                    likelihood = p.seen_chance[j]
            belief[y] *= likelihood
            total += belief[y]
    if total > 0.0:
        for y in range(belief.shape[0]):
            belief[y] /= total
    return total
