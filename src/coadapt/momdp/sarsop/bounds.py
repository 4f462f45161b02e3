"""Bounds of one node from alpha vectors and upper-bound points, looking only at what is new."""

from __future__ import annotations

from typing import Any

from coadapt.arrays import FloatArray, Int32Array, IntArray
from coadapt.jit import bare, kernel
from coadapt.momdp.sarsop.tree import (
    BLOCK,
    GROUPS,
    LISTED,
    LISTED_POINTS,
    NONE,
    POINTS,
    VECTORS,
    Scratch,
    Tree,
)


@bare
def refresh_lower(tree: Tree, n: int, scratch: Scratch) -> float:
    """Raise the lower bound of node ``n`` by the alpha vectors it has not seen: max b . alpha."""
    node = tree.nodes[n]
    x = node["x"]
    seen = node["vectors_seen"]
    if tree.newest_vector[x] > seen:
        node["vectors_seen"] = tree.newest_vector[x]
        first = node["first_entry"]
        last = first + node["entries"]
        totals = scratch.totals
        g = tree.newest_group[x]
        while g != NONE and tree.groups[g]["newest"] > seen:
            filled = tree.groups[g]["filled"]
            lane_totals(
                tree.lane_alpha[g],
                tree.entry_y[first:last],
                tree.entry_mass[first:last],
                totals[:filled],
            )
            for k in range(filled):
                if totals[k] > node["lower"]:
                    node["lower"] = totals[k]
                    node["vector"] = tree.lane_vector[g, k]
            g = tree.groups[g]["older"]
    return node["lower"]


@bare
def lane_totals(alpha: FloatArray, index: Int32Array, mass: FloatArray, totals: FloatArray) -> None:
    """Write ``sum_i mass(i) alpha(index(i), .)`` to ``totals``.

    Four terms at a time, in their order: so totals are read and written a quarter as often.
    """
    lanes = totals.shape[0]
    for k in range(lanes):
        totals[k] = 0.0
    together = mass.shape[0] - mass.shape[0] % 4
    for i in range(0, together, 4):
        a, b, c, d = mass[i], mass[i + 1], mass[i + 2], mass[i + 3]
        row_a, row_b = alpha[index[i]], alpha[index[i + 1]]
        row_c, row_d = alpha[index[i + 2]], alpha[index[i + 3]]
        for k in range(lanes):
            total = totals[k] + a * row_a[k]
            total += b * row_b[k]
            total += c * row_c[k]
            totals[k] = total + d * row_d[k]
    for i in range(together, mass.shape[0]):
        a, row_a = mass[i], alpha[index[i]]
        for k in range(lanes):
            totals[k] += a * row_a[k]


@bare
def refresh_upper(tree: Tree, n: int, scratch: Scratch) -> float:
    """Lower the upper bound of node ``n`` by the points it has not seen (sawtooth).

    A point ``(b', v')`` bounds ``V(b) <= c(b) - (c(b') - v') min_{y: b'(y) > 0} b(y) / b'(y)``,
    where ``c`` interpolates the corners.
    """
    node = tree.nodes[n]
    i_point = tree.newest_point[node["x"]]
    seen = node["points_seen"]
    if i_point <= seen:
        return node["upper"]
    node["points_seen"] = i_point
    first = node["first_entry"]
    last = first + node["entries"]
    mass, useful = scratch.mass, scratch.useful
    for i in range(first, last):
        mass[tree.entry_y[i]] = tree.entry_mass[i]
    below = node["corners"] - node["upper"]
    outside = ~node["support"]
    while i_point > seen:
        oldest = max(seen + 1, i_point - i_point % BLOCK)
        size = 0
        for i in range(i_point, oldest - 1, -1):
            useful[size] = i
            size += int(may_help(tree.points[i], below, outside, mass))
        for j in range(size):
            below = max(below, drop_by(tree, useful[j], below, mass))
        i_point = tree.points[oldest]["older"]
    for i in range(first, last):
        mass[tree.entry_y[i]] = 0.0
    lower_upper(tree, n, node["corners"] - below)
    return node["upper"]


