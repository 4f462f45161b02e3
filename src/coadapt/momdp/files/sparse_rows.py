"""Rows of numbers without their zeros, one after the other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coadapt.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class SparseRows:
    """A list of rows.

    Attributes:
        start: ``[N + 1]``; row ``n`` is ``start[n] : start[n + 1]`` of the next two.
        index: ``[nnz]`` column.
        value: ``[nnz]``.
    """

    start: IntArray
    index: IntArray
    value: FloatArray

    def take(self, rows: IntArray) -> SparseRows:
        """The rows ``rows``, in this order."""
        _, place = expanded(self.start, rows)
        length = self.start[rows + 1] - self.start[rows]
        return SparseRows(starts(length), self.index[place], self.value[place])

    def owner(self) -> IntArray:
        """``[nnz]`` the row of each entry."""
        return np.repeat(np.arange(len(self.start) - 1), np.diff(self.start))


def starts(length: IntArray) -> IntArray:
    """``[N + 1]`` where rows of the given lengths begin, and where the last ends."""
    start: IntArray = np.zeros(len(length) + 1, dtype=np.int64)
    np.cumsum(length, out=start[1:])
    return start


def expanded(start: IntArray, rows: IntArray) -> tuple[IntArray, IntArray]:
    """All entries of ``rows``: which of the rows each belongs to, and its place."""
    length = start[rows + 1] - start[rows]
    begin = starts(length)
    which: IntArray = np.repeat(np.arange(len(rows)), length)
    place: IntArray = np.repeat(start[rows] - begin[:-1], length) + np.arange(len(which))
    return which, place


def different_rows(rows: IntArray) -> tuple[IntArray, IntArray]:
    """The different rows of a matrix, and for each row which of them it is."""
    known: dict[bytes, int] = {}
    number = np.array([known.setdefault(row.tobytes(), len(known)) for row in rows], dtype=np.int64)
    first = np.unique(number, return_index=True)[1]
    return rows[first], number
