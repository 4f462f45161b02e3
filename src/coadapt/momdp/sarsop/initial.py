"""First bounds, before any search.

Upper: the value with the hidden state known (MDP), then the fast informed bound (Hauskrecht 2000),

    F_a(x, y) = R(x, a, y) + gamma sum_{x', o} max_{a'} sum_{y'} P(x', y' | x, y, a) O(o | y')
                F_{a'}(x', y'),

iterated from above. Lower: the values of policies that look at the observed state alone, iterated
from below. Each iterate is a bound, so both may stop early; the MDP values are made one at the end.
"""

from __future__ import annotations

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.jit import bare, kernel
from coadapt.momdp.sarsop.problem import Problem, pull, row_of, staying

SETTLED = 1e-4
"""Sweeps end when no value moves by more than this part of the largest reward."""

KNOWN = 8
"""Hidden states whose best policy starts the lower bound."""


@bare
def extreme_value(p: Problem, sign: float) -> float:
    """A number that no value exceeds (``sign`` 1), or that none falls below (``sign`` -1).

    A reward that ends the episode is collected once, any other at most ``1 / (1 - gamma)`` times.
    """
    states, actions, hidden = p.reward.shape
    most = -np.inf
    for x in range(states):
        for a in range(actions):
            row = x * actions + a
            ends = p.edge_start[row] == p.edge_start[row + 1]
            for y in range(hidden):
                value = sign * p.reward[x, a, y]
                most = max(most, value if ends else value / (1.0 - p.discount))
    return sign * most


@kernel
def mdp_values(p: Problem, tolerance: float, sweeps: int) -> FloatArray:
    """``[X, A, Y]`` upper bounds of ``Q`` with the hidden state known to the robot.

    Values rise from below, since from above the cycles of the problem would hold them up. Where one
    more sweep raises no value by more than ``d``, adding ``d / (1 - gamma)`` makes them bounds.
    """
    states, actions, hidden = p.reward.shape
    value = np.empty((states, hidden))
    value.fill(extreme_value(p, -1.0))
    moved = np.zeros(states, dtype=np.int64)  # the sweep in which a value of x last moved
    new = np.empty(hidden)
    best = np.empty(hidden)
    spare = np.empty(hidden)
    needless = np.empty((states, actions), dtype=np.bool_)
    for x in range(states):
        for a in range(actions):
            needless[x, a] = is_needless(p, x, a)
    for sweep in range(1, sweeps + 1):
        change = 0.0
        for i in range(states):
            # Alternate directions: values travel along either order of the states in one sweep.
            x = i if sweep % 2 == 0 else states - 1 - i
            if sweep > 1 and not leads_to_moved(p, x, moved, sweep - 1):
                continue
            best.fill(-np.inf)
            for a in range(actions):
                if needless[x, a]:
                    continue
                back_up(p, x, a, value, new, spare)
                leave(p, x, a, value, new, spare)
                for y in range(hidden):
                    best[y] = max(best[y], new[y])
            step = 0.0
            for y in range(hidden):
                if best[y] > value[x, y]:
                    step = max(step, best[y] - value[x, y])
                    value[x, y] = best[y]
            if step > 0.0:
                moved[x] = sweep
            change = max(change, step)
        if change <= tolerance * (1.0 - p.discount):
            break
    short = 0.0
    for x in range(states):
        for a in range(actions):
            back_up(p, x, a, value, new, spare)
            for y in range(hidden):
                short = max(short, new[y] - value[x, y])
    most = extreme_value(p, 1.0)
    for x in range(states):
        for y in range(hidden):
            value[x, y] = min(value[x, y] + short / (1.0 - p.discount), most)
    q = np.empty((states, actions, hidden))
    for x in range(states):
        for a in range(actions):
            back_up(p, x, a, value, q[x, a], spare)
    return q


@bare
def is_needless(p: Problem, x: int, a: int) -> bool:
    """Whether an action before ``a`` leads where it leads in ``x`` and earns no less.

    With the hidden state known, actions that only look at it are such.
    """
    actions, hidden = p.reward.shape[1], p.reward.shape[2]
    first, last = p.edge_start[x * actions + a], p.edge_start[x * actions + a + 1]
    for other in range(a):
        start = p.edge_start[x * actions + other]
        alike = p.edge_start[x * actions + other + 1] - start == last - first
        for e in range(last - first):
            if not alike:
                break
            alike = (
                p.edge_next[first + e] == p.edge_next[start + e]
                and p.edge_map[first + e] == p.edge_map[start + e]
            )
        for y in range(hidden):
            if not alike:
                break
            alike = p.reward[x, other, y] >= p.reward[x, a, y]
        if alike:
            return True
    return False


