"""Growing the tree: nodes, their branches, and the beliefs that follow."""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.jit import bare, kernel
from coadapt.momdp.sarsop.bounds import lane_totals
from coadapt.momdp.sarsop.problem import Problem, push
from coadapt.momdp.sarsop.tree import BRANCHES, CHILDREN, ENTRIES, NODES, NONE, Scratch, Tree

NEGLIGIBLE = 1e-20
"""Belief entries below this are left out: too small to move a bound by a unit in the last place."""

SAME_BELIEF = 1e-13
"""Beliefs whose entries agree this closely are one node."""

HASHED = 64
"""About so many entries of a belief are hashed, evenly spread."""

GRID = 2.0**36
"""Beliefs are hashed by their entries rounded to this many steps."""

PRIME = 2147483647
"""Hashes are taken modulo this, so that no product overflows, compiled or not."""


SUPPORT_BITS = 62
"""A belief's support is kept modulo this, a bit for each remainder."""


@kernel
def plant(tree: Tree, x: int, index: IntArray, mass: FloatArray, scratch: Scratch) -> int:
    """`add_node` for Python to call."""
    return add_node(tree, x, index, mass, scratch)


@bare
def add_node(tree: Tree, x: int, index: IntArray, mass: FloatArray, scratch: Scratch) -> int:
    """The node of observed state ``x`` and the belief with ``mass`` on ``index``; new if need be.

    ``index`` increases; ``mass`` sums to 1. A new node starts from the informed bound and has yet
    to look at vectors and points.
    """
    size = index.shape[0]
    h = x + size
    for i in range(0, size, 1 + size // HASHED):
        h = (h * 1000003 + index[i] * 7919 + int(mass[i] * GRID + 0.5)) % PRIME
    h = h % tree.bucket.shape[0]
    n = int(tree.bucket[h]) - 1
    while n != NONE:
        if is_node(tree, n, x, index, mass):
            return n
        n = int(tree.nodes[n]["same_hash"])
    n = int(tree.used[NODES])
    first = tree.used[ENTRIES]
    tree.used[NODES] += 1
    tree.used[ENTRIES] += size
    corners = 0.0
    support = 0
    for i in range(size):
        support |= 1 << (index[i] % SUPPORT_BITS)
        tree.entry_y[first + i] = index[i]
        tree.entry_mass[first + i] = mass[i]
        corners += mass[i] * tree.corner[x, index[i]]
    informed = scratch.informed
    support_y, held = tree.entry_y[first : first + size], tree.entry_mass[first : first + size]
    lane_totals(tree.informed[x], support_y, held, informed)
    best = informed[0]
    for a in range(1, informed.shape[0]):
        best = max(best, informed[a])
    node = tree.nodes[n]
    node["x"] = x
    node["first_entry"] = first
    node["entries"] = size
    node["support"] = support
    node["first_branch"] = NONE
    node["point"] = NONE
    node["same_hash"] = tree.bucket[h] - 1
    node["lower"] = -np.inf
    node["vector"] = NONE
    node["vectors_seen"] = NONE
    node["upper"] = min(corners, best)
    node["points_seen"] = NONE
    node["corners"] = corners
    node["visits"] = 0
    tree.bucket[h] = n + 1
    return n


@bare
def is_node(tree: Tree, n: int, x: int, index: IntArray, mass: FloatArray) -> bool:
    """Whether node ``n`` is the belief with ``mass`` on ``index`` in observed state ``x``."""
    node = tree.nodes[n]
    if node["x"] != x or node["entries"] != index.shape[0]:
        return False
    first = node["first_entry"]
    for i in range(index.shape[0]):
        if (
            tree.entry_y[first + i] != index[i]
            or abs(tree.entry_mass[first + i] - mass[i]) > SAME_BELIEF
        ):
            return False
    return True


@bare
def open_node(p: Problem, tree: Tree, n: int, scratch: Scratch) -> None:
    """Give node ``n`` its branches, bounded by the informed bound."""
    actions = p.reward.shape[1]
    node = tree.nodes[n]
    x = node["x"]
    r = tree.used[BRANCHES]
    tree.used[BRANCHES] += actions
    node["first_branch"] = r
    first = node["first_entry"]
    last = first + node["entries"]
    informed = scratch.informed
    lane_totals(tree.informed[x], tree.entry_y[first:last], tree.entry_mass[first:last], informed)
    for a in range(actions):
        reward = 0.0
        for i in range(first, last):
            reward += tree.entry_mass[i] * p.reward[x, a, tree.entry_y[i]]
        branch = tree.branches[r + a]
        branch["node"] = n
        branch["reward"] = reward
        branch["upper"] = informed[a]
        branch["first_child"] = NONE
        branch["children"] = 0


@bare
def expand_branch(p: Problem, tree: Tree, n: int, a: int, scratch: Scratch) -> None:
    """Give branch ``a`` of node ``n`` its children: every successor and observation."""
    _, actions, hidden = p.reward.shape
    node = tree.nodes[n]
    first = node["first_entry"]
    last = first + node["entries"]
    branch = tree.branches[node["first_branch"] + a]
    branch["first_child"] = tree.used[CHILDREN]
    pushed, chance = scratch.pushed, scratch.chance
    begin, end = scratch.begin, scratch.end  # where the entries of each child begin and end
    index, mass = scratch.seen, scratch.part
    row = node["x"] * actions + a
    for e in range(p.edge_start[row], p.edge_start[row + 1]):
        x_next = p.edge_next[e]
        support, held = tree.entry_y[first:last], tree.entry_mass[first:last]
        push(p, p.edge_map[e], support, held, pushed, scratch.spare)
        # How likely is each observation, and on how many hidden states does it lie?
        chance[:] = 0.0
        end[:] = 0
        table = p.table[a, x_next] * hidden
        for y in range(hidden):
            if pushed[y] > 0.0:
                for j in range(p.seen_start[table + y], p.seen_start[table + y + 1]):
                    chance[p.seen[j]] += pushed[y] * p.seen_chance[j]
                    end[p.seen[j]] += 1
        total = 0
        for o in range(p.observations):
            begin[o] = total
            total += end[o]
            end[o] = begin[o]
        for y in range(hidden):
            if pushed[y] > 0.0:
                for j in range(p.seen_start[table + y], p.seen_start[table + y + 1]):
                    o = p.seen[j]
                    part = pushed[y] * p.seen_chance[j] / chance[o] if chance[o] > 0.0 else 0.0
                    if part > NEGLIGIBLE:
                        index[end[o]] = y
                        mass[end[o]] = part
                        end[o] += 1
        for o in range(p.observations):
            if end[o] > begin[o]:
                c = tree.used[CHILDREN]
                tree.used[CHILDREN] += 1
                child = tree.children[c]
                at, to = begin[o], end[o]
                child["node"] = add_node(tree, x_next, index[at:to], mass[at:to], scratch)
                child["probability"] = chance[o]
                child["edge"] = e
                child["observation"] = o
    branch["children"] = tree.used[CHILDREN] - branch["first_child"]