@bare
def may_help(point: Any, above: float, outside: int, mass: FloatArray) -> bool:
    """Whether ``point`` could bring the bound more than ``above`` below the corners.

    ``outside`` is the complement of the support of the belief ``mass`` ``[Y]``. Where a point
    failed before it fails most often: two looks instead of many. No branches, since none could be
    foreseen.
    """
    drop = point["drop"]
    return (
        (drop > above)
        & (point["support"] & outside == 0)
        & (mass[point["last_y"]] * drop > above * point["last_mass"])
        & (mass[point["other_y"]] * drop > above * point["other_mass"])
    )


@bare
def drop_by(tree: Tree, i: int, above: float, mass: FloatArray) -> float:
    """How far below the corners point ``i`` brings the bound at the belief ``mass`` ``[Y]``.

    0 unless it is more than ``above``; then the point remembers the hidden state that told.
    """
    point = tree.points[i]
    first = int(point["first_entry"])
    ratio = 1.0
    needed = above / point["drop"]  # smallest ratio of interest
    for j in range(first, first + int(point["entries"])):
        here = mass[tree.entry_y[j]]
        if here <= needed * tree.entry_mass[j]:
            point["other_y"], point["other_mass"] = point["last_y"], point["last_mass"]
            point["last_y"], point["last_mass"] = tree.entry_y[j], tree.entry_mass[j]
            return 0.0
        ratio = min(ratio, here / tree.entry_mass[j])
    return ratio * point["drop"]


@bare
def lower_upper(tree: Tree, n: int, upper: float) -> None:
    """Set the upper bound of node ``n`` to ``upper`` if that is less, and that of its point."""
    node = tree.nodes[n]
    if upper < node["upper"]:
        node["upper"] = upper
        if node["point"] != NONE:
            tree.points[node["point"]]["drop"] = node["corners"] - upper


@bare
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
def add_vectors(tree: Tree, x: IntArray, values: FloatArray, actions: IntArray) -> None:
    """Append the alpha vectors ``values`` ``[V, Y]`` of the observed states ``x`` ``[V]`` with
    their ``actions`` ``[V]``."""
    for i in range(values.shape[0]):
        add_vector(tree, x[i], values[i], actions[i])


@bare
def add_lane(tree: Tree, x: int, v: int) -> None:
    """Put alpha vector ``v`` into the newest group of observed state ``x``, or a new one."""
    g = tree.newest_group[x]
    if g == NONE or tree.groups[g]["filled"] == tree.lane_alpha.shape[2]:
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


@bare
def add_point(tree: Tree, n: int) -> None:
    """Append the belief of node ``n`` with its upper bound as a point for others to use."""
    node = tree.nodes[n]
    drop = node["corners"] - node["upper"]
    if drop <= 0.0:
        return
    i = place_of_point(tree, int(tree.newest_point[node["x"]]))
    point = tree.points[i]
    point["node"] = n
    point["first_entry"] = node["first_entry"]
    point["entries"] = node["entries"]
    point["support"] = node["support"]
    point["drop"] = drop
    point["last_y"] = point["other_y"] = tree.entry_y[node["first_entry"]]
    point["last_mass"] = point["other_mass"] = tree.entry_mass[node["first_entry"]]
    point["older"] = tree.newest_point[node["x"]]
    tree.newest_point[node["x"]] = i
    node["point"] = i
    tree.used[LISTED_POINTS] += 1


@bare
def place_of_point(tree: Tree, newest: int) -> int:
    """Where the point after ``newest`` of its observed state goes: beside it, or to a new block."""
    if newest != NONE and newest % BLOCK != BLOCK - 1:
        return newest + 1
    i = int(tree.used[POINTS])
    tree.used[POINTS] += BLOCK
    return i
