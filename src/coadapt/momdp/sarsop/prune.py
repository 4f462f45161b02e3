"""Forgetting alpha vectors and upper-bound points that others have replaced."""

from __future__ import annotations

import numpy as np

from coadapt.momdp.sarsop.jit import kernel
from coadapt.momdp.sarsop.tree import NODES, NONE, POINTS, VECTORS, Tree


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
            new = tree.points[used]
            new["node"] = n
            new["drop"] = tree.points[i]["drop"]
            new["older"] = tree.newest_point[x]
            tree.newest_point[x] = used
            used += 1
        place[i] = used - 1
    for n in range(tree.used[NODES]):
        if tree.nodes[n]["points_seen"] != NONE:
            tree.nodes[n]["points_seen"] = place[tree.nodes[n]["points_seen"]]
    tree.used[POINTS] = used
