"""Products of conditional distributions: joint distributions, one factor after the other.

A frame is a list of partial assignments with their probabilities. A factor extends each row of the
frame by every value that its table gives a probability to. Zeros never appear, so the work is that
of the result.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.errors import FileError
from coadapt.momdp.files.limits import MAX_ENTRIES
from coadapt.momdp.files.pomdpx_entries import Factor
from coadapt.momdp.files.pomdpx_variables import Axis
from coadapt.momdp.files.slices import Slices
from coadapt.momdp.files.sparse_rows import expanded, starts

Key = tuple[str, int, bool]
"""Names an axis: see `Axis.key`."""


def linear(axes: Sequence[Axis], values: Callable[[Axis], IntArray], count: int) -> IntArray:
    """``[count]`` the linear index over ``axes``, the last fastest, given their values."""
    index = np.zeros(count, dtype=np.int64)
    for axis in axes:
        index = index * axis.variable.size + values(axis)
    return index


def check_growth(path: object, line: int | None, start: IntArray, rows: IntArray) -> None:
    """Refuse an expansion that would be too large.

    Raises:
        FileError: if it would.
    """
    total = int((start[rows + 1] - start[rows]).sum())
    if total > MAX_ENTRIES:
        raise FileError(
            path,
            line,
            f"found {total:,} combinations with a probability above 0, "
            f"expected at most {MAX_ENTRIES:,}",
        )


@final
@dataclass(frozen=True)
class Distribution:
    """A factor in rows: slice and parents choose a row, its entries are values.

    Attributes:
        factor: the table.
        slices: its slices, normalised.
        start: ``[S * P + 1]`` where each row begins.
    """

    factor: Factor
    slices: Slices
    start: IntArray

    @classmethod
    def of(cls, factor: Factor, slices: Slices) -> Distribution:
        """The rows of ``factor``."""
        size = factor.axes[-1].variable.size
        parents = count_of(factor.inner[:-1])
        row = slices.owner() * parents + slices.index // size
        counts = np.bincount(row, minlength=slices.count * parents)
        return cls(factor, slices, starts(counts))

    @property
    def axis(self) -> Axis:
        """What the factor is about."""
        return self.factor.axes[-1]

    def rows(self, slice_of: IntArray, values: Callable[[Axis], IntArray]) -> IntArray:
        """The rows for slices ``slice_of`` and parents with the given values."""
        parents = self.factor.inner[:-1]
        return slice_of * count_of(parents) + linear(parents, values, len(slice_of))


def count_of(axes: Sequence[Axis]) -> int:
    """The number of combinations of ``axes``."""
    return int(np.prod([axis.variable.size for axis in axes], dtype=np.int64))


def in_order(path: object, factors: Sequence[Factor]) -> list[Factor]:
    """``factors`` such that each comes after those that its parents are about.

    Raises:
        FileError: if some depend on each other in a circle.
    """
    waiting = list(factors)
    ready: list[Factor] = []
    while waiting:
        pending = {factor.axes[-1].key for factor in waiting}
        free = [f for f in waiting if not any(axis.key in pending for axis in f.axes[:-1])]
        if not free:
            raise FileError(
                path,
                waiting[0].line,
                f"found {waiting[0].name} depending on itself by way of its parents, expected "
                "no circle",
            )
        ready += free
        waiting = [f for f in waiting if f not in free]
    return ready


@final
class Frame:
    """Partial assignments with their probabilities.

    Args:
        path: the file, for error messages.
        columns: the values of the axes assigned so far, ``[N]`` each.
        weight: ``[N]`` their probabilities.
    """

    def __init__(self, path: object, columns: Mapping[Key, IntArray], weight: FloatArray) -> None:
        self._path = path
        self.columns = dict(columns)
        self.weight = weight
        self.origin = np.arange(len(weight))

    def value(self, axis: Axis) -> IntArray:
        """``[N]`` the values of ``axis``."""
        return self.columns[axis.key]

    def extend(self, distribution: Distribution, slice_of: IntArray) -> None:
        """Assign what ``distribution`` is about.

        Args:
            distribution: a factor whose parents are assigned.
            slice_of: ``[N]`` the slice that holds in each row.

        Raises:
            FileError: if the frame becomes too large.
        """
        rows = distribution.rows(slice_of, self.value)
        check_growth(self._path, distribution.factor.line, distribution.start, rows)
        which, place = expanded(distribution.start, rows)
        size = distribution.axis.variable.size
        self.take(which)
        self.columns[distribution.axis.key] = distribution.slices.index[place] % size
        self.weight = self.weight * distribution.slices.value[place]

    def take(self, which: IntArray) -> None:
        """Keep the rows ``which``, in this order."""
        self.columns = {key: column[which] for key, column in self.columns.items()}
        self.weight = self.weight[which]
        self.origin = self.origin[which]
