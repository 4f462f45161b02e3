"""Sampling near the beliefs an optimal policy reaches (Kurniawati, Hsu, Lee 2008, Sec. III-B).

A trial walks down from a root: the action with the largest upper bound, then the successor and
observation that contribute most to the gap. Among successors alike it prefers those seldom chosen
before: else it would go the same ways again and again while the rest of the belief space waits. A
trial carries targets: the lower bound a belief would have to exceed, and the upper bound it would
have to undercut, to matter at the root. It goes on below its target gap where the predicted value
says that the lower bound at the root would rise. Then every node on the path is backed up, the last
first.

Upper bounds mislead where they are loose. So every second trial follows the policy so far, and on
its way back looks at other actions too. It follows more or less: each step takes the action with
the best mean of both bounds, and the weights in that mean change from step to step. A trial that
did exactly what the policy does would miss all that takes more than one other step. Half of these
trials leave the policy for good somewhere on the way, and explore from there. Between trials come
sweeps (see `sweep`).
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
    REACHED,
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
"""At which part of the gap it starts from a trial aims, in turn: the first, third and so on follow
the policy, some far down and some not so far, since no single depth suits every problem."""

TRIAL_STRIDE, DEPTH_STRIDE = 0.6180339887, 0.7548776662
"""Multiples of these, modulo 1, fill the interval evenly: one over the golden ratio, and over the
plastic ratio."""

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
        trial = int(tree.used[TRIALS])
        exploit = trial % 2 == 0
        follow = steps_to_follow(tree)
        to_the_end = follow == DEPTH_LIMIT
        aim = max(allowed, AIMS[trial % len(AIMS)] * widest)
        depth = descend(p, tree, bins, root, aim, follow, room, path, scratch)
        if depth < 0:
            return NO_ROOM
        if to_the_end:
            tree.used[REACHED] = depth
        for i in range(depth, -1, -1):
            if not has_room(tree, room):
                return NO_ROOM
            if not to_the_end:
                backup_upper(p, tree, path[i], scratch)
            backup_lower(p, tree, path[i], scratch, exploit)
        if tree.used[VECTORS] + tree.used[POINTS] + tree.used[CHILDREN] > before:
            idle = 0
        else:
            idle += 1
            if idle == PATIENCE:
                return STALLED


@bare
def steps_to_follow(tree: Tree) -> int:
    """For how many steps the trial that is due follows the policy: to the end, some, or none."""
    trial = int(tree.used[TRIALS])
    if trial % 4 == 0:
        return DEPTH_LIMIT
    if trial % 2 == 0:
        return int(tree.used[REACHED] * (trial // 4 * TRIAL_STRIDE % 1.0))
    return 0


@bare
def promising_action(p: Problem, tree: Tree, n: int, optimism: float, scratch: Scratch) -> int:
    """The action at opened node ``n`` with the best mean of both bounds of Q, where ``optimism``
    weighs the upper one; its branch has children.

    The policy's action has children or is given them, others only where their upper bound is larger
    than its.
    """
    lower = refresh_lower(tree, n, scratch)
    r = tree.nodes[n]["first_branch"]
    taken = int(tree.vectors[tree.nodes[n]["vector"]]["action"])
    enough = max(lower, float(tree.branches[r + taken]["upper"]))
    best = taken
    best_mean = -np.inf
    for a in range(p.reward.shape[1]):
        branch = tree.branches[r + a]
        ready = branch["first_child"] != NONE and branch["upper"] > lower
        if a == taken or ready or branch["upper"] > enough:
            if branch["first_child"] == NONE:
                expand_branch(p, tree, n, a, scratch)
            mean = (1.0 - optimism) * q_lower(p, tree, r + a, scratch)
            mean += optimism * branch["upper"]
            if mean > best_mean:
                best = a
                best_mean = mean
    return best


@bare
def descend(
    p: Problem,
    tree: Tree,
    bins: Bins,
    root: int,
    gap: float,
    follow: int,
    room: IntArray,
    path: IntArray,
    scratch: Scratch,
) -> int:
    """Write the nodes of a trial to ``path``; the index of the last, or -1 for want of room.

    For ``follow`` steps the trial more or less follows the policy so far.
    """
    optimism = tree.used[TRIALS] // 2 * TRIAL_STRIDE % 1.0
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
        if depth < follow:
            best = promising_action(p, tree, n, optimism, scratch)
            optimism = (optimism + DEPTH_STRIDE) % 1.0
        else:
            best = backup_upper(p, tree, n, scratch)
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
