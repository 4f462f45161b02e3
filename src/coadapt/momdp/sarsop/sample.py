"""Sampling near the beliefs an optimal policy reaches (Kurniawati, Hsu, Lee 2008, Sec. III-B).

A trial walks down from a root: the action with the largest upper bound, then the successor and
observation that contribute most to the gap. Among successors alike it prefers those seldom chosen
before: else it would go the same ways again and again while the rest of the belief space waits. A
trial carries targets: the lower bound a belief would have to exceed, and the upper bound it would
have to undercut, to matter at the root. It goes on below its target gap where the predicted value
says that the lower bound at the root would rise. Then every node on the path is backed up, the last
first.

Every second trial takes the actions of the policy so far instead, and backs up the lower bounds
alone. That raises them where the upper ones mislead. Between trials come sweeps (see `sweep`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.jit import bare, kernel
from coadapt.momdp.sarsop.backup import backup_lower, backup_upper, q_lower
from coadapt.momdp.sarsop.bounds import refresh_lower, refresh_upper
from coadapt.momdp.sarsop.expand import expand_branch, open_node
from coadapt.momdp.sarsop.problem import Problem
from coadapt.momdp.sarsop.sweep import sweep
from coadapt.momdp.sarsop.tree import (
    BACKUPS,
    CHILDREN,
    KEPT,
    KEPT_POINTS,
    LISTED,
    LISTED_POINTS,
    NONE,
    POINTS,
    SWEEP,
    TRIALS,
    VECTORS,
    Scratch,
    Tree,
    has_room,
)

# What `run_trials` ended for.
CLOSED, WORKED, NO_ROOM, STALLED, MANY_VECTORS, MANY_POINTS = range(6)

DEPTH_LIMIT = 2000

TOO_MANY = 1.5
"""Vectors or points retire when there are this many times as many as after the last time."""

PATIENCE = 100
"""So many trials in a row that change nothing mean that the bounds have met their precision."""

FEW = 64
"""So few more are not worth the trouble."""

AIMS = (0.2, 0.5, 0.4, 0.5, 0.6, 0.5, 0.8, 0.5)
"""At which part of the gap it starts from a trial aims, in turn: those in the odd places follow the
policy, some far down and some not so far, since no single depth suits every problem."""

VISITS = 3.0
"""A child's gap weighs one over the square root of this and the number of its visits."""


class Bins(NamedTuple):
    """Predicts the value of a belief from beliefs alike: in upper bound and in entropy."""

    total: FloatArray  # [U, H] sum of the lower bounds of the beliefs in each bin
    number: IntArray  # [U, H] how many they are
    low: float  # smallest upper bound of a belief
    width: float  # of a bin


BINS = 16


def new_bins(low: float, high: float) -> Bins:
    """Empty bins for values between ``low`` and ``high``."""
    width = max(high - low, 1e-9) / BINS
    return Bins(np.zeros((BINS, BINS)), np.zeros((BINS, BINS), dtype=np.int64), low, width)


@bare
def predicted_value(tree: Tree, bins: Bins, n: int) -> float:
    """Mean lower bound of the beliefs in the bin of node ``n``; its upper bound in an empty one.

    Counts the node in.
    """
    size = bins.total.shape[0]
    node = tree.nodes[n]
    first = node["first_entry"]
    entropy = 0.0
    for i in range(first, first + node["entries"]):
        entropy -= tree.entry_mass[i] * np.log(tree.entry_mass[i])
    widest = np.log(tree.corner.shape[1] + 1.0)
    h = min(size - 1, int(size * entropy / widest))
    u = max(0, min(size - 1, int((node["corners"] - bins.low) / bins.width)))
    known = bins.number[u, h]
    prediction = bins.total[u, h] / known if known > 0 else node["upper"]
    bins.total[u, h] += node["lower"]
    bins.number[u, h] += 1
    return prediction


