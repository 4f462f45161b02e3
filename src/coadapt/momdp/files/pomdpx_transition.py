"""The transitions of a `.pomdpx` file: edges between observed states and their hidden maps.

``P(x', y' | x, y, a)`` is the product of one factor for every state variable. For given x, a and x'
each factor reduces to a slice over y and y'. Edges with the same slices share a map.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from scipy import sparse

from coadapt.arrays import FloatArray, IntArray
from coadapt.errors import FileError
from coadapt.momdp.files.limits import MAX_ENTRIES, check_size
from coadapt.momdp.files.pomdpx_entries import Factor
from coadapt.momdp.files.pomdpx_join import (
    Distribution,
    Frame,
    check_growth,
    count_of,
    in_order,
    linear,
)
from coadapt.momdp.files.pomdpx_variables import (
    ACTION,
    HIDDEN,
    OBSERVED,
    Axis,
    Variables,
    combine,
)
from coadapt.momdp.files.rows import normalised
from coadapt.momdp.files.slices import Slices
from coadapt.momdp.files.sparse_rows import expanded, starts
from coadapt.momdp.transition import SparseTransition

CHUNK = 200_000
"""Rows of hidden maps that are built together."""


TOTAL_TOLERANCE = 1e-7
"""How far a product of normalised distributions may be from 1."""


@dataclass(frozen=True)
class Edges:
    """The edges of a problem, by (x, a) in order; see `MOMDP`.

    Attributes:
        x, a: ``[E]`` where each starts.
        start: ``[X * A + 1]``.
        next: ``[E]``.
        map: ``[E]``.
        transition: the maps.
    """

    x: IntArray
    a: IntArray
    start: IntArray
    next: IntArray
    map: IntArray
    transition: SparseTransition

    def source(self) -> IntArray:
        """``[nnz]`` the row of the stack, ``k * Y + y``, that each entry of it belongs to."""
        rows = len(self.transition.row_start) - 1
        return np.repeat(np.arange(rows), np.diff(self.transition.row_start))


@final
class _Observed:
    """The factor of an observed variable: for every slice the values it allows, each with its
    own table over the hidden parents (a *part*)."""

    def __init__(self, distribution: Distribution) -> None:
        slices = distribution.slices
        size = distribution.axis.variable.size
        self.distribution = distribution
        self.parents = distribution.factor.inner[:-1]
        self._width = count_of(self.parents)
        owner, value = slices.owner(), slices.index % size
        order = np.lexsort((slices.index, value, owner))
        owner, value = owner[order], value[order]
        parent, weight = slices.index[order] // size, slices.value[order]
        new = np.r_[True, (owner[1:] != owner[:-1]) | (value[1:] != value[:-1])][: len(owner)]
        first = np.flatnonzero(new)
        counts = np.bincount(owner[first], minlength=slices.count)
        self.start = starts(counts)
        self.value = value[first]
        self.part, kept = _same_parts(parent, weight, first, self._width)
        part_of_entry = np.repeat(self.part, np.diff(np.r_[first, len(owner)]))
        chosen = np.repeat(kept, np.diff(np.r_[first, len(owner)]))
        key = part_of_entry[chosen] * self._width + parent[chosen]
        sequence = np.argsort(key, kind="stable")
        self._key, self._weight = key[sequence], weight[chosen][sequence]

    def weights(self, part: IntArray, values: Callable[[Axis], IntArray]) -> FloatArray:
        """``[N]`` the probabilities in the parts ``part``."""
        key = part * self._width + linear(self.parents, values, len(part))
        if len(self._key) == 0:
            return np.zeros(len(part))
        place = np.minimum(np.searchsorted(self._key, key), len(self._key) - 1)
        return np.where(self._key[place] == key, self._weight[place], 0.0)


def _same_parts(
    parent: IntArray, weight: FloatArray, first: IntArray, width: int
) -> tuple[IntArray, np.typing.NDArray[np.bool_]]:
    """Number the parts by their contents; and which part is the first of its number."""
    if width == 1:
        _, kept, number = np.unique(weight[first], return_index=True, return_inverse=True)
        is_kept = np.zeros(len(first), dtype=np.bool_)
        is_kept[kept] = True
        return number.astype(np.int64), is_kept
    known: dict[tuple[bytes, bytes], int] = {}
    number = np.empty(len(first), dtype=np.int64)
    is_kept = np.zeros(len(first), dtype=np.bool_)
    for i, (begin, end) in enumerate(zip(first, np.r_[first[1:], len(parent)], strict=True)):
        key = (parent[begin:end].tobytes(), weight[begin:end].tobytes())
        new = len(known)
        number[i] = known.setdefault(key, new)
        is_kept[i] = number[i] == new
    return number, is_kept


def build_edges(path: object, line: int, variables: Variables, factors: Sequence[Factor]) -> Edges:
    """The edges that ``factors`` describe.

    Args:
        path: the file, for error messages.
        line: where the section begins.
        variables: the file's variables.
        factors: one for each state variable.

    Raises:
        FileError: if a row is not a distribution, or a limit is exceeded.
    """
    ordered = in_order(path, factors)
    distributions = [Distribution.of(f, normalised(path, f.table, f.describe)) for f in ordered]
    observed = [_Observed(d) for d in distributions if d.axis.variable.group == OBSERVED]
    hidden = [d for d in distributions if d.axis.variable.group == HIDDEN]
    states, actions = variables.observed.size, variables.actions.size
    frame = _successors(path, variables, observed)
    x, a = np.divmod(frame.origin, actions)
    count = len(frame.weight)
    x_next = _product(variables, OBSERVED, frame, count)
    columns = [frame.columns["part", i, True] for i in range(len(observed))]
    for d in hidden:
        columns.append(d.slices.at(linear(d.factor.outer, frame.value, count)))
    keys = np.column_stack(columns) if columns else np.zeros((count, 1), dtype=np.int64)
    different, edge_map = np.unique(keys, axis=0, return_inverse=True)
    transition = _maps(path, line, variables, observed, hidden, different)
    # What the factors together make impossible is no edge.
    mass = np.diff(transition.row_start).reshape(-1, transition.hidden).sum(axis=1)
    kept = np.flatnonzero(mass[edge_map.ravel()] > 0)
    kept = kept[np.lexsort((x_next[kept], a[kept], x[kept]))]
    used, number = np.unique(edge_map.ravel()[kept], return_inverse=True)
    x, a = x[kept], a[kept]
    return Edges(
        x=x,
        a=a,
        start=starts(np.bincount(x * actions + a, minlength=states * actions)),
        next=x_next[kept],
        map=number.astype(np.int64),
        transition=_only(transition, used),
    )


def _successors(path: object, variables: Variables, observed: Sequence[_Observed]) -> Frame:
    """All (x, a, x') that no factor alone excludes; column ``part`` i is the part of factor i."""
    states, actions = variables.observed.size, variables.actions.size
    xa = np.arange(states * actions)
    columns: dict[tuple[str, int, bool], IntArray] = {}
    for variable in variables.observed.variables:
        place = variable.place
        columns[OBSERVED, place, False] = variables.observed.component(place, xa // actions)
    for variable in variables.actions.variables:
        place = variable.place
        columns[ACTION, place, True] = variables.actions.component(place, xa % actions)
    frame = Frame(path, columns, np.ones(len(xa)))
    for i, factor in enumerate(observed):
        outer = factor.distribution.factor.outer
        slices: Slices = factor.distribution.slices
        slice_of = slices.at(linear(outer, frame.value, len(frame.weight)))
        check_growth(path, factor.distribution.factor.line, factor.start, slice_of)
        which, place = expanded(factor.start, slice_of)
        frame.take(which)
        frame.columns[factor.distribution.axis.key] = factor.value[place]
        frame.columns["part", i, True] = factor.part[place]
    return frame


def _maps(
    path: object,
    line: int,
    variables: Variables,
    observed: Sequence[_Observed],
    hidden: Sequence[Distribution],
    different: IntArray,
) -> SparseTransition:
    """One map for each row of ``different``, the parts and slices of all factors."""
    size = variables.hidden.size
    check_size(path, line, "maps and hidden states", (len(different), size), MAX_ENTRIES)
    step = max(1, CHUNK // size)
    blocks: list[tuple[IntArray, IntArray, FloatArray]] = []
    total = 0
    for first in range(0, len(different), step):
        chosen = different[first : first + step]
        frame = _map_frame(path, variables, observed, hidden, chosen)
        y_next = _product(variables, HIDDEN, frame, len(frame.weight))
        order = np.argsort(frame.origin * size + y_next, kind="stable")
        blocks.append((first * size + frame.origin[order], y_next[order], frame.weight[order]))
        total += len(order)
        check_size(path, line, "transitions with a probability above 0", (total,), MAX_ENTRIES)
    none: IntArray = np.zeros(0, dtype=np.int64)
    row = np.concatenate([none, *(block[0] for block in blocks)])
    counts = np.bincount(row, minlength=len(different) * size)
    return SparseTransition(
        hidden=size,
        row_start=starts(counts),
        column=np.concatenate([none, *(block[1] for block in blocks)]),
        value=np.concatenate([np.zeros(0), *(block[2] for block in blocks)]),
    )


def _map_frame(
    path: object,
    variables: Variables,
    observed: Sequence[_Observed],
    hidden: Sequence[Distribution],
    chosen: IntArray,
) -> Frame:
    size = variables.hidden.size
    y = np.tile(np.arange(size), len(chosen))
    frame = Frame(
        path,
        {
            (HIDDEN, v.place, False): variables.hidden.component(v.place, y)
            for v in variables.hidden.variables
        },
        np.ones(len(y)),
    )
    waiting = dict(enumerate(observed))
    for i, distribution in enumerate([None, *hidden]):
        if distribution is not None:
            slice_of = chosen[frame.origin // size, len(observed) + i - 1]
            frame.extend(distribution, slice_of)
        for place, factor in list(waiting.items()):
            if all(axis.key in frame.columns for axis in factor.parents):
                del waiting[place]
                weight = factor.weights(chosen[frame.origin // size, place], frame.value)
                frame.weight = frame.weight * weight
                if not weight.all():
                    frame.take(np.flatnonzero(weight))
    return frame


def _product(variables: Variables, group: str, frame: Frame, count: int) -> IntArray:
    """``[count]`` the combination of the current values of a group."""
    product = variables.product(group)
    if not product.variables:
        return np.zeros(count, dtype=np.int64)
    return combine(product, [frame.columns[group, v.place, True] for v in product.variables])


def _only(transition: SparseTransition, maps: IntArray) -> SparseTransition:
    if len(maps) == transition.count:
        return transition
    size = transition.hidden
    rows = (maps[:, None] * size + np.arange(size)).ravel()
    which, place = expanded(transition.row_start, rows)
    counts = np.bincount(which, minlength=len(rows))
    return SparseTransition(
        hidden=size,
        row_start=starts(counts),
        column=transition.column[place],
        value=transition.value[place],
    )


def check_rows(
    path: object, line: int, variables: Variables, edges: Edges, factors: Sequence[Factor]
) -> None:
    """Refuse transitions that the file does not give.

    Raises:
        FileError: naming x, a and y whose successors do not have a total probability of 1.
    """
    actions, size = variables.actions.size, variables.hidden.size
    sums = edges.transition.row_sums()
    step = max(1, CHUNK // size)
    for first in range(0, len(edges.start) - 1, step):
        start = edges.start[first : first + step + 1]
        part = edges.map[start[0] : start[-1]]
        uses = sparse.csr_array(
            (np.ones(len(part)), part, start - start[0]), shape=(len(start) - 1, len(sums))
        )
        totals = np.asarray(uses @ sums)
        wrong = np.abs(totals - 1) > TOTAL_TOLERANCE
        if not wrong.any():
            continue
        row, y = divmod(int(np.argmax(wrong)), size)
        x, a = divmod(first + row, actions)
        where = f"action {variables.actions.names[a]}, state {variables.observed.names[x]}"
        if size > 1:
            where += f" and {variables.hidden.names[y]}"
        raise FileError(
            path,
            _missing(variables, factors, x, a, y) or line,
            f"found successors of {where} with a total probability of {totals[row, y]:.9g}, "
            "expected 1",
        )


def _missing(variables: Variables, factors: Sequence[Factor], x: int, a: int, y: int) -> int | None:
    """The line of a factor that has no row for (x, a, y)."""
    index = {OBSERVED: x, ACTION: a, HIDDEN: y}
    for factor in factors:
        place: list[int] = []
        for axis in factor.axes[:-1]:
            if axis.current and axis.variable.group != ACTION:
                break
            product = variables.product(axis.variable.group)
            linear_index = np.array([index[axis.variable.group]])
            place.append(int(product.component(axis.variable.place, linear_index)[0]))
        else:
            if factor.table.line_of((*place, -1)) is None:
                return factor.line
    return None
