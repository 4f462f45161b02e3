"""Tables that are written entry by entry, where the last entry that sets a cell wins.

Both file formats describe a table ``t[i_1, ..., i_n]`` by entries. An entry fixes some axes
(`int`), holds for every value of others (`WILD`) and lists the values along the rest (`ENUM`).
Cells that no entry sets are 0.

The axes are divided. For each combination of the *outer* axes, a *cell*, the table keeps which
entries touch it; the values over the *inner* axes form its *slice*. What an entry does to a slice
is an *operation*. Most cells share their slice: slices are built once for each different sequence
of operations and kept without their zeros. No array of the size of the whole table is ever made.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from typing import final

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.errors import FileError
from coadapt.momdp.files.limits import MAX_CELLS, MAX_ENTRIES
from coadapt.momdp.files.slices import Operations, Slices, build_slices

WILD = -1
"""Selector of an entry that holds for every value of an axis."""

ENUM = -2
"""Selector of an entry that lists its values along an axis."""

NOTHING = -1
"""Instead of an operation: there is none."""

KNOWN = 500_000
"""Operations that are used again where entries repeat."""

Selectors = tuple[int, ...]
"""For each axis a value, `WILD` or `ENUM`."""


@final
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
        # Which operation is applied to which cell, in order.
        self._cell, self._op = array("q"), array("q")
        self._base = NOTHING  # the operation that sets the whole table, before all others
        self._known: dict[tuple[Selectors, bytes, bytes], int] = {}
        self._op_full = array("b")
        self._op_start, self._op_index, self._op_value = array("q", [0]), array("q"), array("d")
        self._spent = 0
        self._entry_line, self._entry_selectors = array("q"), array("q")
        if math.prod(self.sizes) > 2**62:
            raise FileError(path, None, f"found a table of {self.sizes} entries, expected fewer")

    def set(self, line: int, selectors: Selectors, values: FloatArray) -> None:
        """Set cells to ``values``, flat over the `ENUM` axes.

        Raises:
            FileError: if this exceeds a limit.
        """
        self._note(line, selectors)
        pattern = tuple([selectors[i] for i in self._inner])
        if ENUM not in selectors:
            key = (pattern, b"", values.tobytes())
            op = self._known.get(key)
            if op is None:
                nonzero = np.flatnonzero(values)
                op = self._operation(line, pattern, nonzero, values[nonzero])
                self._remember(key, op)
            self._log(self._cells(line, selectors)[0], op, self._is_whole(selectors))
            return
        outer = [i for i in self._outer if selectors[i] == ENUM]
        inner = [i for i in self._inner if selectors[i] == ENUM]
        if outer and inner and outer[-1] > inner[0]:
            listed = [i for i, s in enumerate(selectors) if s == ENUM]
            shape = [self.sizes[i] for i in listed]
            values = values.reshape(shape).transpose([listed.index(i) for i in outer + inner])
        rows = values.reshape(math.prod(self.sizes[i] for i in outer), -1)
        whole = self._is_whole(selectors)
        for row, at in zip(rows, self._cells(line, selectors), strict=True):
            nonzero = np.flatnonzero(row)
            key = (pattern, nonzero.tobytes(), row[nonzero].tobytes())
            op = self._known.get(key)
            if op is None:
                op = self._operation(line, pattern, nonzero, row[nonzero])
                self._remember(key, op)
            self._log(at, op, whole)

    def set_identity(self, line: int, selectors: Selectors) -> None:
        """Set the identity matrix over the two `ENUM` axes, of which the last is inner.

        Raises:
            FileError: if this exceeds a limit.
        """
        self._note(line, selectors)
        first, last = (i for i, s in enumerate(selectors) if s == ENUM)
        size = self.sizes[last]
        pattern = tuple(selectors[i] for i in self._inner)
        whole = self._is_whole(selectors)
        cells = self._cells(line, selectors)
        if first in self._inner:
            diagonal = np.arange(size, dtype=np.int64) * (size + 1)
            self._log(cells[0], self._operation(line, pattern, diagonal, np.ones(size)), whole)
            return
        units = self._units(line, pattern, size)
        self._cell.frombytes(np.asarray(cells, dtype=np.int64).tobytes())
        self._op.frombytes(np.repeat(units, len(cells[0])).tobytes())

    def line_of(self, place: Sequence[int]) -> int | None:
        """The line of the last entry that sets cells at ``place``; `WILD` there means any."""
        if not self._entry_line:
            return None
        selectors = np.array(self._entry_selectors, dtype=np.int64)
        selectors = selectors.reshape(len(self._entry_line), len(self.sizes))
        at = np.array(place, dtype=np.int64)
        fits = ((selectors < 0) | (at < 0) | (selectors == at)).all(axis=1)
        return self._entry_line[int(np.flatnonzero(fits)[-1])] if fits.any() else None

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
        full: BoolArray = np.frombuffer(self._op_full, dtype=np.bool_)
        operations = Operations(
            full,
            _integers(self._op_start),
            _integers(self._op_index),
            np.frombuffer(self._op_value, dtype=np.float64),
        )
        return build_slices(
            self._path, operations, self._base, _integers(self._cell), _integers(self._op)
        )

    def _remember(self, key: tuple[Selectors, bytes, bytes], op: int) -> None:
        """Use ``op`` again; the oldest are forgotten when there are too many."""
        if len(self._known) == KNOWN:
            self._known.clear()
        self._known[key] = op

    def _note(self, line: int, selectors: Selectors) -> None:
        self._entry_line.append(line)
        self._entry_selectors.extend(selectors)

    def _is_whole(self, selectors: Selectors) -> bool:
        """Whether one operation sets the whole table."""
        return all(selectors[i] == WILD for i in self._outer) and all(
            selectors[i] < 0 for i in self._inner
        )

    def _cells(self, line: int, selectors: Selectors) -> IntArray | Sequence[Sequence[int]]:
        """``[enumerated, wild]`` the cells that ``selectors`` choose."""
        fixed, many = 0, 1
        for i, step in zip(self._outer, self._outer_steps, strict=True):
            if selectors[i] >= 0:
                fixed += selectors[i] * step
            else:
                many *= self.sizes[i]
        if many == 1 or self._is_whole(selectors):
            return ((fixed,),)
        self._spent += many
        if self._spent > MAX_CELLS:
            raise FileError(
                self._path,
                line,
                f"found wildcards and matrices that set more than {MAX_CELLS:,} rows of one table, "
                "expected fewer",
            )
        chosen = [selectors[i] for i in self._outer]
        return (
            fixed
            + _grid(chosen, ENUM, self.outer_sizes)[:, None]
            + _grid(chosen, WILD, self.outer_sizes)[None, :]
        )

    def _operation(
        self, line: int, pattern: Selectors, nonzero: IntArray, values: FloatArray
    ) -> int:
        """The number of a new operation: ``pattern`` becomes ``values`` at ``nonzero``, else 0.

        Args:
            line: where it stands.
            pattern: selectors of the inner axes.
            nonzero: ``[N]`` linear index over the `ENUM` axes.
            values: ``[N]``.
        """
        full = all(s < 0 for s in pattern)
        wild = math.prod(n for n, s in zip(self.inner_sizes, pattern, strict=True) if s == WILD)
        many = math.prod(n for n, s in zip(self.inner_sizes, pattern, strict=True) if s == ENUM)
        # What sets the whole slice need not mention its zeros.
        self._check_stored(line, wild * (len(nonzero) if full else many))
        if full:
            rest: IntArray = nonzero
            index: IntArray = np.zeros(len(nonzero), dtype=np.int64)
            for i in reversed(range(len(pattern))):
                if pattern[i] == ENUM:
                    index += rest % self.inner_sizes[i] * self._inner_steps[i]
                    rest = rest // self.inner_sizes[i]
        else:
            fixed = sum(s * k for s, k in zip(pattern, self._inner_steps, strict=True) if s >= 0)
            index = fixed + _grid(pattern, ENUM, self.inner_sizes)
            spread = np.zeros(many)
            spread[nonzero] = values
            values = spread
        if wild > 1:
            index = (index[:, None] + _grid(pattern, WILD, self.inner_sizes)).ravel()
            values = np.repeat(values, wild)
        self._op_full.append(full)
        self._op_index.frombytes(index.tobytes())
        self._op_value.frombytes(values.tobytes())
        self._op_start.append(len(self._op_index))
        return len(self._op_full) - 1

    def _units(self, line: int, pattern: Selectors, size: int) -> IntArray:
        """``[size]`` new operations, each of which sets one value of the `ENUM` axis to 1."""
        place, one = np.arange(size, dtype=np.int64), np.ones(1)
        if any(s >= 0 for s in pattern):
            units = [self._operation(line, pattern, place[i : i + 1], one) for i in range(size)]
            return np.array(units, dtype=np.int64)
        self._check_stored(line, math.prod(self.inner_sizes))
        index = (
            _grid(pattern, ENUM, self.inner_sizes)[:, None]
            + _grid(pattern, WILD, self.inner_sizes)[None, :]
        )
        first, begin = len(self._op_full), len(self._op_index)
        self._op_full.extend([True] * size)
        self._op_index.frombytes(index.tobytes())
        self._op_value.extend([1.0] * index.size)
        self._op_start.extend(
            range(begin + index.shape[1], len(self._op_index) + 1, index.shape[1])
        )
        return first + place

    def _check_stored(self, line: int, more: int) -> None:
        """Refuse an operation of ``more`` entries if all together are too many."""
        stored = len(self._op_index) + more
        if stored > MAX_ENTRIES:
            raise FileError(
                self._path,
                line,
                f"found a table with {stored:,} entries different from 0, "
                f"expected at most {MAX_ENTRIES:,}",
            )

    def _log(self, cells: IntArray | Sequence[int], op: int, whole: bool) -> None:
        """Apply an operation to cells."""
        if whole:
            self._cell, self._op = array("q"), array("q")
            self._base = op
        elif len(cells) == 1:
            self._cell.append(int(cells[0]))
            self._op.append(op)
        else:
            self._cell.extend(cells)
            self._op.extend([op] * len(cells))


def steps(sizes: Sequence[int]) -> tuple[int, ...]:
    """How far apart neighbours along each axis are in a linear index."""
    return tuple(math.prod(sizes[i + 1 :]) for i in range(len(sizes)))


def _grid(selectors: Sequence[int], marked: int, sizes: tuple[int, ...]) -> IntArray:
    """Offsets of all values of the axes that are ``marked``, the last axis fastest."""
    offsets: IntArray = np.zeros(1, dtype=np.int64)
    for s, size, step in zip(selectors, sizes, steps(sizes), strict=True):
        if s == marked:
            offsets = (offsets[:, None] + np.arange(size, dtype=np.int64) * step).ravel()
    return offsets


def _integers(values: array[int]) -> IntArray:
    return np.frombuffer(values, dtype=np.int64)