@bare
def leads_to_moved(p: Problem, x: int, moved: IntArray, since: int) -> bool:
    """Whether ``x`` or a successor of it has ``moved`` ``[X]`` at or after ``since``."""
    if moved[x] >= since:
        return True
    actions = p.reward.shape[1]
    for e in range(p.edge_start[x * actions], p.edge_start[(x + 1) * actions]):
        if moved[p.edge_next[e]] >= since:
            return True
    return False


@bare
def back_up(
    p: Problem, x: int, a: int, value: FloatArray, out: FloatArray, spare: FloatArray
) -> None:
    """Write ``R(x, a, .) + gamma sum P(x', y' | x, ., a) value(x', y')`` to ``out`` ``[Y]``.

    ``spare`` ``[Y]`` is scratch.
    """
    for y in range(out.shape[0]):
        out[y] = p.reward[x, a, y]
    row = x * p.reward.shape[1] + a
    for e in range(p.edge_start[row], p.edge_start[row + 1]):
        pull(p, p.edge_map[e], p.discount, value[p.edge_next[e]], out, spare)


@bare
def leave(
    p: Problem, x: int, a: int, value: FloatArray, out: FloatArray, stays: FloatArray
) -> None:
    """Turn ``out`` ``[Y]``, the backed-up value of ``a`` once, into that of ``a`` until ``(x, y)``
    changes: all turns of the loop at once, which saves their sweeps.

    ``stays`` ``[Y]`` is scratch.
    """
    row = x * p.reward.shape[1] + a
    for e in range(p.edge_start[row], p.edge_start[row + 1]):
        if p.edge_next[e] != x:
            continue
        # Edges of one row lead to different states, so this is the only loop.
        staying(p, p.edge_map[e], stays)
        for y in range(out.shape[0]):
            stay = p.discount * stays[y]
            out[y] = (out[y] - stay * value[x, y]) / (1.0 - stay)


@kernel
def fast_informed_bound(
    p: Problem, q: FloatArray, tolerance: float, sweeps: int, work: int
) -> None:
    """Tighten ``q`` ``[X, A, Y]``, an upper bound such as `mdp_values`, in place.

    Stops in any case after about ``work`` products.
    """
    states, actions, hidden = p.reward.shape
    index = np.empty(hidden, dtype=np.int64)
    chance = np.empty(hidden)
    after = np.zeros((p.observations, actions))
    touched = np.zeros(p.observations, dtype=np.int64)
    maps = p.target.shape[0] if p.jumps else (p.row_start.shape[0] - 1) // hidden
    single = np.empty(maps, dtype=np.bool_)
    for k in range(maps):
        single[k] = is_single_valued(p, k, index, chance)
    new = np.empty(hidden)
    spare = np.empty(hidden)
    value = np.empty((states, hidden))
    for x in range(states):
        for y in range(hidden):
            value[x, y] = q[x, :, y].max()
    done = 0
    moved = np.zeros(states, dtype=np.int64)
    for sweep in range(1, sweeps + 1):
        change = 0.0
        for i in range(states):
            x = i if sweep % 2 == 0 else states - 1 - i
            if sweep > 1 and not leads_to_moved(p, x, moved, sweep - 1):
                continue
            if done > work:
                return
            step = 0.0
            for a in range(actions):
                if tells_nothing(p, x, a, single):
                    back_up(p, x, a, value, new, spare)
                else:
                    row = x * actions + a
                    for y in range(hidden):
                        new[y] = p.reward[x, a, y]
                    for e in range(p.edge_start[row], p.edge_start[row + 1]):
                        for y in range(hidden):
                            size = row_of(p, p.edge_map[e], y, index, chance)
                            done += size * actions
                            new[y] += p.discount * informed_step(
                                p, q, a, p.edge_next[e], index[:size], chance[:size], after, touched
                            )
                for y in range(hidden):
                    if new[y] < q[x, a, y]:
                        step = max(step, q[x, a, y] - new[y])
                        q[x, a, y] = new[y]
            for y in range(hidden):
                value[x, y] = q[x, :, y].max()
            if step > tolerance:
                moved[x] = sweep
            change = max(change, step)
        if change <= tolerance:
            break


