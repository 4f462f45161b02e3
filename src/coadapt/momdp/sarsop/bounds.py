"""Bounds of one node from alpha vectors and upper-bound points, looking only at what is new."""

from __future__ import annotations

from coadapt.arrays import FloatArray
from coadapt.momdp.sarsop.jit import kernel
from coadapt.momdp.sarsop.tree import NONE, POINTS, VECTORS, Tree


@kernel
def refresh_lower(tree: Tree, n: int) -> float:
    """Raise the lower bound of node ``n`` by the alpha vectors it has not seen: max b . alpha."""
    x = tree.node_x[n]
    newest = tree.newest_vector[x]
    seen = tree.vectors_seen[n]
    if newest != seen:
        first = tree.entry_start[n]
        last = first + tree.entry_count[n]
        v = newest
        while v > seen:
            total = 0.0
            for i in range(first, last):
                total += tree.entry_mass[i] * tree.alpha[v, tree.entry_y[i]]
            if total > tree.lower[n]:
                tree.lower[n] = total
                tree.vector[n] = v
            v = tree.older_vector[v]
        tree.vectors_seen[n] = newest
    return tree.lower[n]


@kernel
def refresh_upper(tree: Tree, n: int, scratch: FloatArray) -> float:
    """Lower the upper bound of node ``n`` by the points it has not seen (sawtooth).

    A point ``(b', v')`` bounds ``V(b) <= c(b) - (c(b') - v') min_{y: b'(y) > 0} b(y) / b'(y)``,
    where ``c`` interpolates the corners. ``scratch`` ``[Y]`` is zero before and after.
    """
    x = tree.node_x[n]
    newest = tree.newest_point[x]
    seen = tree.points_seen[n]
    if newest == seen:
        return tree.upper[n]
    first = tree.entry_start[n]
    last = first + tree.entry_count[n]
    for i in range(first, last):
        scratch[tree.entry_y[i]] = tree.entry_mass[i]
    corners = tree.corners[n]
    i_point = newest
    while i_point > seen:
        drop = tree.point_drop[i_point]
        needed = (corners - tree.upper[n]) / drop  # smallest ratio that would improve the bound
        if needed < 1.0:
            m = tree.point_node[i_point]
            start = tree.entry_start[m]
            ratio = 1.0
            for j in range(start, start + tree.entry_count[m]):
                mass = scratch[tree.entry_y[j]]
                if mass <= needed * tree.entry_mass[j]:
                    ratio = needed
                    break
                ratio = min(ratio, mass / tree.entry_mass[j])
            if ratio > needed:
                tree.upper[n] = corners - drop * ratio
        i_point = tree.older_point[i_point]
    for i in range(first, last):
        scratch[tree.entry_y[i]] = 0.0
    tree.points_seen[n] = newest
    return tree.upper[n]


@kernel
def add_vector(tree: Tree, x: int, alpha: FloatArray, action: int) -> int:
    """Append alpha vector ``alpha`` ``[Y]`` of observed state ``x``; its index.

    Older vectors that lie nowhere above it leave the list. Nodes that hold one keep their bound;
    so does the policy, since whatever followed such a vector may follow the new one.
    """
    v = tree.used[VECTORS]
    tree.used[VECTORS] += 1
    tree.alpha[v] = alpha
    tree.vector_x[v] = x
    tree.action[v] = action
    tree.replaced_by[v] = NONE
    tree.older_vector[v] = tree.newest_vector[x]
    tree.newest_vector[x] = v
    previous = v
    u = tree.older_vector[v]
    while u != NONE:
        above = False
        for y in range(alpha.shape[0]):
            if tree.alpha[u, y] > alpha[y]:
                above = True
                break
        if above:
            previous = u
        else:
            tree.replaced_by[u] = v
            tree.older_vector[previous] = tree.older_vector[u]
        u = tree.older_vector[u]
    return v


@kernel
def add_point(tree: Tree, n: int) -> None:
    """Append the belief of node ``n`` with its upper bound as a point for others to use."""
    drop = tree.corners[n] - tree.upper[n]
    if drop <= 0.0:
        return
    x = tree.node_x[n]
    i = tree.used[POINTS]
    tree.used[POINTS] += 1
    tree.point_node[i] = n
    tree.point_drop[i] = drop
    tree.older_point[i] = tree.newest_point[x]
    tree.newest_point[x] = i
