"""What the search remembers: beliefs, their bounds, alpha vectors and upper-bound points.

Everything lies in flat arrays that Python enlarges between kernel calls. A *node* is a belief at
an observed state, met once however it is reached. A node that was *opened* has one *branch* for
each action, and a branch that was *expanded* has one *child* for each successor and observation.
Alpha vectors and upper-bound points of one observed state form linked lists from the newest to
the oldest, so that a node looks only at those that came since it last looked.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.momdp.sarsop.jit import kernel
from coadapt.momdp.sarsop.problem import Problem, push

NONE = -1
"""No node, branch, child, vector or point."""

# Indices into `Tree.used`.
NODES, ENTRIES, BRANCHES, CHILDREN, VECTORS, POINTS, BACKUPS, TRIALS = range(8)

NEGLIGIBLE = 1e-20
"""Belief entries below this are left out: too small to move a bound by a unit in the last place."""

SAME_BELIEF = 1e-13
"""Beliefs whose entries agree this closely are one node."""

GRID = 2.0**36
"""Beliefs are hashed by their entries rounded to this many steps."""


class Tree(NamedTuple):
    """The arrays. Sizes: N nodes, S belief entries, R branches, C children, V vectors, P points."""

    used: IntArray  # [8] how much of each array is in use
    # nodes
    node_x: IntArray  # [N] observed state
    entry_start: IntArray  # [N] where its belief begins
    entry_count: IntArray  # [N] how many hidden states it gives mass
    lower: FloatArray  # [N] lower bound
    vector: IntArray  # [N] the alpha vector that attains it
    vectors_seen: IntArray  # [N] newest alpha vector it was compared with
    upper: FloatArray  # [N] upper bound
    points_seen: IntArray  # [N] newest point it was compared with
    corners: FloatArray  # [N] upper bound from the corners of the belief simplex alone
    first_branch: IntArray  # [N] its branches, one an action, or NONE
    same_hash: IntArray  # [N] next node in the same hash bucket
    # belief entries
    entry_y: IntArray  # [S] hidden state
    entry_mass: FloatArray  # [S] its probability
    # branches
    branch_reward: FloatArray  # [R] expected immediate reward
    branch_upper: FloatArray  # [R] upper bound of Q
    first_child: IntArray  # [R] its children, or NONE
    child_count: IntArray  # [R]
    # children
    child_node: IntArray  # [C]
    child_probability: FloatArray  # [C]
    child_edge: IntArray  # [C] edge taken
    child_observation: IntArray  # [C]
    # alpha vectors
    alpha: FloatArray  # [V, Y]
    vector_x: IntArray  # [V] observed state
    action: IntArray  # [V]
    older_vector: IntArray  # [V]
    replaced_by: IntArray  # [V] a vector at least as high everywhere, or NONE
    newest_vector: IntArray  # [X]
    # upper-bound points
    point_node: IntArray  # [P]
    point_drop: FloatArray  # [P] how far below the corners the bound lies there
    older_point: IntArray  # [P]
    newest_point: IntArray  # [X]
    # the rest
    bucket: IntArray  # [power of two] first node of each hash bucket
    informed: FloatArray  # [X, A, Y] fast informed bound
    corner: FloatArray  # [X, Y] its value where the hidden state is known


GROWABLE: dict[int, tuple[str, ...]] = {
    NODES: (
        "node_x",
        "entry_start",
        "entry_count",
        "lower",
        "vector",
        "vectors_seen",
        "upper",
        "points_seen",
        "corners",
        "first_branch",
        "same_hash",
    ),
    ENTRIES: ("entry_y", "entry_mass"),
    BRANCHES: ("branch_reward", "branch_upper", "first_child", "child_count"),
    CHILDREN: ("child_node", "child_probability", "child_edge", "child_observation"),
    VECTORS: ("alpha", "vector_x", "action", "older_vector", "replaced_by"),
    POINTS: ("point_node", "point_drop", "older_point"),
}
"""The arrays that grow together, by the index of their count."""


def new_tree(p: Problem, informed: FloatArray) -> Tree:
    """An empty tree over ``informed`` ``[X, A, Y]``, the upper bound to start from."""
    states, _, hidden = p.reward.shape
    small, none = 1024, np.int64(NONE)

    def ints(size: int) -> IntArray:
        return np.full(size, none)

    return Tree(
        used=np.zeros(8, dtype=np.int64),
        node_x=ints(small),
        entry_start=ints(small),
        entry_count=ints(small),
        lower=np.zeros(small),
        vector=ints(small),
        vectors_seen=ints(small),
        upper=np.zeros(small),
        points_seen=ints(small),
        corners=np.zeros(small),
        first_branch=ints(small),
        same_hash=ints(small),
        entry_y=ints(small),
        entry_mass=np.zeros(small),
        branch_reward=np.zeros(small),
        branch_upper=np.zeros(small),
        first_child=ints(small),
        child_count=ints(small),
        child_node=ints(small),
        child_probability=np.zeros(small),
        child_edge=ints(small),
        child_observation=ints(small),
        alpha=np.zeros((small, hidden)),
        vector_x=ints(small),
        action=ints(small),
        older_vector=ints(small),
        replaced_by=ints(small),
        newest_vector=ints(states),
        point_node=ints(small),
        point_drop=np.zeros(small),
        older_point=ints(small),
        newest_point=ints(states),
        bucket=ints(1 << 18),
        informed=informed,
        corner=informed.max(axis=1),
    )


def grow(tree: Tree, room: IntArray) -> Tree:
    """The tree with every array enlarged that lacks ``room`` ``[8]`` more places."""
    larger: dict[str, FloatArray | IntArray] = {}
    for kind, names in GROWABLE.items():
        for name in names:
            array = getattr(tree, name)
            wanted = int(tree.used[kind] + room[kind])
            if len(array) < wanted:
                new = np.zeros((max(wanted, 2 * len(array)), *array.shape[1:]), dtype=array.dtype)
                new[: len(array)] = array
                larger[name] = new
    return tree._replace(**larger)


@kernel
def has_room(tree: Tree, room: IntArray) -> bool:
    """Whether every array has ``room`` ``[8]`` more places."""
    count = tree.used
    return (
        count[NODES] + room[NODES] <= tree.node_x.shape[0]
        and count[ENTRIES] + room[ENTRIES] <= tree.entry_y.shape[0]
        and count[BRANCHES] + room[BRANCHES] <= tree.branch_upper.shape[0]
        and count[CHILDREN] + room[CHILDREN] <= tree.child_node.shape[0]
        and count[VECTORS] + room[VECTORS] <= tree.action.shape[0]
        and count[POINTS] + room[POINTS] <= tree.point_node.shape[0]
    )


@kernel
def add_node(tree: Tree, x: int, index: IntArray, mass: FloatArray, size: int) -> int:
    """The node of observed state ``x`` and the belief given by ``size`` pairs; new if need be.

    ``index`` increases; ``mass`` sums to 1. A new node starts from the informed bound and has yet
    to look at vectors and points.
    """
    h = x
    for i in range(size):
        h = (h * 1000003 + index[i] * 7919 + int(mass[i] * GRID + 0.5)) % 2147483647
    h = h % tree.bucket.shape[0]
    n = int(tree.bucket[h])
    while n != NONE:
        if tree.node_x[n] == x and tree.entry_count[n] == size:
            first = tree.entry_start[n]
            same = True
            for i in range(size):
                if (
                    tree.entry_y[first + i] != index[i]
                    or abs(tree.entry_mass[first + i] - mass[i]) > SAME_BELIEF
                ):
                    same = False
                    break
            if same:
                return n
        n = int(tree.same_hash[n])
    n = int(tree.used[NODES])
    first = tree.used[ENTRIES]
    tree.used[NODES] += 1
    tree.used[ENTRIES] += size
    tree.node_x[n] = x
    tree.entry_start[n] = first
    tree.entry_count[n] = size
    corners = 0.0
    for i in range(size):
        tree.entry_y[first + i] = index[i]
        tree.entry_mass[first + i] = mass[i]
        corners += mass[i] * tree.corner[x, index[i]]
    informed = -np.inf
    for a in range(tree.informed.shape[1]):
        total = 0.0
        for i in range(size):
            total += mass[i] * tree.informed[x, a, index[i]]
        informed = max(informed, total)
    tree.lower[n] = -np.inf
    tree.vector[n] = NONE
    tree.vectors_seen[n] = NONE
    tree.upper[n] = min(corners, informed)
    tree.points_seen[n] = NONE
    tree.corners[n] = corners
    tree.first_branch[n] = NONE
    tree.same_hash[n] = tree.bucket[h]
    tree.bucket[h] = n
    return n


@kernel
def open_node(p: Problem, tree: Tree, n: int) -> None:
    """Give node ``n`` its branches, bounded by the informed bound."""
    actions = p.reward.shape[1]
    x = tree.node_x[n]
    r = tree.used[BRANCHES]
    tree.used[BRANCHES] += actions
    tree.first_branch[n] = r
    first = tree.entry_start[n]
    for a in range(actions):
        reward = 0.0
        upper = 0.0
        for i in range(first, first + tree.entry_count[n]):
            reward += tree.entry_mass[i] * p.reward[x, a, tree.entry_y[i]]
            upper += tree.entry_mass[i] * tree.informed[x, a, tree.entry_y[i]]
        tree.branch_reward[r + a] = reward
        tree.branch_upper[r + a] = upper
        tree.first_child[r + a] = NONE
        tree.child_count[r + a] = 0


@kernel
def expand_branch(p: Problem, tree: Tree, n: int, a: int) -> None:
    """Give branch ``a`` of node ``n`` its children: every successor and observation."""
    hidden = p.reward.shape[2]
    x = tree.node_x[n]
    first = tree.entry_start[n]
    size = tree.entry_count[n]
    r = tree.first_branch[n] + a
    children = tree.used[CHILDREN]
    tree.first_child[r] = children
    pushed = np.empty(hidden)
    reached = np.empty(hidden, dtype=np.int64)
    index = np.empty(hidden, dtype=np.int64)
    mass = np.empty(hidden)
    row = x * p.reward.shape[1] + a
    for e in range(p.edge_start[row], p.edge_start[row + 1]):
        x_next = p.edge_next[e]
        push(
            p,
            p.edge_map[e],
            tree.entry_y[first : first + size],
            tree.entry_mass[first : first + size],
            size,
            pushed,
        )
        reach = 0
        for y in range(hidden):
            if pushed[y] > 0.0:
                reached[reach] = y
                reach += 1
        table = p.observation[p.observation_index[a, x_next]]
        for o in range(table.shape[0]):
            probability = 0.0
            for i in range(reach):
                probability += pushed[reached[i]] * table[o, reached[i]]
            if probability <= 0.0:
                continue
            kept = 0
            for i in range(reach):
                y = reached[i]
                share = pushed[y] * table[o, y] / probability
                if share > NEGLIGIBLE:
                    index[kept] = y
                    mass[kept] = share
                    kept += 1
            c = tree.used[CHILDREN]
            tree.used[CHILDREN] += 1
            tree.child_node[c] = add_node(tree, x_next, index, mass, kept)
            tree.child_probability[c] = probability
            tree.child_edge[c] = e
            tree.child_observation[c] = o
    tree.child_count[r] = tree.used[CHILDREN] - children
