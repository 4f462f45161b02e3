"""How the hidden state moves: a stack of linear maps, applied without building them.

For every successor ``x'`` of an observed state and action (an *edge*) a MOMDP holds the joint
probability ``J[y, y'] = P(x', y' | x, y, a)``. Summed over the edges of one ``(x, a)`` its rows are
distributions; a single map may be sub-stochastic. Many edges share one map, so maps are kept in a
stack and edges refer to them by index. Two ways of keeping the stack:

`SparseTransition`
    any matrices, row by row, zeros left out.
`JumpTransition`
    hidden states ``y = (i, m)``, blocks ``i`` of ``M`` values. Within its block the state jumps
    to ``m'`` with probability ``rate[i, m'] * target[k, m']`` and stays otherwise: the identity
    plus a rank-one map for each block, applied in O(|Y|). An optional ``mixing`` matrix then moves
    between blocks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy import sparse

from coadapt.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class SparseTransition:
    """A stack of ``K`` sparse maps over ``Y`` hidden states.

    Attributes:
        hidden: number of hidden states ``Y``.
        row_start: ``[K * Y + 1]``; row ``y`` of map ``k`` is the slice
            ``row_start[k * Y + y] : row_start[k * Y + y + 1]`` of the next two.
        column: ``[nnz]`` the hidden state ``y'`` each entry leads to.
        value: ``[nnz]`` its probability, in [0, 1].
    """

    hidden: int
    row_start: IntArray
    column: IntArray
    value: FloatArray

    @property
    def count(self) -> int:
        """Number of maps ``K`` in the stack."""
        return (len(self.row_start) - 1) // self.hidden

    @classmethod
    def from_dense(cls, maps: FloatArray) -> Self:
        """The stack of the matrices ``maps``, shape ``[K, Y, Y]``."""
        count, hidden, _ = maps.shape
        rows = sparse.csr_array(maps.reshape(count * hidden, hidden))
        rows.eliminate_zeros()
        rows.sort_indices()
        return cls(
            hidden=hidden,
            row_start=rows.indptr.astype(np.int64),
            column=rows.indices.astype(np.int64),
            value=rows.data.astype(np.float64),
        )

    def matrix(self, k: int) -> FloatArray:
        """Map ``k`` as a dense ``[Y, Y]`` array."""
        dense = np.zeros((self.hidden, self.hidden))
        for y in range(self.hidden):
            row = slice(
                self.row_start[k * self.hidden + y], self.row_start[k * self.hidden + y + 1]
            )
            np.add.at(dense[y], self.column[row], self.value[row])
        return dense

    def forward(self, k: int, mass: FloatArray) -> FloatArray:
        """``mass @ J_k``: probability mass over ``y``, shape ``[Y]``, carried to ``y'``."""
        first, last = k * self.hidden, (k + 1) * self.hidden
        start, stop = self.row_start[first], self.row_start[last]
        weights = np.repeat(mass, np.diff(self.row_start[first : last + 1]))
        moved = weights * self.value[start:stop]
        out = np.zeros(self.hidden)
        np.add.at(out, self.column[start:stop], moved)
        return out

    def row_sums(self) -> FloatArray:
        """``[K, Y]`` the total probability of each row."""
        rows = len(self.row_start) - 1
        row_of_entry = np.repeat(np.arange(rows), np.diff(self.row_start))
        sums = np.zeros(rows)
        np.add.at(sums, row_of_entry, self.value)
        return sums.reshape(self.count, self.hidden)


@dataclass(frozen=True)
class JumpTransition:
    """A stack of ``K`` stay-or-jump maps over ``B`` blocks of ``M`` values, ``Y = B * M``.

    Attributes:
        rate: ``[B, M]`` readiness to jump to each value, in [0, 1].
        target: ``[K, M]`` distribution the jump of map ``k`` is drawn from.
        mixing: ``[B, B]`` row-stochastic matrix over blocks applied after the jump, or None for
            the identity.
    """

    rate: FloatArray
    target: FloatArray
    mixing: FloatArray | None = None

    @property
    def count(self) -> int:
        """Number of maps ``K`` in the stack."""
        return len(self.target)

    @property
    def hidden(self) -> int:
        """Number of hidden states ``Y``."""
        return self.rate.size

    def forward(self, k: int, mass: FloatArray) -> FloatArray:
        """``mass @ J_k``: probability mass over ``y``, shape ``[Y]``, carried to ``y'``."""
        blocks = mass.reshape(self.rate.shape)
        jump = self.rate * self.target[k]
        stay = 1.0 - jump.sum(axis=1, keepdims=True)
        moved = stay * blocks + jump * blocks.sum(axis=1, keepdims=True)
        if self.mixing is not None:
            moved = self.mixing.T @ moved
        return moved.ravel()

    def matrix(self, k: int) -> FloatArray:
        """Map ``k`` as a dense ``[Y, Y]`` array."""
        return np.stack([self.forward(k, unit) for unit in np.eye(self.hidden)])

    def scaled(self, which: IntArray, scale: FloatArray) -> SparseTransition:
        """Parts of these maps as matrices: for successors that are reached by chance.

        Args:
            which: ``[K']`` the map each is a part of.
            scale: ``[K']`` its share, in [0, 1].
        """
        size, (blocks, values) = self.hidden, self.rate.shape
        jump = self.rate * self.target[which][:, None, :]  # [K', B, M']
        # Rounding must not make it negative where a jump is certain.
        stay = np.maximum(1.0 - jump.sum(axis=2), 0.0)
        within = np.repeat(jump[:, :, None, :], values, axis=2)  # [K', B, M, M']
        within += stay[:, :, None, None] * np.eye(values)
        mixing = np.eye(blocks) if self.mixing is None else self.mixing
        maps = np.einsum("k,bc,kbmn->kbmcn", scale, mixing, within)
        return SparseTransition.from_dense(maps.reshape(len(which), size, size))

    def row_sums(self) -> FloatArray:
        """``[K, Y]`` the total probability of each row."""
        sums = np.ones((self.count, self.hidden))
        if self.mixing is None:
            return sums
        return sums * np.repeat(self.mixing.sum(axis=1), self.rate.shape[1])


HiddenTransition = SparseTransition | JumpTransition
