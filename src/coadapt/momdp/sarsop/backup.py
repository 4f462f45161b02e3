"""Point-based backup of both bounds at one node."""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.momdp.sarsop.bounds import add_point, add_vector, refresh_lower, refresh_upper
from coadapt.momdp.sarsop.jit import kernel
from coadapt.momdp.sarsop.problem import Problem, pull
from coadapt.momdp.sarsop.tree import BACKUPS, NONE, Tree, expand_branch

GAIN = 1e-12
"""A bound moved when it moved by more than this part of its size."""


@kernel
def backup_upper(p: Problem, tree: Tree, n: int, scratch: FloatArray) -> int:
    """Tighten the upper bounds of the actions of opened node ``n``; the action with the largest.

    Only the action that leads is looked at, again and again until it leads by an up-to-date
    bound: the others' old bounds are bounds still.
    """
    actions = p.reward.shape[1]
    r = tree.first_branch[n]
    current = np.zeros(actions, dtype=np.bool_)
    while True:
        best = 0
        for a in range(1, actions):
            if tree.branch_upper[r + a] > tree.branch_upper[r + best]:
                best = a
        if current[best]:
            break
        if tree.first_child[r + best] == NONE:
            expand_branch(p, tree, n, best)
        total = tree.branch_reward[r + best]
        first = tree.first_child[r + best]
        for c in range(first, first + tree.child_count[r + best]):
            upper = refresh_upper(tree, tree.child_node[c], scratch)
            total += p.discount * tree.child_probability[c] * upper
        tree.branch_upper[r + best] = min(tree.branch_upper[r + best], total)
        current[best] = True
    leading = tree.branch_upper[r + best]
    if leading < tree.upper[n] - GAIN * (1.0 + abs(leading)):
        tree.upper[n] = leading
        add_point(tree, n)
    return best


@kernel
def backup_lower(p: Problem, tree: Tree, n: int) -> None:
    """Add the alpha vector of the best action at opened node ``n``, if it raises the bound."""
    actions = p.reward.shape[1]
    r = tree.first_branch[n]
    refresh_lower(tree, n)
    best = NONE
    best_value = tree.lower[n] + GAIN * (1.0 + abs(tree.lower[n]))
    for a in range(actions):
        if tree.branch_upper[r + a] <= best_value:
            continue
        if tree.first_child[r + a] == NONE:
            expand_branch(p, tree, n, a)
        value = q_lower(p, tree, r + a)
        if value > best_value:
            best = a
            best_value = value
    if best != NONE:
        v = add_vector(tree, tree.node_x[n], backed_up_vector(p, tree, n, best), best)
        tree.vector[n] = v
        refresh_lower(tree, n)
    tree.used[BACKUPS] += 1


@kernel
def q_lower(p: Problem, tree: Tree, branch: int) -> float:
    """Lower bound of ``Q`` of an expanded branch, from the bounds of its children."""
    total = tree.branch_reward[branch]
    first = tree.first_child[branch]
    for c in range(first, first + tree.child_count[branch]):
        total += p.discount * tree.child_probability[c] * refresh_lower(tree, tree.child_node[c])
    return total


@kernel
def backed_up_vector(p: Problem, tree: Tree, n: int, a: int) -> FloatArray:
    """``[Y]`` the value of taking ``a`` in node ``n`` and then what is best at each child.

    ``alpha(y) = R(x, a, y) + gamma sum_{x', y'} P(x', y' | x, y, a) sum_o O(o | y') alpha_o(y')``
    where ``alpha_o`` is the vector of the child reached by ``(x', o)``. Where the belief gives
    ``(x', o)`` no probability any vector of x' serves.
    """
    x = tree.node_x[n]
    hidden = p.reward.shape[2]
    alpha = p.reward[x, a].copy()
    mixed = np.empty(hidden)
    row = x * p.reward.shape[1] + a
    r = tree.first_branch[n] + a
    c = tree.first_child[r]
    last = c + tree.child_count[r]
    for e in range(p.edge_start[row], p.edge_start[row + 1]):
        x_next = p.edge_next[e]
        table = p.observation[p.observation_index[a, x_next]]
        stand_in = tree.newest_vector[x_next]
        likeliest = 0.0
        for i in range(c, last):
            if tree.child_edge[i] == e and tree.child_probability[i] > likeliest:
                likeliest = tree.child_probability[i]
                stand_in = tree.vector[tree.child_node[i]]
        mixed[:] = 0.0
        for o in range(table.shape[0]):
            v = stand_in
            if c < last and tree.child_edge[c] == e and tree.child_observation[c] == o:
                v = tree.vector[tree.child_node[c]]
                c += 1
            for y in range(hidden):
                mixed[y] += table[o, y] * tree.alpha[v, y]
        pull(p, p.edge_map[e], p.discount, mixed, alpha)
    return alpha
