"""Forgetting alpha vectors and upper-bound points that others have replaced."""

from __future__ import annotations

import numpy as np

from coadapt.momdp.sarsop.bounds import add_lane
from coadapt.momdp.sarsop.jit import kernel
from coadapt.momdp.sarsop.tree import GROUPS, KEPT, LISTED, NODES, NONE, POINTS, VECTORS, Tree


@kernel
def retire_vectors(tree: Tree) -> None:
    """Leave out of the look-up the alpha vectors at which no node has its bound.

    They stay where they are, for nodes that hold them and for the policy.
    """
    count = tree.used[VECTORS]
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
    regroup(tree)
    tree.used[LISTED] = tree.used[KEPT] = kept


@kernel
def regroup(tree: Tree) -> None:
    """Fill the groups anew from the lists of alpha vectors, the oldest first."""
    stack = np.empty(tree.used[VECTORS], dtype=np.int64)
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
    count = tree.used[VECTORS]
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
    regroup(tree)


@kernel
def prune_points(tree: Tree) -> None:
    """Keep for each node its latest point alone, in order."""
    count = tree.used[POINTS]
    latest = np.empty(tree.used[NODES], dtype=np.int64)
    for i in range(count):
        latest[tree.points[i]["node"]] = i
    place = np.empty(count, dtype=np.int64)
    used = 0
    for x in range(tree.newest_point.shape[0]):
        tree.newest_point[x] = NONE
    for i in range(count):
        n = tree.points[i]["node"]
        if latest[n] == i:
            x = tree.nodes[n]["x"]
            old = tree.points[i]
            new = tree.points[used]
            new["node"] = n
            new["first_entry"] = old["first_entry"]
            new["entries"] = old["entries"]
            new["support"] = old["support"]
            new["drop"] = old["drop"]
            tree.nodes[n]["point"] = used
            new["older"] = tree.newest_point[x]
            tree.newest_point[x] = used
            used += 1
        place[i] = used - 1
    for n in range(tree.used[NODES]):
        if tree.nodes[n]["points_seen"] != NONE:
            tree.nodes[n]["points_seen"] = place[tree.nodes[n]["points_seen"]]
    tree.used[POINTS] = used