@bare
def tells_nothing(p: Problem, x: int, a: int, single: BoolArray) -> bool:
    """Whether, the hidden state once known, no observation after ``a`` in ``x`` adds to it.

    ``single`` ``[K]`` says which maps are single-valued.
    """
    row = x * p.reward.shape[1] + a
    for e in range(p.edge_start[row], p.edge_start[row + 1]):
        if not single[p.edge_map[e]]:
            return False
    return True


@bare
def is_single_valued(p: Problem, k: int, index: IntArray, chance: FloatArray) -> bool:
    """Whether map ``k`` leads from every hidden state to one alone.

    ``index`` and ``chance`` ``[Y]`` are scratch.
    """
    for y in range(p.reward.shape[2]):
        if row_of(p, k, y, index, chance) > 1:
            return False
    return True


@bare
def informed_step(
    p: Problem,
    q: FloatArray,
    a: int,
    x: int,
    index: IntArray,
    chance: FloatArray,
    after: FloatArray,
    touched: IntArray,
) -> float:
    """``sum_o max_a' sum_y' chance(y') O(o | y') q(x, a', y')`` after action ``a`` led to ``x``.

    ``after`` ``[O, A]`` is zero before and after; ``touched`` ``[O]`` is scratch.
    """
    actions, hidden = q.shape[1], q.shape[2]
    count = 0
    first = p.table[a, x] * hidden
    for i in range(index.shape[0]):
        y = index[i]
        for j in range(p.seen_start[first + y], p.seen_start[first + y + 1]):
            o = p.seen[j]
            weight = chance[i] * p.seen_chance[j]
            known = False
            for t in range(count):
                if touched[t] == o:
                    known = True
                    break
            if not known:
                touched[count] = o
                count += 1
            for a_next in range(actions):
                after[o, a_next] += weight * q[x, a_next, y]
    total = 0.0
    for t in range(count):
        o = touched[t]
        best = after[o, 0]
        for a_next in range(actions):
            best = max(best, after[o, a_next])
            after[o, a_next] = 0.0
        total += best
    return total


@kernel
def policy_values(
    p: Problem, policy: IntArray, order: IntArray, tolerance: float, sweeps: int
) -> FloatArray:
    """``[X, Y]`` lower bounds of the value of taking action ``policy[x]`` in each ``x``.

    ``order`` ``[X]`` is that in which sweeps pass the states: best so that what follows a state
    comes before it.
    """
    states, _, hidden = p.reward.shape
    value = np.empty((states, hidden))
    value.fill(extreme_value(p, -1.0))
    new = np.empty(hidden)
    spare = np.empty(hidden)
    moved = np.zeros(states, dtype=np.int64)
    for sweep in range(1, sweeps + 1):
        change = 0.0
        for x in order:
            if sweep > 1 and not leads_to_moved(p, x, moved, sweep - 1):
                continue
            a = int(policy[x])
            back_up(p, x, a, value, new, spare)
            leave(p, x, a, value, new, spare)
            step = 0.0
            for y in range(hidden):
                step = max(step, new[y] - value[x, y])
                value[x, y] = new[y]
            if step > tolerance:
                moved[x] = sweep
            change = max(change, step)
        if change <= tolerance:
            break
    return value


def observed_policies(q: FloatArray, limit: int) -> list[tuple[IntArray, IntArray]]:
    """At most ``limit`` policies ``[X]`` of the observed state alone, each with an order of states.

    For some hidden states, evenly spread, the best policy if it were known and stayed; the order is
    that of its values, the highest first: what it leads to is worth more than where it comes from,
    discounting apart. Then every constant policy.
    """
    states, actions, hidden = q.shape
    count = min(KNOWN, limit, hidden)
    found: dict[bytes, tuple[IntArray, IntArray]] = {}
    for y in (i * (hidden - 1) // max(count - 1, 1) for i in range(count)):
        policy = np.argmax(q[:, :, y], axis=1).astype(np.int64)
        order = np.argsort(-q[:, :, y].max(axis=1), kind="stable").astype(np.int64)
        found.setdefault(policy.tobytes(), (policy, order))
    for a in range(actions):
        policy = np.full(states, a, dtype=np.int64)
        found.setdefault(policy.tobytes(), (policy, np.arange(states, dtype=np.int64)))
    return list(found.values())[:limit]
