"""Forgetting alpha vectors and upper-bound points that others have replaced."""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.jit import bare, kernel
from coadapt.momdp.sarsop.bounds import add_lane, drop_by, may_help, place_of_point
from coadapt.momdp.sarsop.tree import (
    GROUPS,
    KEPT,
    KEPT_POINTS,
    LISTED,
    LISTED_POINTS,
    NODES,
    NONE,
    POINTS,
    VECTORS,
    Records,
    Tree,
)


@kernel
def retire_vectors(tree: Tree) -> None:
    """Leave out of the look-up the alpha vectors at which no opened node has its bound.

    They stay where they are, for nodes that hold them and for the policy.
    """
    count = int(tree.used[VECTORS])
    wanted = np.zeros(count, dtype=np.bool_)
    for n in range(tree.used[NODES]):
        node = tree.nodes[n]
        if node["vector"] != NONE and node["first_branch"] != NONE:
            v = node["vector"]
            while tree.vectors[v]["replaced_by"] != NONE:
                v = tree.vectors[v]["replaced_by"]
            wanted[v] = True
    kept = 0
    for x in range(tree.newest_vector.shape[0]):
        # The newest stays: nodes ask by it whether there is something new.
        previous = tree.newest_vector[x]
        if previous != NONE:
            kept += 1
            v = tree.vectors[previous]["older"]
            while v != NONE:
                if wanted[v]:
                    tree.vectors[previous]["older"] = v
                    previous = v
                    kept += 1
                v = tree.vectors[v]["older"]
            tree.vectors[previous]["older"] = NONE
    regroup(tree, np.empty(count, dtype=np.int64))
    tree.used[LISTED] = tree.used[KEPT] = kept


@bare
def regroup(tree: Tree, stack: IntArray) -> None:
    """Fill the groups anew from the lists of alpha vectors, the oldest first.

    ``stack`` is scratch with a place for each vector.
    """
    tree.used[GROUPS] = 0
    for x in range(tree.newest_vector.shape[0]):
        tree.newest_group[x] = NONE
        size = 0
        v = tree.newest_vector[x]
        while v != NONE:
            stack[size] = v
            size += 1
            v = tree.vectors[v]["older"]
        for i in range(size - 1, -1, -1):
            add_lane(tree, x, stack[i])


@kernel
def prune_vectors(tree: Tree) -> None:
    """Drop the alpha vectors that another one replaced, keeping the order of the rest."""
    count = int(tree.used[VECTORS])
    place = np.empty(count, dtype=np.int64)  # where the newest vector kept so far, up to v, goes
    used = 0
    for v in range(count):
        if tree.vectors[v]["replaced_by"] == NONE:
            used += 1
        place[v] = used - 1
    for n in range(tree.used[NODES]):
        node = tree.nodes[n]
        v = node["vector"]
        if v != NONE:
            while tree.vectors[v]["replaced_by"] != NONE:
                v = tree.vectors[v]["replaced_by"]
            node["vector"] = place[v]
        if node["vectors_seen"] != NONE:
            node["vectors_seen"] = place[node["vectors_seen"]]
    for v in range(count):
        if tree.vectors[v]["replaced_by"] == NONE:
            # A vector in a list points to another in it, so to one that stays.
            old = tree.vectors[v]
            new = tree.vectors[place[v]]
            older = old["older"]
            new["x"] = old["x"]
            new["action"] = old["action"]
            new["older"] = NONE if older == NONE else place[older]
            for y in range(tree.alpha.shape[1]):
                tree.alpha[place[v], y] = tree.alpha[v, y]
    for v in range(used):
        tree.vectors[v]["replaced_by"] = NONE
    for x in range(tree.newest_vector.shape[0]):
        if tree.newest_vector[x] != NONE:
            tree.newest_vector[x] = place[tree.newest_vector[x]]
    tree.used[VECTORS] = used
    regroup(tree, np.empty(count, dtype=np.int64))


SMALL_PART = 0.002
"""Of the gap at a point: how much it must tighten the bound there."""


@bare
def is_superfluous(tree: Tree, others: IntArray, j: int, mass: FloatArray) -> bool:
    """Whether another of the points ``others`` does what the ``j``-th does, or nearly.

    ``mass`` ``[Y]`` is zero before and after.
    """
    point = tree.points[others[j]]
    node = tree.nodes[point["node"]]
    enough = float(point["drop"] - SMALL_PART * (node["upper"] - node["lower"]))
    if enough <= 0.0:
        return True
    outside = ~int(node["support"])
    first = node["first_entry"]
    last = first + node["entries"]
    for i in range(first, last):
        mass[tree.entry_y[i]] = tree.entry_mass[i]
    found = False
    for other in others:
        if (
            other != NONE
            and other != others[j]
            and may_help(tree.points[other], enough, outside, mass)
            and drop_by(tree, other, enough, mass) > 0.0
        ):
            found = True
            break
    for i in range(first, last):
        mass[tree.entry_y[i]] = 0.0
    return found


@kernel
def retire_points(tree: Tree) -> None:
    """Drop the points that the others make superfluous; the rest move together, in their order.

    A node's own bound stays. What is lost elsewhere is at most a small part of the gap there.
    """
    mass = np.zeros(tree.corner.shape[1])
    stack = np.empty(tree.used[POINTS], dtype=np.int64)
    for x in range(tree.newest_point.shape[0]):
        size = 0
        i = tree.newest_point[x]
        while i != NONE:
            if tree.nodes[tree.points[i]["node"]]["point"] == i:
                stack[size] = i
                size += 1
            i = tree.points[i]["older"]
        for j in range(size - 1, -1, -1):
            if is_superfluous(tree, stack[:size], j, mass):
                tree.nodes[tree.points[stack[j]]["node"]]["point"] = NONE
                stack[j] = NONE
    count = int(tree.used[POINTS])
    close_ranks(tree, tree.points[:count].copy(), stack, np.empty(count, dtype=np.int64))


@bare
def close_ranks(tree: Tree, old: Records, stack: IntArray, place: IntArray) -> None:
    """Lay out anew those of the points ``old`` that are their nodes' own.

    ``stack`` and ``place`` are scratch for as many; ``place`` is where the newest one kept, up to
    each, goes.
    """
    tree.used[POINTS] = 0
    kept = 0
    for x in range(tree.newest_point.shape[0]):
        size = 0
        i = tree.newest_point[x]
        while i != NONE:
            stack[size] = i
            size += 1
            i = old[i]["older"]
        newest = NONE
        for j in range(size - 1, -1, -1):
            i = stack[j]
            node = tree.nodes[old[i]["node"]]
            if node["point"] == i:
                here = place_of_point(tree, newest)
                tree.points[here] = old[i]
                tree.points[here]["older"] = newest
                node["point"] = here
                newest = here
                kept += 1
            place[i] = newest
        tree.newest_point[x] = newest
    for n in range(tree.used[NODES]):
        if tree.nodes[n]["points_seen"] != NONE:
            tree.nodes[n]["points_seen"] = place[tree.nodes[n]["points_seen"]]
    tree.used[LISTED_POINTS] = tree.used[KEPT_POINTS] = kept
