"""Conditional distributions: the rows of a table, checked and normalised."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from coadapt.errors import FileError
from coadapt.momdp.files.layered import WILD, LayeredTable, Selectors
from coadapt.momdp.files.limits import MAX_REWARDS, check_size
from coadapt.momdp.files.slices import Slices
from coadapt.momdp.files.values import EXACT_SUM, SUM_TOLERANCE


def normalised(path: object, table: LayeredTable, what: Callable[[Selectors], str]) -> Slices:
    """The slices of ``table``, whose rows over the last axis are distributions.

    A sum that is 1 up to `SUM_TOLERANCE` is taken for a rounded 1. Rows without entries stay
    empty: a file may leave out what cannot happen.

    Args:
        path: the file, for error messages.
        table: a table whose last axis is inner.
        what: names the row at a place, in which the last axis is `WILD`.

    Raises:
        FileError: if a row has entries that do not sum to 1.
    """
    slices = table.slices()
    size = table.inner_sizes[-1]
    parents = int(np.prod(table.inner_sizes[:-1], dtype=np.int64))
    check_size(path, None, "rows of tables", (slices.count, parents), MAX_REWARDS)
    row = slices.owner() * parents + slices.index // size
    sums = np.bincount(row, weights=slices.value, minlength=slices.count * parents)
    wrong = (sums != 0) & (np.abs(sums - 1) > SUM_TOLERANCE)
    cells = int(np.prod(table.outer_sizes, dtype=np.int64))
    if len(slices.cells) == cells:
        wrong[:parents] = False  # no cell has slice 0
    if wrong.any():
        at = int(np.argmax(wrong))
        where = _place(table, slices, at // parents, at % parents * size)
        raise FileError(
            path,
            table.line_of(where),
            f"found probabilities of {what(where)} that sum to {sums[at]:.9g}, expected 1",
        )
    scale = np.where((sums == 0) | (np.abs(sums - 1) <= EXACT_SUM), 1.0, sums)
    return replace(slices, value=slices.value / scale[row])


def _place(table: LayeredTable, slices: Slices, number: int, index: int) -> Selectors:
    """A place that has slice ``number``."""
    own = np.flatnonzero(slices.slice_of == number)
    where = list(table.place(int(slices.cells[own[0]]) if len(own) else 0, index))
    where[-1] = WILD
    return tuple(where)
