"""What the search remembers: beliefs, their bounds, alpha vectors and upper-bound points.

Everything lies in arrays of records that Python enlarges between kernel calls. A *node* is a
belief at an observed state, met once however it is reached. A node that was *opened* has one
*branch* for each action, and a branch that was *expanded* has one *child* for each successor and
observation. Alpha vectors and upper-bound points of one observed state form linked lists from the
newest to the oldest, so that a node looks only at those that came since it last looked. The vectors
that nodes still use are held a second time in *groups* of a few side by side, hidden state by
hidden state, which is the order that evaluates several at once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from coadapt.arrays import BoolArray, FloatArray, Int32Array, IntArray
from coadapt.jit import bare
from coadapt.momdp.sarsop.problem import Problem

Records = NDArray[np.void]

NONE = -1
"""No node, branch, child, vector or point."""

# Indices into `Tree.used`.
NODES, ENTRIES, BRANCHES, CHILDREN, VECTORS, GROUPS, POINTS = range(7)
BACKUPS, TRIALS = 7, 8
LISTED, KEPT = 9, 10  # alpha vectors in the lists now, and after the last time some retired
LISTED_POINTS, KEPT_POINTS = 11, 12  # the same of points
SWEEP = 13  # how many backups there will be when the next sweep is due
REACHED = 14  # how deep the last trial went that followed the policy to its end
COUNTS = 15

LANES = 32
"""Alpha vectors in a group, where there are few states."""

FEW_LANES = 8
"""Where there are many: most observed states then have few vectors."""

FEW_STATES = 1 << 16

BLOCK = 16
"""Upper-bound points of one observed state that lie side by side."""

NODE = np.dtype(
    [
        ("x", np.int64),  # observed state
        ("first_entry", np.int64),  # where its belief begins
        ("entries", np.int64),  # how many hidden states it gives mass
        ("support", np.int64),  # see `support_of`
        ("first_branch", np.int64),  # its branches, one an action, or NONE
        ("same_hash", np.int64),  # next node in the same hash bucket
        ("lower", np.float64),  # lower bound
        ("vector", np.int64),  # the alpha vector that attains it
        ("vectors_seen", np.int64),  # newest alpha vector it was compared with
        ("upper", np.float64),  # upper bound
        ("points_seen", np.int64),  # newest point it was compared with
        ("corners", np.float64),  # upper bound from the corners of the belief simplex alone
        ("point", np.int64),  # its newest point, or NONE
        ("visits", np.int64),  # how often a trial chose it
    ]
)

BRANCH = np.dtype(
    [
        ("node", np.int64),  # whose branch it is
        ("reward", np.float64),  # expected immediate reward
        ("upper", np.float64),  # upper bound of Q
        ("first_child", np.int64),  # its children, or NONE
        ("children", np.int64),  # their number
    ]
)

CHILD = np.dtype(
    [
        ("node", np.int64),
        ("probability", np.float64),
        ("edge", np.int64),  # edge taken
        ("observation", np.int64),
    ]
)

VECTOR = np.dtype(
    [
        ("x", np.int64),  # observed state
        ("action", np.int64),
        ("older", np.int64),  # next in the list of its observed state
        ("replaced_by", np.int64),  # a vector at least as high everywhere, or NONE
    ]
)

GROUP = np.dtype(
    [
        ("filled", np.int64),  # lanes in use
        ("newest", np.int64),  # the vector in the last of them
        ("older", np.int64),  # next in the list of its observed state
    ]
)

# 64 bytes, which is what a processor fetches at once.
POINT = np.dtype(
    [
        ("drop", np.float64),  # how far below the corners the bound lies there
        ("support", np.int64),  # of its belief
        ("last_mass", np.float64),  # probability of the first hidden state below
        ("other_mass", np.float64),  # and of the second
        ("last_y", np.int32),  # the hidden state that last kept it from being of use elsewhere
        ("other_y", np.int32),  # the one before
        ("older", np.int64),  # next in the list of its observed state
        ("first_entry", np.int64),  # where its belief begins
        ("node", np.int32),  # whose belief it is
        ("entries", np.int32),  # how many hidden states it gives mass
    ]
)


class Tree(NamedTuple):
    """The arrays. Sizes: N nodes, S belief entries, R branches, C children, V vectors, G groups of
    L vectors, P points."""

    used: IntArray  # [COUNTS] how much of each array is in use
    nodes: Records  # [N]
    entry_y: Int32Array  # [S] hidden state
    entry_mass: FloatArray  # [S] its probability
    branches: Records  # [R]
    children: Records  # [C]
    vectors: Records  # [V]
    alpha: FloatArray  # [V, Y]
    groups: Records  # [G]
    lane_vector: IntArray  # [G, L] the alpha vector in each lane
    lane_alpha: FloatArray  # [G, Y, L] its values
    points: Records  # [P]
    newest_vector: IntArray  # [X]
    newest_group: IntArray  # [X]
    newest_point: IntArray  # [X]
    bucket: IntArray  # [H] one more than the first node of each hash bucket, or 0
    informed: FloatArray  # [X, Y, A] fast informed bound
    corner: FloatArray  # [X, Y] its value where the hidden state is known


class Scratch(NamedTuple):
    """Room to work in: kernels ask for no memory. Sizes as in `Problem` and `Tree`."""

    mass: FloatArray  # [Y] a belief, zero between uses
    totals: FloatArray  # [L]
    informed: FloatArray  # [A]
    useful: IntArray  # [BLOCK] points
    current: BoolArray  # [A]
    alpha: FloatArray  # [Y] the vector that a backup makes
    mixed: FloatArray  # [Y]
    spare: FloatArray  # [Y]
    chosen: IntArray  # [O] vectors
    pushed: FloatArray  # [Y]
    chance: FloatArray  # [O]
    begin: IntArray  # [O]
    end: IntArray  # [O]
    seen: IntArray  # as many as entries in an observation table
    part: FloatArray  # as many


def new_scratch(p: Problem) -> Scratch:
    """Scratch for the problem ``p``."""
    _, actions, hidden = p.reward.shape
    tables = p.seen_start[::hidden]  # where each observation table begins, and the end
    entries = int(np.diff(tables).max(initial=0))
    return Scratch(
        mass=np.zeros(hidden),
        totals=np.empty(lanes_for(p)),
        informed=np.empty(actions),
        useful=np.empty(BLOCK, np.int64),
        current=np.empty(actions, np.bool_),
        alpha=np.empty(hidden),
        mixed=np.empty(hidden),
        spare=np.empty(hidden),
        chosen=np.empty(p.observations, np.int64),
        pushed=np.empty(hidden),
        chance=np.empty(p.observations),
        begin=np.empty(p.observations, np.int64),
        end=np.empty(p.observations, np.int64),
        seen=np.empty(entries, np.int64),
        part=np.empty(entries),
    )


GROWABLE = {
    NODES: ("nodes",),
    ENTRIES: ("entry_y", "entry_mass"),
    BRANCHES: ("branches",),
    CHILDREN: ("children",),
    VECTORS: ("vectors", "alpha"),
    GROUPS: ("groups", "lane_vector", "lane_alpha"),
    POINTS: ("points",),
}
"""The arrays that grow together, by the index of their count."""

SMALL = 256
"""Size that arrays start from."""

BUCKETS = 1 << 18


def lanes_for(p: Problem) -> int:
    """How many alpha vectors a group holds."""
    states, _, hidden = p.reward.shape
    return LANES if states * hidden <= FEW_STATES else FEW_LANES


def size_of_first(p: Problem) -> int:
    """Bytes of the first bounds and of a tree that starts from them and one policy."""
    states, actions, hidden = p.reward.shape
    # Two arrays of values at work, the corners, the policy as it is and in groups.
    numbers = states * hidden * (actions + 4 + lanes_for(p)) + BUCKETS
    return 8 * numbers + states * (VECTOR.itemsize + GROUP.itemsize)


def new_tree(p: Problem, informed: FloatArray) -> Tree:
    """An empty tree over ``informed`` ``[X, A, Y]``, the upper bound to start from."""
    states, _, hidden = p.reward.shape
    lanes = lanes_for(p)
    return Tree(
        used=np.zeros(COUNTS, dtype=np.int64),
        nodes=np.zeros(SMALL, NODE),
        entry_y=np.zeros(SMALL, np.int32),
        entry_mass=np.zeros(SMALL),
        branches=np.zeros(SMALL, BRANCH),
        children=np.zeros(SMALL, CHILD),
        vectors=np.zeros(SMALL, VECTOR),
        alpha=np.zeros((SMALL, hidden)),
        groups=np.zeros(SMALL, GROUP),
        lane_vector=np.zeros((SMALL, lanes), np.int64),
        lane_alpha=np.zeros((SMALL, hidden, lanes)),
        points=np.zeros(SMALL, POINT),
        newest_vector=np.full(states, np.int64(NONE)),
        newest_group=np.full(states, np.int64(NONE)),
        newest_point=np.full(states, np.int64(NONE)),
        bucket=np.zeros(BUCKETS, np.int64),  # takes no memory until it is used
        informed=np.ascontiguousarray(informed.transpose(0, 2, 1)),
        corner=informed.max(axis=1),
    )


def lacking(tree: Tree, room: IntArray) -> tuple[int, ...]:
    """Which counts of `GROWABLE` have less than ``room`` ``[COUNTS]`` more places."""
    return tuple(
        kind
        for kind, names in GROWABLE.items()
        if len(getattr(tree, names[0])) < tree.used[kind] + room[kind]
    )


def grow(tree: Tree, room: IntArray) -> None:
    """Enlarge every array that lacks ``room`` ``[COUNTS]`` more places, in place.

    Large arrays are not copied where the system can move their pages (Linux): copying them, and
    touching fresh memory for it, took a third of the time of some searches.
    """
    for kind in lacking(tree, room):
        for name in GROWABLE[kind]:
            array = getattr(tree, name)
            places = int(tree.used[kind] + room[kind])
            # Nothing else may hold a part of it: kernels have ended, and records are copied out.
            array.resize((places, *array.shape[1:]), refcheck=False)


def size_of(tree: Tree) -> int:
    """Bytes of the arrays of ``tree``."""
    return sum(array.nbytes for array in tree)


def size_after(tree: Tree, room: IntArray) -> int:
    """Bytes of the arrays of ``tree`` after `grow`."""
    total = size_of(tree)
    for kind in lacking(tree, room):
        for name in GROWABLE[kind]:
            array = getattr(tree, name)
            places = int(tree.used[kind] + room[kind])
            total += (places - len(array)) * (array.nbytes // len(array))
    return total


@bare
def has_room(tree: Tree, room: IntArray) -> bool:
    """Whether every array has ``room`` ``[COUNTS]`` more places."""
    used = tree.used
    return (
        used[NODES] + room[NODES] <= tree.nodes.shape[0]
        and used[ENTRIES] + room[ENTRIES] <= tree.entry_y.shape[0]
        and used[BRANCHES] + room[BRANCHES] <= tree.branches.shape[0]
        and used[CHILDREN] + room[CHILDREN] <= tree.children.shape[0]
        and used[VECTORS] + room[VECTORS] <= tree.vectors.shape[0]
        and used[GROUPS] + room[GROUPS] <= tree.groups.shape[0]
        and used[POINTS] + room[POINTS] <= tree.points.shape[0]
    )
