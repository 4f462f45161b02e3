"""Tables that are written entry by entry, where the last entry that sets a cell wins.

Both file formats describe a table ``t[i_1, ..., i_n]`` by entries. An entry fixes some axes
(`int`), holds for every value of others (`WILD`) and lists the values along the rest (`ENUM`).
Cells that no entry sets are 0.

The axes are divided. For each combination of the *outer* axes, a *cell*, the table keeps which
entries touch it; the values over the *inner* axes form its *slice*. Most cells share a slice, so
the slices are built once for each different sequence of entries, and kept without their zeros. No
array of the size of the whole table is ever made.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.errors import FileError
from coadapt.momdp.files.limits import MAX_CELLS, MAX_ENTRIES
from coadapt.momdp.files.sparse_rows import starts

WILD = -1
"""Selector of an entry that holds for every value of an axis."""

ENUM = -2
"""Selector of an entry that lists its values along an axis."""

Selectors = tuple[int, ...]
"""For each axis a value, `WILD` or `ENUM`."""

EMPTY: IntArray = np.zeros(0, dtype=np.int64)


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


class LayeredTable:
    """A table under construction.

    Args:
        path: the file, for error messages.
        sizes: the length of each axis, in the file's order.
        outer: which axes are outer.
    """

    def __init__(self, path: object, sizes: Sequence[int], outer: Sequence[bool]) -> None:
        self.sizes = tuple(sizes)
        self._path = path
        self._outer = [i for i, is_outer in enumerate(outer) if is_outer]
        self._inner = [i for i, is_outer in enumerate(outer) if not is_outer]
        self.outer_sizes = tuple(self.sizes[i] for i in self._outer)
        self.inner_sizes = tuple(self.sizes[i] for i in self._inner)
        self._outer_steps = steps(self.outer_sizes)
        self._inner_steps = steps(self.inner_sizes)
        self._cell, self._op = array("q"), array("q")
        self._base = -1  # the operation that sets everything, before all others
        self._operations: dict[tuple[Selectors, bytes, bytes], int] = {}
        self._full: list[bool] = []
        self._set: list[tuple[IntArray, FloatArray]] = []
        self._spent = 0
        self._stored = 0
        self.entries: list[tuple[int, Selectors]] = []
        if math.prod(self.sizes) > 2**62:
            raise FileError(path, None, f"found a table of {self.sizes} entries, expected fewer")

    def set(self, line: int, selectors: Selectors, values: FloatArray) -> None:
        """Set cells to ``values``, flat over the `ENUM` axes.

        Raises:
            FileError: if this exceeds a limit.
        """
        self.entries.append((line, selectors))
        if ENUM not in selectors:
            pattern = tuple([selectors[i] for i in self._inner])
            self._log(self._cells(line, selectors)[0], self._constant(line, pattern, values))
            return
        outer = [i for i in self._outer if selectors[i] == ENUM]
        inner = [i for i in self._inner if selectors[i] == ENUM]
        if outer and inner and outer[-1] > inner[0]:
            listed = [i for i, s in enumerate(selectors) if s == ENUM]
            shape = [self.sizes[i] for i in listed]
            values = values.reshape(shape).transpose([listed.index(i) for i in outer + inner])
        rows = values.reshape(math.prod(self.sizes[i] for i in outer), -1)
        cells = self._cells(line, selectors)
        pattern = tuple(selectors[i] for i in self._inner)
        for row, at in zip(rows, cells, strict=True):
            nonzero = np.flatnonzero(row)
            self._log(at, self._operation(line, pattern, nonzero, row[nonzero]))

    def set_identity(self, line: int, selectors: Selectors) -> None:
        """Set the identity matrix over the two `ENUM` axes, of which the last is inner.

        Raises:
            FileError: if this exceeds a limit.
        """
        first, last = (i for i, s in enumerate(selectors) if s == ENUM)
        size = self.sizes[last]
        cells = self._cells(line, selectors)
        pattern = tuple(selectors[i] for i in self._inner)
        self.entries.append((line, selectors))
        if first in self._inner:
            diagonal = np.arange(size) * (size + 1)
            self._log(cells[0], self._operation(line, pattern, diagonal, np.ones(size)))
            return
        for value in range(size):
            unit = self._operation(line, pattern, np.array([value]), np.ones(1))
            self._log(cells[value], unit)

    def line_of(self, place: Sequence[int]) -> int | None:
        """The line of the last entry that sets cells at ``place``; `WILD` there means any."""
        for line, selectors in reversed(self.entries):
            if all(s < 0 or p < 0 or s == p for s, p in zip(selectors, place, strict=True)):
                return line
        return None

    def place(self, cell: int, index: int) -> Selectors:
        """The values of all axes, in the file's order, from linear indices."""
        where = [WILD] * len(self.sizes)
        for axes, axis_steps, linear in (
            (self._outer, self._outer_steps, cell),
            (self._inner, self._inner_steps, index),
        ):
            for i, step in zip(axes, axis_steps, strict=True):
                where[i] = linear // step % self.sizes[i]
        return tuple(where)

    def slices(self) -> Slices:
        """Apply the entries.

        Raises:
            FileError: if the result exceeds a limit.
        """
        cell, op, start = self._latest()
        base = self._slice_of_operations(() if self._base < 0 else (self._base,))
        found: dict[tuple[bytes, bytes], int] = {(base[0].tobytes(), base[1].tobytes()): 0}
        parts = [base]
        slice_of = np.zeros(len(start) - 1, dtype=np.int64)
        length = np.diff(start)
        full = np.array(self._full, dtype=np.bool_)
        size = np.array([len(index) for index, _ in self._set], dtype=np.int64)
        total = work = 0
        for count in np.unique(length):
            groups = np.flatnonzero(length == count)
            chains = op[start[groups][:, None] + np.arange(count)]
            prefix = np.where(full[chains[:, 0]], -1, self._base)
            chains, back = _unique_rows(np.column_stack((prefix, chains)))
            work += int(np.where(chains >= 0, size[chains], 0).sum())
            if work > 2 * MAX_ENTRIES:
                raise self._too_large(None, work)
            numbers = np.empty(len(chains), dtype=np.int64)
            for i, chain in enumerate(chains.tolist()):
                part = self._slice_of_operations(tuple(o for o in chain if o >= 0))
                key = (part[0].tobytes(), part[1].tobytes())
                numbers[i] = found.setdefault(key, len(parts))
                if numbers[i] == len(parts):
                    parts.append(part)
                    total += len(part[0])
                    if total > MAX_ENTRIES:
                        raise self._too_large(None, total)
            slice_of[groups] = numbers[back]
        kept = slice_of > 0
        ends = np.cumsum([0, *(len(index) for index, _ in parts)])
        return Slices(
            cells=cell[start[:-1]][kept],
            slice_of=slice_of[kept],
            start=ends.astype(np.int64),
            index=np.concatenate([index for index, _ in parts]),
            value=np.concatenate([value for _, value in parts]),
        )

    def _cells(self, line: int, selectors: Selectors) -> IntArray | Sequence[Sequence[int]]:
        """``[enumerated, wild]`` the cells that ``selectors`` choose."""
        fixed, many = 0, 1
        for i, step in zip(self._outer, self._outer_steps, strict=True):
            if selectors[i] >= 0:
                fixed += selectors[i] * step
            else:
                many *= self.sizes[i]
        if many == 1 or self._whole(selectors):
            return ((fixed,),)
        self._spent += many
        if self._spent > MAX_CELLS:
            raise FileError(
                self._path,
                line,
                f"found wildcards and matrices that set more than {MAX_CELLS:,} rows of one table, "
                "expected fewer",
            )
        chosen = tuple(selectors[i] for i in self._outer)
        listed = tuple(s if s == ENUM else 0 for s in chosen)
        wild = tuple(s if s == WILD else 0 for s in chosen)
        return (
            fixed
            + self._grid(listed, self.outer_sizes)[:, None]
            + self._grid(wild, self.outer_sizes)[None, :]
        )

    def _whole(self, selectors: Selectors) -> bool:
        """Whether one operation sets the whole table."""
        return all(selectors[i] == WILD for i in self._outer) and all(
            selectors[i] < 0 for i in self._inner
        )

    def _grid(self, selectors: Selectors, sizes: tuple[int, ...]) -> IntArray:
        """Offsets of all values of the axes that ``selectors`` mark, the last axis fastest."""
        offsets: IntArray = np.zeros(1, dtype=np.int64)
        for s, size, step in zip(selectors, sizes, steps(sizes), strict=True):
            if s < 0:
                offsets = (offsets[:, None] + np.arange(size, dtype=np.int64) * step).ravel()
        return offsets

    def _operation(
        self, line: int, pattern: Selectors, nonzero: IntArray, values: FloatArray
    ) -> int:
        """The number of the operation that sets ``pattern`` to ``values`` at ``nonzero``."""
        key = (pattern, nonzero.tobytes(), values.tobytes())
        known = self._operations.get(key)
        if known is not None:
            return known
        full = all(s < 0 for s in pattern)
        fixed = sum(s * k for s, k in zip(pattern, self._inner_steps, strict=True) if s >= 0)
        wild = math.prod(n for n, s in zip(self.inner_sizes, pattern, strict=True) if s == WILD)
        listed = tuple(s if s == ENUM else 0 for s in pattern)
        many = math.prod(n for n, s in zip(self.inner_sizes, pattern, strict=True) if s == ENUM)
        self._stored += wild * (len(nonzero) if full else many)
        if self._stored > 2 * MAX_ENTRIES:
            raise self._too_large(line, self._stored)
        if full:
            axes = [i for i, s in enumerate(pattern) if s == ENUM]
            rest, index = nonzero, np.full(len(nonzero), fixed, dtype=np.int64)
            for i in reversed(axes):
                index += rest % self.inner_sizes[i] * self._inner_steps[i]
                rest = rest // self.inner_sizes[i]
            set_values = values
        else:
            index = fixed + self._grid(listed, self.inner_sizes)
            set_values = np.zeros(many)
            set_values[nonzero] = values
        if wild > 1:
            every = tuple(s if s == WILD else 0 for s in pattern)
            index = (index[:, None] + self._grid(every, self.inner_sizes)).ravel()
            set_values = np.repeat(set_values, wild)
        self._full.append(full)
        self._set.append((index, set_values))
        self._operations[key] = len(self._set) - 1
        return len(self._set) - 1

    def _constant(self, line: int, pattern: Selectors, value: FloatArray) -> int:
        """The number of the operation that sets ``pattern`` to one value."""
        key = (pattern, b"", value.tobytes())
        known = self._operations.get(key)
        if known is None:
            nonzero = np.flatnonzero(value)
            known = self._operation(line, pattern, nonzero, value[nonzero])
            self._operations[key] = known
        return known

    def _log(self, cells: IntArray | Sequence[int], op: int) -> None:
        if self._full[op] and self._whole(self.entries[-1][1]):
            self._cell, self._op = array("q"), array("q")
            self._base = op
        elif len(cells) == 1:
            self._cell.append(int(cells[0]))
            self._op.append(op)
        else:
            self._cell.extend(cells)
            self._op.extend([op] * len(cells))

    def _latest(self) -> tuple[IntArray, IntArray, IntArray]:
        """Cells and operations that still matter, by cell in order; and where each cell starts."""
        cell = np.array(self._cell, dtype=np.int64)
        op = np.array(self._op, dtype=np.int64)
        if len(cell) == 0:
            return EMPTY, EMPTY, np.zeros(1, dtype=np.int64)
        order = np.argsort(cell, kind="stable")
        cell, op = cell[order], op[order]
        first = np.flatnonzero(np.r_[True, cell[1:] != cell[:-1]])
        group = np.cumsum(np.r_[True, cell[1:] != cell[:-1]]) - 1
        place = np.arange(len(cell))
        full = np.array(self._full, dtype=np.bool_)[op]
        last_full = np.maximum.reduceat(np.where(full, place, -1), first)
        kept = place >= last_full[group]
        sizes = np.add.reduceat(kept.astype(np.int64), first)
        return cell[kept], op[kept], starts(sizes)

    def _slice_of_operations(self, chain: tuple[int, ...]) -> tuple[IntArray, FloatArray]:
        if not chain:
            return EMPTY, np.zeros(0)
        index = np.concatenate([self._set[op][0] for op in chain])
        value = np.concatenate([self._set[op][1] for op in chain])
        order = np.argsort(index, kind="stable")
        index, value = index[order], value[order]
        kept = (value != 0) & np.r_[index[1:] != index[:-1], True][: len(index)]
        return index[kept], value[kept]

    def _too_large(self, line: int | None, count: int) -> FileError:
        return FileError(
            self._path,
            line,
            f"found a table with {count:,} entries different from 0, "
            f"expected at most {MAX_ENTRIES:,}",
        )


def steps(sizes: Sequence[int]) -> tuple[int, ...]:
    """How far apart neighbours along each axis are in a linear index."""
    return tuple(math.prod(sizes[i + 1 :]) for i in range(len(sizes)))


def _unique_rows(rows: IntArray) -> tuple[IntArray, IntArray]:
    """The different rows, and for each row which of them it is."""
    if rows.shape[1] <= 2:
        span = int(rows[:, -1].max()) + 1
        _, first, back = np.unique(
            (rows[:, 0] + 1) * span + rows[:, -1], return_index=True, return_inverse=True
        )
        return rows[first], back
    different, back = np.unique(rows, axis=0, return_inverse=True)
    return different, back.ravel()
