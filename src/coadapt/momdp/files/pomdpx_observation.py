"""The observations of a `.pomdpx` file: ``O(o | a, x', y')``, the product of its factors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import sparse

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.errors import FileError
from coadapt.momdp.files.limits import MAX_OBSERVATIONS, check_size
from coadapt.momdp.files.pomdpx_entries import Factor
from coadapt.momdp.files.pomdpx_join import Distribution, count_of, linear
from coadapt.momdp.files.pomdpx_transition import Edges
from coadapt.momdp.files.pomdpx_variables import ACTION, Axis, Variables
from coadapt.momdp.files.rows import normalised


def build_observation(
    path: object, variables: Variables, edges: Edges, factors: Sequence[Factor]
) -> tuple[FloatArray, IntArray]:
    """The stack of different observation matrices ``[K, Y, O]`` and which holds, ``[A, X]``.

    What the file leaves out and no transition reaches is uniform.

    Raises:
        FileError: if the file leaves out what a transition reaches, or the stack is too large.
    """
    states, actions = variables.observed.size, variables.actions.size
    size, seen = variables.hidden.size, variables.observations.size
    if not factors:
        return np.ones((1, size, 1)), np.zeros((actions, states), dtype=np.int64)
    a, x = np.divmod(np.arange(actions * states), states)

    def observed(axis: Axis) -> IntArray:
        if axis.variable.group == ACTION:
            return variables.actions.component(axis.variable.place, a)
        return variables.observed.component(axis.variable.place, x)

    distributions = [Distribution.of(f, normalised(path, f.table, f.describe)) for f in factors]
    columns = [d.slices.at(linear(d.factor.outer, observed, len(a))) for d in distributions]
    different, index = np.unique(np.column_stack(columns), axis=0, return_inverse=True)
    line = factors[0].line
    check_size(path, line, "observation matrices", (len(different), size, seen), MAX_OBSERVATIONS)
    stack = np.empty((len(different), size, seen))
    missing = np.zeros((len(different), size), dtype=np.bool_)
    for k, slices in enumerate(different.tolist()):
        joint = np.ones((size, 1))
        for d, number in zip(distributions, slices, strict=True):
            rows = _matrix(variables, d, number)
            empty = ~rows.any(axis=1)
            missing[k] |= empty
            rows[empty] = 1.0 / rows.shape[1]
            joint = (joint[:, :, None] * rows[:, None, :]).reshape(size, -1)
        stack[k] = joint
    index = index.ravel().astype(np.int64).reshape(actions, states)
    if missing.any():
        _check_reached(path, variables, edges, factors, missing, index)
    return stack, index


def _matrix(variables: Variables, distribution: Distribution, number: int) -> FloatArray:
    """``[Y, o]`` the rows of slice ``number`` for every hidden state."""
    slices = distribution.slices
    parents = distribution.factor.inner[:-1]
    width = distribution.axis.variable.size
    place = slice(slices.start[number], slices.start[number + 1])
    dense = np.zeros(count_of(parents) * width)
    dense[slices.index[place]] = slices.value[place]
    y = np.arange(variables.hidden.size)

    def hidden(axis: Axis) -> IntArray:
        return variables.hidden.component(axis.variable.place, y)

    return dense.reshape(-1, width)[linear(parents, hidden, len(y))]


def _check_reached(
    path: object,
    variables: Variables,
    edges: Edges,
    factors: Sequence[Factor],
    missing: BoolArray,
    index: IntArray,
) -> None:
    maps, size = edges.transition.count, variables.hidden.size
    arrives = np.zeros((maps, size))
    arrives[edges.source() // size, edges.transition.column] = 1.0
    used = index[edges.a, edges.next]
    meets = sparse.csr_array((np.ones(len(used)), (used, edges.map)), shape=(len(missing), maps))
    wrong = missing & (np.asarray(meets @ arrives) > 0)
    if not wrong.any():
        return
    k, y = divmod(int(np.argmax(wrong)), size)
    edge = int(np.argmax((used == k) & (arrives[edges.map, y] > 0)))
    action = variables.actions.names[int(edges.a[edge])]
    state = variables.observed.names[int(edges.next[edge])]
    raise FileError(
        path,
        factors[0].line,
        f"found no observation after action {action} in state {state} and "
        f"{variables.hidden.names[y]}, expected probabilities that sum to 1",
    )
