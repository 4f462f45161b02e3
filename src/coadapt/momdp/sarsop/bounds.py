"""Bounds of one node from alpha vectors and upper-bound points, looking only at what is new."""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.momdp.sarsop.jit import inner, kernel
from coadapt.momdp.sarsop.tree import (
    GROUPS,
    LANES,
    LISTED,
    LISTED_POINTS,
    NONE,
    POINTS,
    VECTORS,
    Tree,
)


@kernel
def refresh_lower(tree: Tree, n: int) -> float:
    """Raise the lower bound of node ``n`` by the alpha vectors it has not seen: max b . alpha."""
    node = tree.nodes[n]
    x = node["x"]
    seen = node["vectors_seen"]
    if tree.newest_vector[x] > seen:
        node["vectors_seen"] = tree.newest_vector[x]
        first = node["first_entry"]
        last = first + node["entries"]
        totals = np.empty(LANES)
        g = tree.newest_group[x]
        while g != NONE and tree.groups[g]["newest"] > seen:
            totals[:] = 0.0
            for i in range(first, last):
                mass = tree.entry_mass[i]
                y = tree.entry_y[i]
                for k in range(LANES):
                    totals[k] += mass * tree.lane_alpha[g, y, k]
            for k in range(tree.groups[g]["filled"]):
                if totals[k] > node["lower"]:
                    node["lower"] = totals[k]
                    node["vector"] = tree.lane_vector[g, k]
            g = tree.groups[g]["older"]
    return node["lower"]


@kernel
def refresh_upper(tree: Tree, n: int, scratch: FloatArray) -> float:
    """Lower the upper bound of node ``n`` by the points it has not seen (sawtooth).

    A point ``(b', v')`` bounds ``V(b) <= c(b) - (c(b') - v') min_{y: b'(y) > 0} b(y) / b'(y)``,
    where ``c`` interpolates the corners. ``scratch`` ``[Y]`` is zero before and after.
    """
    node = tree.nodes[n]
    i_point = tree.newest_point[node["x"]]
    seen = node["points_seen"]
    if i_point <= seen:
        return node["upper"]
    node["points_seen"] = i_point
    first = node["first_entry"]
    last = first + node["entries"]
    for i in range(first, last):
        scratch[tree.entry_y[i]] = tree.entry_mass[i]
    below = node["corners"] - node["upper"]
    outside = ~node["support"]
    while i_point > seen:
        point = tree.points[i_point]
        if point["drop"] > below and point["support"] & outside == 0:
            below = max(below, drop_by(tree, int(i_point), below, scratch))
        i_point = point["older"]
    for i in range(first, last):
        scratch[tree.entry_y[i]] = 0.0
    lower_upper(tree, n, node["corners"] - below)
    return node["upper"]


@inner
def drop_by(tree: Tree, i: int, above: float, mass: FloatArray) -> float:
    """How far below the corners point ``i`` brings the bound at the belief ``mass`` ``[Y]``.

    0 unless it is more than ``above``.
    """
    point = tree.points[i]
    first = point["first_entry"]
    ratio = 1.0
    needed = above / point["drop"]  # smallest ratio of interest
    for j in range(first, first + point["entries"]):
        here = mass[tree.entry_y[j]]
        if here <= needed * tree.entry_mass[j]:
            return 0.0
        ratio = min(ratio, here / tree.entry_mass[j])
    return ratio * point["drop"]


@inner
def lower_upper(tree: Tree, n: int, upper: float) -> None:
    """Set the upper bound of node ``n`` to ``upper`` if that is less, and that of its point."""
    node = tree.nodes[n]
    if upper < node["upper"]:
        node["upper"] = upper
        if node["point"] != NONE:
            tree.points[node["point"]]["drop"] = node["corners"] - upper


@kernel
def add_vector(tree: Tree, x: int, alpha: FloatArray, action: int) -> int:
    """Append alpha vector ``alpha`` ``[Y]`` of observed state ``x``; its index.

    Older vectors that lie nowhere above it leave the list. Nodes that hold one keep their bound;
    so does the policy, since whatever followed such a vector may follow the new one.
    """
    v = tree.used[VECTORS]
    tree.used[VECTORS] += 1
    for y in range(alpha.shape[0]):
        tree.alpha[v, y] = alpha[y]
    vector = tree.vectors[v]
    vector["x"] = x
    vector["action"] = action
    vector["replaced_by"] = NONE
    vector["older"] = tree.newest_vector[x]
    tree.newest_vector[x] = v
    add_lane(tree, x, v)
    tree.used[LISTED] += 1
    previous = v
    u = vector["older"]
    while u != NONE:
        above = False
        for y in range(alpha.shape[0]):
            if tree.alpha[u, y] > alpha[y]:
                above = True
                break
        older = tree.vectors[u]["older"]
        if above:
            previous = u
        else:
            tree.used[LISTED] -= 1
            tree.vectors[u]["replaced_by"] = v
            tree.vectors[previous]["older"] = older
        u = older
    return v


@kernel
def add_vectors(tree: Tree, values: FloatArray, actions: IntArray) -> None:
    """Append the alpha vectors ``values`` ``[X, Y]``, one for each observed state, with their
    ``actions`` ``[X]``."""
    for x in range(values.shape[0]):
        add_vector(tree, x, values[x], actions[x])


@inner
def add_lane(tree: Tree, x: int, v: int) -> None:
    """Put alpha vector ``v`` into the newest group of observed state ``x``, or a new one."""
    g = tree.newest_group[x]
    if g == NONE or tree.groups[g]["filled"] == LANES:
        g = tree.used[GROUPS]
        tree.used[GROUPS] += 1
        tree.groups[g]["filled"] = 0
        tree.groups[g]["older"] = tree.newest_group[x]
        tree.newest_group[x] = g
    k = tree.groups[g]["filled"]
    tree.groups[g]["filled"] += 1
    tree.groups[g]["newest"] = v
    tree.lane_vector[g, k] = v
    for y in range(tree.alpha.shape[1]):
        tree.lane_alpha[g, y, k] = tree.alpha[v, y]


@inner
def add_point(tree: Tree, n: int) -> None:
    """Append the belief of node ``n`` with its upper bound as a point for others to use."""
    node = tree.nodes[n]
    drop = node["corners"] - node["upper"]
    if drop <= 0.0:
        return
    i = tree.used[POINTS]
    tree.used[POINTS] += 1
    point = tree.points[i]
    point["node"] = n
    point["first_entry"] = node["first_entry"]
    point["entries"] = node["entries"]
    point["support"] = node["support"]
    point["drop"] = drop
    point["older"] = tree.newest_point[node["x"]]
    tree.newest_point[node["x"]] = i
    node["point"] = i
    tree.used[LISTED_POINTS] += 1
