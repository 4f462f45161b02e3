"""The perceived robot mode against Eq. 2 written out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from coadapt.arrays import IntArray
from coadapt.human import perceived_robot_mode
from coadapt.human.history import NO_ACTION
from tests.momdp.strategies import random_rows


def steps_of(states: ArrayLike, actions: ArrayLike) -> list[tuple[IntArray, IntArray]]:
    """The steps of windows ``[..., k]``, oldest first."""
    at, did = (np.moveaxis(np.asarray(part), -1, 0) for part in (states, actions))
    return list(zip(at, did, strict=True))


@given(
    st.tuples(*(st.integers(1, 4) for _ in range(4))),
    st.integers(0, 3),
    st.sampled_from((0.0, 0.5, 0.8)),
    st.integers(0, 2**32),
)
def test_the_product_over_the_window_normalised(
    sizes: tuple[int, int, int, int], windows: int, zeros: float, seed: int
) -> None:
    modes, states, actions, k = sizes
    rng = np.random.default_rng(seed)
    policies = random_rows(rng, (modes, states, actions), zeros)
    at, did = (
        rng.integers(states, size=(windows, 2, k)),
        rng.integers(actions, size=(windows, 2, k)),
    )
    found = perceived_robot_mode(policies, steps_of(at, did))
    assert found.shape == (windows, 2, modes)
    for i, j in np.ndindex(windows, 2):
        likelihood = np.ones(modes)
        for m in range(modes):
            for t in range(k):
                likelihood[m] *= policies[m, at[i, j, t], did[i, j, t]]
        # A window that no mode explains says nothing (formalism, robot mode inference).
        wanted = likelihood / likelihood.sum() if likelihood.any() else np.full(modes, 1 / modes)
        np.testing.assert_allclose(found[i, j], wanted, atol=1e-14)


def test_by_hand() -> None:
    # Two modes; in state 0 they take action 0 with 0.9 and 0.3, in state 1 with 0.5 and 0.
    policies = np.array([[[0.9, 0.1], [0.5, 0.5]], [[0.3, 0.7], [0.0, 1.0]]])
    once = perceived_robot_mode(policies, steps_of([0], [0]))
    np.testing.assert_allclose(once, [0.75, 0.25], atol=1e-15)  # 9 : 3
    # Then action 1 in state 1, which mode 1 always takes: 0.9 * 0.5 : 0.3 * 1.
    twice = perceived_robot_mode(policies, steps_of([0, 1], [0, 1]))
    np.testing.assert_allclose(twice, [0.6, 0.4], atol=1e-15)
    # Action 0 there is impossible in mode 1, whatever came before.
    sure = perceived_robot_mode(policies, steps_of([0, 1], [1, 0]))
    np.testing.assert_array_equal(sure, [1.0, 0.0])


def test_a_step_that_was_not_taken_says_nothing() -> None:
    policies = np.array([[[0.9, 0.1], [0.5, 0.5]], [[0.3, 0.7], [0.0, 1.0]]])
    found = perceived_robot_mode(policies, steps_of([[0, 1], [0, 1]], [[NO_ACTION, 1], [0, 1]]))
    np.testing.assert_allclose(found, [[1 / 3, 2 / 3], [0.6, 0.4]], atol=1e-15)  # 0.5 : 1


def test_long_windows_do_not_underflow() -> None:
    # 3000 steps of probability 1e-3 and 1.01e-3: far below 5e-324, and 1 : 1.01^3000.
    policies = np.array([[[1e-3, 0.999]], [[1.01e-3, 1 - 1.01e-3]]])
    steps = steps_of(np.zeros(3000, dtype=int), np.zeros(3000, dtype=int))
    found = perceived_robot_mode(policies, steps)
    assert found[0] == pytest.approx(1.01**-3000, rel=1e-9)
    assert found.sum() == pytest.approx(1.0, abs=1e-15)


def test_one_mode_may_be_out_of_sight_and_come_back() -> None:
    # 200 steps at 1e-3 : 0.999, then 200 steps the other way round: even again.
    policies = np.array([[[1e-3, 0.999]], [[0.999, 1e-3]]])
    steps = steps_of(np.zeros(400, dtype=int), [0] * 200 + [1] * 200)
    np.testing.assert_allclose(perceived_robot_mode(policies, steps), 0.5, atol=1e-12)
    # And the only one that explains what follows is certain, however unlikely it was.
    policies = np.array([[[1e-3, 0.999]], [[1.0, 0.0]]])
    np.testing.assert_array_equal(perceived_robot_mode(policies, steps), [1.0, 0.0])


def test_tiny_probabilities_are_compared_as_they_are() -> None:
    # As of a modal policy with a large step cost: 1e-300 : 3e-300 is 1 : 3.
    policies = np.array([[[1e-300, 1.0]], [[3e-300, 1.0]]])
    found = perceived_robot_mode(policies, steps_of([0, 0], [0, 0]))
    np.testing.assert_allclose(found, [0.1, 0.9], atol=1e-15)
