"""The kernels that apply hidden transitions, against the matrices they stand for."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from coadapt.momdp import MOMDP
from coadapt.momdp.sarsop.problem import as_arrays, pull, push, row_of, staying
from tests.momdp.problems import dense_map
from tests.momdp.strategies import jump_momdps, momdps


@given(momdps() | jump_momdps(mixing=True), st.integers(0, 2**32))
@settings(max_examples=80)
def test_kernels_apply_the_maps(problem: MOMDP, seed: int) -> None:
    rng = np.random.default_rng(seed)
    arrays, hidden = as_arrays(problem), problem.shape[1]
    for k in range(problem.transition.count):
        dense = dense_map(problem.transition, k)
        # Mass on some of the hidden states.
        index = np.flatnonzero(rng.random(hidden) < 0.7)
        mass = rng.random(len(index))
        out = np.full(hidden, np.nan)
        push(arrays, k, index, mass, out)
        np.testing.assert_allclose(out, mass @ dense[index], atol=1e-14)
        # Values are added to what is there, scaled.
        values, before = rng.normal(size=hidden), rng.normal(size=hidden)
        out = before.copy()
        pull(arrays, k, 0.7, values, out)
        np.testing.assert_allclose(out, before + 0.7 * dense @ values, atol=1e-14)
        staying(arrays, k, out)
        np.testing.assert_allclose(out, np.diag(dense), atol=1e-14)
        for y in range(hidden):
            places, chances = np.zeros(hidden, dtype=np.int64), np.zeros(hidden)
            size = row_of(arrays, k, y, places, chances)
            row = np.zeros(hidden)
            row[places[:size]] = chances[:size]
            np.testing.assert_allclose(row, dense[y], atol=1e-14)
            assert len(set(places[:size].tolist())) == size
