"""Backing up again where beliefs were opened (Perseus: Spaan and Vlassis 2005).

A trial backs up the nodes on its path alone. What it found there may raise the lower bound at other
nodes as well, and a sweep brings that to the roots at little expense: it opens no node, and passes
by those that a vector of this sweep has raised already.
"""

from __future__ import annotations

from coadapt.arrays import IntArray
from coadapt.jit import bare
from coadapt.momdp.sarsop.backup import GAIN, backup_lower
from coadapt.momdp.sarsop.bounds import refresh_lower
from coadapt.momdp.sarsop.problem import Problem
from coadapt.momdp.sarsop.tree import BACKUPS, BRANCHES, SWEEP, Scratch, Tree, has_room

GLANCES = 16
"""Looking at so many opened nodes takes about as long as one backup in a trial."""


@bare
def sweep(p: Problem, tree: Tree, room: IntArray, scratch: Scratch) -> bool:
    """Back up the lower bounds of the opened nodes, the newest first; False for want of ``room``.

    The next sweep is due when trials have done as much work as this one.
    """
    actions = p.reward.shape[1]
    before = tree.used[BACKUPS]
    for r in range(tree.used[BRANCHES] - actions, -1, -actions):
        n = tree.branches[r]["node"]
        known = tree.nodes[n]["lower"]
        if refresh_lower(tree, n, scratch) <= known + GAIN * (1.0 + abs(known)):
            if not has_room(tree, room):
                return False
            backup_lower(p, tree, n, scratch, False)
    done = tree.used[BACKUPS] - before
    glances = tree.used[BRANCHES] // (actions * GLANCES)
    tree.used[SWEEP] = tree.used[BACKUPS] + done + glances
    return True