@kernel
def run_trials(
    p: Problem,
    tree: Tree,
    bins: Bins,
    roots: IntArray,
    gap: float,
    relative_gap: float,
    stop: int,
    room: IntArray,
    scratch: Scratch,
) -> int:
    """Run trials until the gap is closed at every root or the number of backups is ``stop``.

    It is closed where it is at most ``gap`` or at most ``relative_gap`` times both bounds.

    Returns:
        `CLOSED`, `WORKED`, `STALLED` where the bounds no longer move, `NO_ROOM` where a trial
        was broken off for want of ``room``, or `MANY_VECTORS` or `MANY_POINTS` where some of them
        should retire.
    """
    path = np.empty(DEPTH_LIMIT + 1, dtype=np.int64)
    idle = 0
    while True:
        before = tree.used[VECTORS] + tree.used[POINTS] + tree.used[CHILDREN]
        widest = allowed = 0.0
        root = roots[0]
        for n in roots:
            upper, lower = refresh_upper(tree, n, scratch), refresh_lower(tree, n, scratch)
            close = max(gap, relative_gap * max(lower, -upper))
            if upper - lower > close and upper - lower > widest:
                widest = upper - lower
                allowed = close
                root = n
        if widest == 0.0:
            return CLOSED
        if tree.used[BACKUPS] >= stop:
            return WORKED
        if tree.used[LISTED] > TOO_MANY * tree.used[KEPT] + FEW:
            return MANY_VECTORS
        if tree.used[LISTED_POINTS] > TOO_MANY * tree.used[KEPT_POINTS] + FEW:
            return MANY_POINTS
        if tree.used[BACKUPS] >= tree.used[SWEEP] and not sweep(p, tree, room, scratch):
            return NO_ROOM
        tree.used[TRIALS] += 1
        turn = int(tree.used[TRIALS]) % len(AIMS)
        exploit = turn % 2 == 0
        aim = max(allowed, AIMS[turn] * widest)
        depth = descend(p, tree, bins, root, aim, room, path, scratch, exploit)
        if depth < 0:
            return NO_ROOM
        for i in range(depth, -1, -1):
            if not has_room(tree, room):
                return NO_ROOM
            if not exploit:
                backup_upper(p, tree, path[i], scratch)
            backup_lower(p, tree, path[i], scratch, exploit)
        if tree.used[VECTORS] + tree.used[POINTS] + tree.used[CHILDREN] > before:
            idle = 0
        else:
            idle += 1
            if idle == PATIENCE:
                return STALLED


@bare
def policy_action(p: Problem, tree: Tree, n: int, scratch: Scratch) -> int:
    """The action that the policy so far takes at opened node ``n``; its branch has children."""
    refresh_lower(tree, n, scratch)
    a = int(tree.vectors[tree.nodes[n]["vector"]]["action"])
    if tree.branches[tree.nodes[n]["first_branch"] + a]["first_child"] == NONE:
        expand_branch(p, tree, n, a, scratch)
    return a


@bare
def descend(
    p: Problem,
    tree: Tree,
    bins: Bins,
    root: int,
    gap: float,
    room: IntArray,
    path: IntArray,
    scratch: Scratch,
    exploit: bool,
) -> int:
    """Write the nodes of a trial to ``path``; the index of the last, or -1 for want of room.

    With ``exploit`` the trial takes the actions of the policy so far.
    """
    n = root
    allowed = gap
    target_lower = refresh_lower(tree, n, scratch)
    target_upper = target_lower + gap
    depth = 0
    while True:
        path[depth] = n
        if not has_room(tree, room):
            return -1
        if tree.nodes[n]["first_branch"] == NONE:
            open_node(p, tree, n, scratch)
        best = policy_action(p, tree, n, scratch) if exploit else backup_upper(p, tree, n, scratch)
        lower = refresh_lower(tree, n, scratch)
        upper = tree.nodes[n]["upper"]
        if depth == DEPTH_LIMIT or upper - lower <= 0.0 or p.discount == 0.0:
            return depth
        if (
            depth > 0
            and upper <= max(target_upper, lower + allowed)
            and predicted_value(tree, bins, n) <= target_lower
        ):
            return depth
        r = tree.nodes[n]["first_branch"] + best
        value = q_lower(p, tree, r, scratch)
        target_lower = max(target_lower, value)
        target_upper = max(target_upper, value + allowed)
        allowed /= p.discount
        # The child whose excess gap weighs most; exploration turns to those seldom chosen.
        branch = tree.branches[r]
        first = branch["first_child"]
        chosen = NONE
        heaviest = 0.0
        total_lower = total_upper = branch["reward"]
        for c in range(first, first + branch["children"]):
            probability = tree.children[c]["probability"]
            child = tree.nodes[tree.children[c]["node"]]
            total_lower += p.discount * probability * child["lower"]
            total_upper += p.discount * probability * child["upper"]
            excess = probability * (child["upper"] - child["lower"] - allowed)
            excess /= np.sqrt(VISITS + child["visits"])
            if chosen == NONE or excess > heaviest:
                chosen = c
                heaviest = excess
        if chosen == NONE:
            return depth
        n = tree.children[chosen]["node"]
        weight = p.discount * tree.children[chosen]["probability"]
        target_lower = (target_lower - total_lower) / weight + tree.nodes[n]["lower"]
        target_upper = (target_upper - total_upper) / weight + tree.nodes[n]["upper"]
        tree.nodes[n]["visits"] += 1
        depth += 1
