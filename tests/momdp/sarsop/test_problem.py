"""The kernels that apply hidden transitions, against the matrices they stand for."""

from __future__ import annotations

import numba
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from coadapt.arrays import FloatArray, Int32Array, IntArray
from coadapt.momdp import MOMDP
from coadapt.momdp.sarsop.problem import Problem, as_arrays, pull, push, row_of, staying
from tests.momdp.problems import dense_map
from tests.momdp.strategies import jump_momdps, momdps


@numba.njit
def call_all(  # noqa: PLR0917 (arrays in, as kernels have it)
    p: Problem,
    k: int,
    index: Int32Array,
    mass: FloatArray,
    values: FloatArray,
    outs: FloatArray,
    places: IntArray,
    chances: FloatArray,
    sizes: IntArray,
) -> None:
    """What Python cannot call itself: one row of ``outs`` for each of `push`, `pull`, `staying`;
    one of ``places`` and ``chances`` for each `row_of`."""
    spare = np.empty(values.shape[0])
    push(p, k, index, mass, outs[0], spare)
    pull(p, k, 0.7, values, outs[1], spare)
    staying(p, k, outs[2])
    for y in range(values.shape[0]):
        sizes[y] = row_of(p, k, y, places[y], chances[y])


@given(momdps() | jump_momdps(mixing=True), st.integers(0, 2**32))
@settings(max_examples=80)
def test_kernels_apply_the_maps(problem: MOMDP, seed: int) -> None:
    rng = np.random.default_rng(seed)
    arrays, hidden = as_arrays(problem), problem.shape[1]
    for k in range(problem.transition.count):
        dense = dense_map(problem.transition, k)
        # Mass on some of the hidden states.
        index = np.flatnonzero(rng.random(hidden) < 0.7).astype(np.int32)
        mass = rng.random(len(index))
        # Values are added to what is there, scaled.
        values, before = rng.normal(size=hidden), rng.normal(size=hidden)
        outs = np.full((3, hidden), np.nan)
        outs[1] = before
        places = np.zeros((hidden, hidden), dtype=np.int64)
        chances = np.zeros((hidden, hidden))
        sizes = np.zeros(hidden, dtype=np.int64)
        call_all(arrays, k, index, mass, values, outs, places, chances, sizes)
        np.testing.assert_allclose(outs[0], mass @ dense[index], atol=1e-14)
        np.testing.assert_allclose(outs[1], before + 0.7 * dense @ values, atol=1e-14)
        np.testing.assert_allclose(outs[2], np.diag(dense), atol=1e-14)
        for y in range(hidden):
            found = places[y, : sizes[y]]
            row = np.zeros(hidden)
            row[found] = chances[y, : sizes[y]]
            np.testing.assert_allclose(row, dense[y], atol=1e-14)
            assert len(set(found.tolist())) == sizes[y]
