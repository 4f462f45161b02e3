"""From operations on cells to slices: every different slice once, without its zeros."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.errors import FileError
from coadapt.momdp.files.limits import MAX_ENTRIES
from coadapt.momdp.files.sparse_rows import SparseRows, expanded, starts

BLOCK = 1_000_000
"""Entries of operations that are put in order together."""

NOTHING = -1
"""Instead of an operation: there is none."""


@dataclass(frozen=True)
class Operations:
    """What entries do to slices.

    Attributes:
        full: ``[P]`` whether an operation sets everything; what it does not mention becomes 0.
        start: ``[P + 1]``; operation ``p`` is ``start[p] : start[p + 1]`` of the next two.
        index: place in the slice, each once in an operation.
        value: what it becomes.
    """

    full: BoolArray
    start: IntArray
    index: IntArray
    value: FloatArray


@dataclass(frozen=True)
class Slices:
    """The different slices of a table.

    Attributes:
        cells: ``[N]`` the cells whose slice is not number 0, ascending.
        slice_of: ``[N]`` the slice of each.
        start: ``[S + 1]``; slice ``s`` is ``start[s] : start[s + 1]`` of the next two.
        index: linear index over the inner axes, ascending within a slice.
        value: the value there, not 0.
    """

    cells: IntArray
    slice_of: IntArray
    start: IntArray
    index: IntArray
    value: FloatArray

    @property
    def count(self) -> int:
        """Number of slices ``S``."""
        return len(self.start) - 1

    def at(self, cells: IntArray) -> IntArray:
        """The slice of each of ``cells``, any shape."""
        if len(self.cells) == 0:
            return np.zeros_like(cells)
        place = np.minimum(np.searchsorted(self.cells, cells), len(self.cells) - 1)
        return np.where(self.cells[place] == cells, self.slice_of[place], 0)

    def owner(self) -> IntArray:
        """``[nnz]`` the slice that each entry belongs to."""
        return np.repeat(np.arange(self.count), np.diff(self.start))


def build_slices(
    path: object, operations: Operations, base: int, cell: IntArray, op: IntArray
) -> Slices:
    """Apply operations.

    Args:
        path: the file, for error messages.
        operations: what there is to apply.
        base: the operation applied to all cells first, or `NOTHING`.
        cell: ``[L]`` a cell.
        op: ``[L]`` the operation applied to it, in this order.

    Raises:
        FileError: if the result exceeds a limit.
    """
    cell, op, start = _latest(operations, cell, op)
    chains, chain_of = _different_chains(operations, base, op, start)
    rows = _applied(path, operations, chains)
    rows, number = _different_rows(rows)
    # Row 0 is the base alone: the slice of all cells that are not listed.
    slice_of = number[chain_of]
    kept = slice_of > 0
    return Slices(cell[start[:-1]][kept], slice_of[kept], rows.start, rows.index, rows.value)


def _latest(
    operations: Operations, cell: IntArray, op: IntArray
) -> tuple[IntArray, IntArray, IntArray]:
    """Cells and operations that still matter, ordered by cell; and where each cell starts."""
    if len(cell) == 0:
        return cell, op, np.zeros(1, dtype=np.int64)
    order = np.argsort(cell, kind="stable")
    cell, op = cell[order], op[order]
    new = np.ones(len(cell), dtype=np.bool_)
    new[1:] = cell[1:] != cell[:-1]
    first = np.flatnonzero(new)
    length = np.diff(np.append(first, len(cell)))
    place = np.arange(len(cell))
    last_full = np.maximum.reduceat(np.where(operations.full[op], place, -1), first)
    kept = place >= np.repeat(last_full, length)
    sizes = np.add.reduceat(kept.astype(np.int64), first)
    return cell[kept], op[kept], starts(sizes)


def _different_chains(
    operations: Operations, base: int, op: IntArray, start: IntArray
) -> tuple[SparseRows, IntArray]:
    """The different sequences of operations, that of the base alone first; and which each cell has.

    The sequences are returned as rows whose index is the operation.
    """
    length = np.diff(start)
    lengths: list[IntArray] = [np.array([int(base != NOTHING)])]
    found: list[IntArray] = [np.array([base] if base != NOTHING else [], dtype=np.int64)]
    chain_of = np.zeros(len(length), dtype=np.int64)
    count = 1
    for size in np.unique(length):
        cells = np.flatnonzero(length == size)
        chains = op[start[cells][:, None] + np.arange(size)]
        # Before what does not set everything comes the base.
        before = np.where(operations.full[chains[:, 0]], NOTHING, base)
        if size == 1:
            span = len(operations.full) + 1
            _, first, back = np.unique(
                (before + 1) * span + chains[:, 0], return_index=True, return_inverse=True
            )
        else:
            _, first, back = np.unique(
                np.column_stack((before, chains)), axis=0, return_index=True, return_inverse=True
            )
        chain_of[cells] = count + back.ravel()
        rows = np.column_stack((before, chains))[first]
        lengths.append((rows != NOTHING).sum(axis=1))
        found.append(rows[rows != NOTHING])
        count += len(rows)
    flat = np.concatenate(found)
    return SparseRows(starts(np.concatenate(lengths)), flat, np.zeros(0)), chain_of


def _applied(path: object, operations: Operations, chains: SparseRows) -> SparseRows:
    """The slice that each sequence of operations makes."""
    size = np.diff(operations.start)
    work = starts(size[chains.index])[chains.start]  # entries before each chain
    parts: list[SparseRows] = []
    total = first = 0
    count = len(chains.start) - 1
    if work[-1] > 4 * MAX_ENTRIES:
        raise _too_large(path, int(work[-1]))
    while first < count:
        last = max(first + 1, int(np.searchsorted(work, work[first] + BLOCK, side="right")) - 1)
        ops = chains.index[chains.start[first] : chains.start[last]]
        owner = np.repeat(np.arange(last - first), np.diff(chains.start[first : last + 1]))
        which, place = expanded(operations.start, ops)
        owner, index, value = owner[which], operations.index[place], operations.value[place]
        # Later operations stay behind earlier ones.
        order = np.lexsort((index, owner))
        owner, index, value = owner[order], index[order], value[order]
        kept = value != 0
        kept[:-1] &= (index[1:] != index[:-1]) | (owner[1:] != owner[:-1])
        lengths = np.bincount(owner[kept], minlength=last - first)
        parts.append(SparseRows(starts(lengths), index[kept], value[kept]))
        total += len(parts[-1].index)
        if total > MAX_ENTRIES:
            raise _too_large(path, total)
        first = last
    return SparseRows(
        starts(np.concatenate([np.diff(part.start) for part in parts])),
        np.concatenate([part.index for part in parts]),
        np.concatenate([part.value for part in parts]),
    )


def _different_rows(rows: SparseRows) -> tuple[SparseRows, IntArray]:
    """The different rows, the first first; and for each row which of them it is.

    Rows are compared by a hash, and then with the first of the same hash. Should two different rows
    have the same hash, the second is kept as it is.
    """
    count = len(rows.start) - 1
    length = np.diff(rows.start)
    # Odd multipliers mix the bits; sums of 64 bits wrap around.
    mixed = rows.value.view(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    mixed ^= rows.index.astype(np.uint64) * np.uint64(0xC2B2AE3D27D4EB4F)
    mixed ^= mixed >> np.uint64(29)
    mixed *= np.uint64(0xBF58476D1CE4E5B9)
    sums = np.concatenate((np.zeros(1, dtype=np.uint64), np.cumsum(mixed, dtype=np.uint64)))
    key = sums[rows.start[1:]] - sums[rows.start[:-1]] + length.astype(np.uint64)
    _, first, back = np.unique(key, return_index=True, return_inverse=True)
    like = first[back]  # the first row with the same hash
    shorter = length != length[like]
    like[shorter] = np.flatnonzero(shorter)
    own, place = expanded(rows.start, np.arange(count))
    other = place - rows.start[own] + rows.start[like[own]]
    differs = (rows.index[place] != rows.index[other]) | (rows.value[place] != rows.value[other])
    alone = np.unique(own[differs])
    like[alone] = alone
    kept = like == np.arange(count)
    number = np.cumsum(kept) - 1
    return rows.take(np.flatnonzero(kept)), number[like]


def _too_large(path: object, count: int) -> FileError:
    return FileError(
        path,
        None,
        f"found a table with {count:,} entries different from 0, expected at most {MAX_ENTRIES:,}",
    )
