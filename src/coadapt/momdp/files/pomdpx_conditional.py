"""Joint maps ``P(x', y' | x, y, a)`` as the format wants them: ``P(x' | x, y, a)`` times
``P(y' | x, y, a, x')``.

The first factor is the row sums of an edge's map, the second the map with its rows divided by them.
Where ``x'`` is impossible the second is not defined; it is the identity there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from coadapt.arrays import FloatArray, IntArray
from coadapt.momdp.model import MOMDP
from coadapt.momdp.transition import SparseTransition

SAME = 1e-13
"""Largest difference between probabilities that count as the same."""

Rows = sparse.csr_array
"""A conditional map ``[Y, Y']``."""


@dataclass(frozen=True)
class Conditionals:
    """The factors of all edges.

    Attributes:
        chance: ``[E, Y]`` or ``[E, 1]`` where y does not matter: ``P(x' | x, y, a)``.
        maps: the different conditional maps.
        by_edge: whether they depend on x'.
        choice: ``[A, X]`` the map of each (x, a), or ``[E]`` that of each edge.
    """

    chance: FloatArray
    maps: list[Rows]
    by_edge: bool
    choice: IntArray


def conditionals(problem: MOMDP, transition: SparseTransition) -> Conditionals:
    """Split the maps of ``problem``, whose every (x, a) has successors."""
    states, size, actions, _ = problem.shape
    sums = transition.row_sums()
    spread = sums.max(axis=1) - sums.min(axis=1)
    if (spread[problem.edge_map] <= SAME).all():
        chance = sums[problem.edge_map, :1]
        sums = np.repeat(sums[:, :1], size, axis=1)
    else:
        chance = sums[problem.edge_map]
    maps = _Maps(size)
    own = [maps.divided(transition, k, sums[k]) for k in range(transition.count)]
    choice = np.empty((actions, states), dtype=np.int64)
    known: dict[tuple[int, ...], int | None] = {}
    for x in range(states):
        for a in range(actions):
            edges = problem.edges(x, a)
            used = tuple(int(problem.edge_map[e]) for e in edges)
            if used not in known:
                known[used] = maps.merged([own[k] for k in used], [sums[k] > 0 for k in used])
            merged = known[used]
            if merged is None:
                by_edge = np.array([own[k] for k in problem.edge_map.tolist()], dtype=np.int64)
                return Conditionals(chance, maps.found, True, by_edge)
            choice[a, x] = merged
    return Conditionals(chance, maps.found, False, choice)


class _Maps:
    """A list of different maps."""

    def __init__(self, size: int) -> None:
        self.found: list[Rows] = []
        self._size = size
        self._known: dict[tuple[bytes, bytes, bytes], int] = {}

    def add(self, rows: Rows) -> int:
        """The number of ``rows``."""
        rows.sort_indices()
        key = (
            np.asarray(rows.indptr, dtype=np.int64).tobytes(),
            np.asarray(rows.indices, dtype=np.int64).tobytes(),
            rows.data.tobytes(),
        )
        number = self._known.setdefault(key, len(self.found))
        if number == len(self.found):
            self.found.append(rows)
        return number

    def divided(self, transition: SparseTransition, k: int, sums: FloatArray) -> int:
        """The number of map ``k`` with its rows divided by ``sums``, the identity where 0."""
        size = self._size
        start = transition.row_start[k * size : (k + 1) * size + 1]
        part = slice(start[0], start[-1])
        scale = np.repeat(np.where(sums > 0, sums, 1.0), np.diff(start))
        rows = sparse.csr_array(
            (transition.value[part] / scale, transition.column[part], start - start[0]),
            shape=(size, size),
        )
        rows.sum_duplicates()
        rows.eliminate_zeros()
        if (sums <= 0).any():
            rows = sparse.csr_array(rows + sparse.diags_array((sums <= 0).astype(np.float64)))
            rows.eliminate_zeros()
        return self.add(rows)

    def merged(self, numbers: list[int], defined: list[np.ndarray]) -> int | None:
        """The map that agrees with each of ``numbers`` in its defined rows; None if none does."""
        if len(set(numbers)) == 1:
            return numbers[0]
        left = np.ones(self._size, dtype=np.bool_)
        total = sparse.csr_array((self._size, self._size))
        for number, rows in zip(numbers, defined, strict=True):
            new = sparse.diags_array((rows & left).astype(np.float64))
            total = sparse.csr_array(total + new @ self.found[number])
            left &= ~rows
        total = sparse.csr_array(total + sparse.diags_array(left.astype(np.float64)))
        total.eliminate_zeros()
        for number, rows in zip(numbers, defined, strict=True):
            only = sparse.diags_array(rows.astype(np.float64))
            difference = abs(only @ (self.found[number] - total))
            if difference.nnz and difference.max() > SAME:
                return None
        return self.add(total)
