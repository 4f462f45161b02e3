"""The rewards of a `.pomdpx` file: ``R(x, a, y)``, the sum of its tables.

A table that depends on the state after the step is replaced by its expectation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.errors import FileError
from coadapt.momdp.files.limits import MAX_ENTRIES
from coadapt.momdp.files.pomdpx_entries import Factor
from coadapt.momdp.files.pomdpx_join import count_of, linear
from coadapt.momdp.files.pomdpx_transition import Edges
from coadapt.momdp.files.pomdpx_variables import ACTION, Axis, Variables
from coadapt.momdp.files.slices import Slices

CHUNK = 1_000_000
"""Entries of the reward that are added to together."""


def build_reward(
    path: object, variables: Variables, edges: Edges, factors: Sequence[Factor]
) -> FloatArray:
    """``[X, A, Y]`` the expected immediate rewards.

    Raises:
        FileError: if a sum is too large for a number.
    """
    shape = (variables.observed.size, variables.actions.size, variables.hidden.size)
    reward = np.zeros(shape)
    with np.errstate(over="ignore", invalid="ignore"):
        for factor in factors:
            slices = factor.table.slices()
            if any(a.current and a.variable.group != ACTION for a in factor.axes):
                _add_expected(path, reward, variables, edges, factor, slices)
            else:
                _add(reward, variables, factor, slices)
    if not np.isfinite(reward).all():
        line = factors[0].line
        raise FileError(path, line, "found rewards with an infinite sum, expected smaller ones")
    return reward


def _add(reward: FloatArray, variables: Variables, factor: Factor, slices: Slices) -> None:
    """Add a table of x, a, y."""
    states, actions, size = reward.shape
    pair: IntArray = np.arange(states * actions, dtype=np.int64)
    x, a = pair // actions, pair % actions
    number = slices.at(linear(factor.outer, _outer(variables, x, a, x), len(x)))
    different, number = np.unique(number, return_inverse=True)
    y: IntArray = np.arange(size, dtype=np.int64)
    parents = linear(factor.inner, _inner(variables, y, y), size)
    rows = np.empty((len(different), size))
    for i, s in enumerate(int(i) for i in different):
        rows[i] = _dense(factor, slices, s)[parents]
    flat = reward.reshape(-1, size)
    step = max(1, CHUNK // size)
    for first in range(0, len(flat), step):
        flat[first : first + step] += rows[number[first : first + step]]


def _add_expected(
    path: object,
    reward: FloatArray,
    variables: Variables,
    edges: Edges,
    factor: Factor,
    slices: Slices,
) -> None:
    """Add the expectation of a table of x, a, y, x', y'."""
    size = variables.hidden.size
    transition = edges.transition
    places = _outer(variables, edges.x, edges.a, edges.next)
    number = slices.at(linear(factor.outer, places, len(edges.x)))
    pairs, own = np.unique(edges.map * slices.count + number, return_inverse=True)
    length = transition.row_start[size::size] - transition.row_start[:-size:size]
    work = int(length[pairs // slices.count].sum()) + len(pairs) * count_of(factor.inner)
    if work > 2 * MAX_ENTRIES:
        raise FileError(
            path,
            factor.line,
            f"found rewards of {work:,} cases, expected at most {2 * MAX_ENTRIES:,}",
        )
    order = np.argsort(own, kind="stable")
    ends = np.searchsorted(own[order], np.arange(len(pairs) + 1))
    for i in range(len(pairs)):
        k, s = divmod(int(pairs[i]), slices.count)
        first, last = transition.row_start[k * size], transition.row_start[(k + 1) * size]
        y: IntArray = np.repeat(
            np.arange(size), np.diff(transition.row_start[k * size : (k + 1) * size + 1])
        )
        y_next: IntArray = transition.column[first:last]
        gain = _dense(factor, slices, s)[linear(factor.inner, _inner(variables, y, y_next), len(y))]
        expected = np.bincount(y, weights=gain * transition.value[first:last], minlength=size)
        for edge in order[ends[i] : ends[i + 1]]:
            reward[edges.x[edge], edges.a[edge]] += expected


def _dense(factor: Factor, slices: Slices, number: int) -> FloatArray:
    dense = np.zeros(count_of(factor.inner))
    place = slice(slices.start[number], slices.start[number + 1])
    dense[slices.index[place]] = slices.value[place]
    return dense


def _outer(
    variables: Variables, x: IntArray, a: IntArray, x_next: IntArray
) -> Callable[[Axis], IntArray]:
    """The values of action and observed variables."""

    def value(axis: Axis) -> IntArray:
        if axis.variable.group == ACTION:
            return variables.actions.component(axis.variable.place, a)
        return variables.observed.component(axis.variable.place, x_next if axis.current else x)

    return value


def _inner(variables: Variables, y: IntArray, y_next: IntArray) -> Callable[[Axis], IntArray]:
    """The values of hidden variables."""

    def value(axis: Axis) -> IntArray:
        return variables.hidden.component(axis.variable.place, y_next if axis.current else y)

    return value
