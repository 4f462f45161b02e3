"""Point-based backup of both bounds at one node."""

from __future__ import annotations

from coadapt.jit import bare
from coadapt.momdp.sarsop.bounds import (
    add_point,
    add_vector,
    lower_upper,
    refresh_lower,
    refresh_upper,
)
from coadapt.momdp.sarsop.expand import expand_branch
from coadapt.momdp.sarsop.problem import Problem, pull
from coadapt.momdp.sarsop.tree import BACKUPS, NONE, Scratch, Tree

GAIN = 1e-12
"""A bound moved when it moved by more than this part of its size."""

LARGE_PART = 0.1
"""Of a node's gap: by how much its upper bound must fall for other nodes to look at it again."""


@bare
def backup_upper(p: Problem, tree: Tree, n: int, scratch: Scratch) -> int:
    """Tighten the upper bounds of the actions of opened node ``n``; the action with the largest.

    Only the action that leads is looked at, again and again until it leads by an up-to-date
    bound: the others' old bounds are bounds still.
    """
    node = tree.nodes[n]
    r = node["first_branch"]
    current = scratch.current
    current[:] = False
    best = 0
    while True:
        best = leading_action(p, tree, n)
        if current[best]:
            break
        current[best] = True
        if tree.branches[r + best]["first_child"] == NONE:
            expand_branch(p, tree, n, best, scratch)
        branch = tree.branches[r + best]
        total = branch["reward"]
        first = branch["first_child"]
        for c in range(first, first + branch["children"]):
            child = tree.children[c]
            below = tree.nodes[child["node"]]
            # Asked here as well: a call with so many arrays costs more than the question.
            if tree.newest_point[below["x"]] > below["points_seen"]:
                refresh_upper(tree, child["node"], scratch)
            total += p.discount * child["probability"] * below["upper"]
        branch["upper"] = min(branch["upper"], total)
    leading = float(tree.branches[r + best]["upper"])
    if leading < node["upper"] - GAIN * (1.0 + abs(leading)):
        fresh = node["point"] == NONE
        large = LARGE_PART * (node["upper"] - node["lower"])
        known = float(node["upper"])
        lower_upper(tree, n, leading)
        if fresh or known - leading > large:
            add_point(tree, n)
    return best


@bare
def leading_action(p: Problem, tree: Tree, n: int) -> int:
    """The action of opened node ``n`` with the largest upper bound."""
    r = tree.nodes[n]["first_branch"]
    best = 0
    for a in range(1, p.reward.shape[1]):
        if tree.branches[r + a]["upper"] > tree.branches[r + best]["upper"]:
            best = a
    return best


@bare
def backup_lower(p: Problem, tree: Tree, n: int, scratch: Scratch, every: bool) -> None:
    """Add the alpha vector of the best action at opened node ``n``, if it raises the bound.

    Only the one that leads by its upper bound and the one that the policy takes so far are looked
    at. With ``every`` all that have children are, and one more is given them, so that in time none
    is left out that could be better.
    """
    actions = p.reward.shape[1]
    node = tree.nodes[n]
    r = node["first_branch"]
    refresh_lower(tree, n, scratch)
    best = actions  # none
    best_value = node["lower"] + GAIN * (1.0 + abs(node["lower"]))
    leading = leading_action(p, tree, n)
    taken = tree.vectors[node["vector"]]["action"]
    may_expand = every
    for a in range(actions):
        branch = tree.branches[r + a]
        asked = every or a in (leading, taken)
        ready = branch["first_child"] != NONE
        if asked and (ready or may_expand) and branch["upper"] > best_value:
            if not ready:
                expand_branch(p, tree, n, a, scratch)
                may_expand = False
            value = q_lower(p, tree, r + a, scratch)
            if value > best_value:
                best = a
                best_value = value
    if best < actions:
        back_up_vector(p, tree, n, best, scratch)
        add_vector(tree, node["x"], scratch.alpha, best)
        refresh_lower(tree, n, scratch)
    tree.used[BACKUPS] += 1


@bare
def q_lower(p: Problem, tree: Tree, r: int, scratch: Scratch) -> float:
    """Lower bound of ``Q`` of expanded branch ``r``, from the bounds of its children."""
    branch = tree.branches[r]
    total = branch["reward"]
    first = branch["first_child"]
    for c in range(first, first + branch["children"]):
        child = tree.children[c]
        below = tree.nodes[child["node"]]
        if tree.newest_vector[below["x"]] > below["vectors_seen"]:
            refresh_lower(tree, child["node"], scratch)
        total += p.discount * child["probability"] * below["lower"]
    return total


@bare
def back_up_vector(p: Problem, tree: Tree, n: int, a: int, scratch: Scratch) -> None:
    """Write the value of taking ``a`` in node ``n`` and then what is best at each child to
    ``scratch.alpha``.

    ``alpha(y) = R(x, a, y) + gamma sum_{x', y'} P(x', y' | x, y, a) sum_o O(o | y') alpha_o(y')``
    where ``alpha_o`` is the vector of the child reached by ``(x', o)``. Where the belief gives
    ``(x', o)`` no probability any vector of x' serves.
    """
    node = tree.nodes[n]
    x = node["x"]
    hidden = p.reward.shape[2]
    alpha, mixed, chosen = scratch.alpha, scratch.mixed, scratch.chosen
    for y in range(hidden):
        alpha[y] = p.reward[x, a, y]
    row = x * p.reward.shape[1] + a
    branch = tree.branches[node["first_branch"] + a]
    c = branch["first_child"]
    last = c + branch["children"]
    for e in range(p.edge_start[row], p.edge_start[row + 1]):
        x_next = p.edge_next[e]
        # Children stand in the order of the edges.
        stand_in = tree.newest_vector[x_next]
        likeliest = 0.0
        first = c
        while c < last and tree.children[c]["edge"] == e:
            if tree.children[c]["probability"] > likeliest:
                likeliest = tree.children[c]["probability"]
                stand_in = tree.nodes[tree.children[c]["node"]]["vector"]
            c += 1
        chosen[:] = stand_in
        for i in range(first, c):
            child = tree.children[i]
            chosen[child["observation"]] = tree.nodes[child["node"]]["vector"]
        table = p.table[a, x_next] * hidden
        for y in range(hidden):
            total = 0.0
            for j in range(p.seen_start[table + y], p.seen_start[table + y + 1]):
                total += p.seen_chance[j] * tree.alpha[chosen[p.seen[j]], y]
            mixed[y] = total
        pull(p, p.edge_map[e], p.discount, mixed, alpha, scratch.spare)
