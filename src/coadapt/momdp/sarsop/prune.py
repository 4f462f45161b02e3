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
        if tree.replaced_by[v] == NONE:
            used += 1
        place[v] = used - 1
    for n in range(tree.used[NODES]):
        v = tree.vector[n]
        if v != NONE:
            while tree.replaced_by[v] != NONE:
                v = tree.replaced_by[v]
            tree.vector[n] = place[v]
        if tree.vectors_seen[n] != NONE:
            tree.vectors_seen[n] = place[tree.vectors_seen[n]]
    for v in range(count):
        if tree.replaced_by[v] == NONE:
            # A vector in a list points to another in it, so to one that stays.
            older = tree.older_vector[v]
            w = place[v]
            tree.alpha[w] = tree.alpha[v]
            tree.vector_x[w] = tree.vector_x[v]
            tree.action[w] = tree.action[v]
            tree.older_vector[w] = NONE if older == NONE else place[older]
    for x in range(tree.newest_vector.shape[0]):
        if tree.newest_vector[x] != NONE:
            tree.newest_vector[x] = place[tree.newest_vector[x]]
    tree.replaced_by[:used] = NONE
    tree.used[VECTORS] = used


@kernel
def prune_points(tree: Tree) -> None:
    """Keep for each node its latest point alone, in order."""
    count = tree.used[POINTS]
    latest = np.full(tree.used[NODES], NONE)
    for i in range(count):
        latest[tree.point_node[i]] = i
    place = np.empty(count, dtype=np.int64)
    used = 0
    tree.newest_point[:] = NONE
    for i in range(count):
        n = tree.point_node[i]
        if latest[n] == i:
            x = tree.node_x[n]
            tree.point_node[used] = n
            tree.point_drop[used] = tree.point_drop[i]
            tree.older_point[used] = tree.newest_point[x]
            tree.newest_point[x] = used
            used += 1
        place[i] = used - 1
    for n in range(tree.used[NODES]):
        if tree.points_seen[n] != NONE:
            tree.points_seen[n] = place[tree.points_seen[n]]
    tree.used[POINTS] = used
