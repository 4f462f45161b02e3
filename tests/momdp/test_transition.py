"""Both ways of keeping hidden transitions do what the matrices they stand for do."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.momdp import JumpTransition, SparseTransition
from tests.momdp.problems import dense_map
from tests.momdp.strategies import random_rows

SEEDS = st.integers(0, 2**32)


@st.composite
def jump_transitions(draw: st.DrawFn) -> JumpTransition:
    """Jumps of any kind: certain, impossible, to one value, with and without mixing."""
    blocks, values, maps = (draw(st.integers(1, 3)) for _ in range(3))
    rng = np.random.default_rng(draw(SEEDS))
    return JumpTransition(
        rate=np.clip(rng.uniform(-0.3, 1.3, size=(blocks, values)), 0.0, 1.0),
        target=random_rows(rng, (maps, values), 0.4),
        mixing=random_rows(rng, (blocks, blocks), 0.4) if draw(st.booleans()) else None,
    )


@given(st.integers(1, 4), st.integers(0, 3), st.floats(0, 1), SEEDS)
def test_sparse_maps_are_the_matrices_they_were_made_from(
    hidden: int, count: int, zeros: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    maps = rng.random((count, hidden, hidden)) * (rng.random((count, hidden, hidden)) >= zeros)
    transition = SparseTransition.from_dense(maps)
    mass = rng.random(hidden)
    assert (transition.count, transition.hidden) == (count, hidden)
    assert len(transition.value) == np.count_nonzero(maps)
    assert transition.row_start.dtype == transition.column.dtype == np.int64
    np.testing.assert_allclose(transition.row_sums(), maps.sum(axis=2), atol=1e-15)
    for k in range(count):
        np.testing.assert_array_equal(transition.matrix(k), maps[k])
        np.testing.assert_array_equal(dense_map(transition, k), maps[k])
        np.testing.assert_allclose(transition.forward(k, mass), mass @ maps[k], atol=1e-15)


def test_sparse_matrix_adds_repeated_entries() -> None:
    # Two entries for the same place stand for their sum, in all three readings.
    transition = SparseTransition(
        hidden=2,
        row_start=np.array([0, 2, 3]),
        column=np.array([1, 1, 0]),
        value=np.array([0.25, 0.5, 1.0]),
    )
    np.testing.assert_array_equal(transition.matrix(0), [[0, 0.75], [1, 0]])
    np.testing.assert_array_equal(transition.forward(0, np.array([1.0, 0.0])), [0, 0.75])
    np.testing.assert_array_equal(transition.row_sums(), [[0.75, 1]])


@given(jump_transitions(), SEEDS)
def test_jumps_are_the_maps_of_their_definition(transition: JumpTransition, seed: int) -> None:
    mass = np.random.default_rng(seed).random(transition.hidden)
    assert transition.hidden == transition.rate.size
    assert transition.row_sums().shape == (transition.count, transition.hidden)
    for k in range(transition.count):
        dense = dense_map(transition, k)
        np.testing.assert_allclose(transition.matrix(k), dense, atol=1e-15)
        np.testing.assert_allclose(transition.forward(k, mass), mass @ dense, atol=1e-14)
        np.testing.assert_allclose(transition.row_sums()[k], dense.sum(axis=1), atol=1e-14)
        np.testing.assert_allclose(dense.sum(axis=1), 1.0, atol=1e-14)


def test_a_jump_by_hand() -> None:
    # Block 0 never jumps, block 1 jumps with certainty to its first value with chance 0.25.
    transition = JumpTransition(
        rate=np.array([[0.0, 0.0], [1.0, 1.0]]), target=np.array([[0.25, 0.75]])
    )
    moved = transition.forward(0, np.array([0.1, 0.2, 0.3, 0.4]))
    np.testing.assert_allclose(moved, [0.1, 0.2, 0.7 * 0.25, 0.7 * 0.75], atol=1e-16)


def test_row_sums_show_a_mixing_that_loses_mass() -> None:
    transition = JumpTransition(
        rate=np.ones((2, 2)),
        target=np.array([[0.5, 0.5]]),
        mixing=np.array([[0.5, 0.25], [0.0, 1.0]]),
    )
    np.testing.assert_array_equal(transition.row_sums(), [[0.75, 0.75, 1.0, 1.0]])


@pytest.mark.parametrize("mass", [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
def test_mixing_comes_after_the_jump(mass: list[float]) -> None:
    # Blocks swap. A mass that starts in a block jumps by that block's rate, not the other's.
    transition = JumpTransition(
        rate=np.array([[0.0, 0.0], [1.0, 1.0]]),
        target=np.array([[1.0, 0.0]]),
        mixing=np.array([[0.0, 1.0], [1.0, 0.0]]),
    )
    expected = [0.0, 0.0, 1.0, 0.0] if mass[0] else [1.0, 0.0, 0.0, 0.0]
    np.testing.assert_array_equal(transition.forward(0, np.array(mass)), expected)


@given(jump_transitions(), SEEDS)
def test_scaled_jumps_are_parts_of_their_matrices(jumps: JumpTransition, seed: int) -> None:
    rng = np.random.default_rng(seed)
    which = rng.integers(jumps.count, size=4)
    scale = rng.random(4)
    parts = jumps.scaled(which, scale)
    assert (parts.count, parts.hidden) == (4, jumps.hidden)
    for k in range(4):
        expected = scale[k] * dense_map(jumps, int(which[k]))
        np.testing.assert_allclose(parts.matrix(k), expected, atol=1e-14)


def test_certain_jumps_have_no_negative_parts() -> None:
    # In floating-point numbers this sum is above 1.
    target = np.array([[0.2, 0.4, 0.3, 0.1, 0.0]])
    assert target.sum() > 1
    parts = JumpTransition(rate=np.ones((1, 5)), target=target).scaled(np.array([0]), np.ones(1))
    assert parts.value.min() > 0
