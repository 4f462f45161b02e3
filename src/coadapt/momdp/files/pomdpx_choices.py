"""Entries for tables that depend on action and observed state, as few as a simple rule finds.

A table of tables ``c[a, x]`` is written as one entry for the most frequent choice, with wildcards
for both, and then exceptions: those of a whole action, of a whole state, and single ones.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from coadapt.arrays import IntArray

ALL = -1
"""Instead of an action or a state: all of them."""


def choices(table: IntArray) -> Iterator[tuple[int, int, int]]:
    """Action, state and choice of each entry, in the order that makes them right.

    Args:
        table: ``[A, X]`` the choice for every action and state.
    """
    actions, states = table.shape
    usual = _most_frequent(table.ravel())
    yield ALL, ALL, usual
    rest = table != usual
    for a in range(actions):
        if rest[a].any():
            own = _most_frequent(table[a])
            if own != usual and np.count_nonzero(table[a] == own) * 2 > states:
                yield a, ALL, own
                rest[a] = table[a] != own
    for x in np.flatnonzero(rest.any(axis=0)):
        own = table[0, x]
        if rest[:, x].any() and actions > 1 and (table[:, x] == own).all():
            yield ALL, int(x), int(own)
            rest[:, x] = False
    for a, x in np.argwhere(rest):
        yield int(a), int(x), int(table[a, x])


def _most_frequent(values: IntArray) -> int:
    different, counts = np.unique(values, return_counts=True)
    return int(different[np.argmax(counts)])
