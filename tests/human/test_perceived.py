"""The perceived robot mode against Eq. 2 written out."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from coadapt.human import perceived_robot_mode
from tests.momdp.strategies import random_rows


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
    found = perceived_robot_mode(policies, at, did)
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
    once = perceived_robot_mode(policies, np.array([0]), np.array([0]))
    np.testing.assert_allclose(once, [0.75, 0.25], atol=1e-15)  # 9 : 3
    # Then action 1 in state 1, which mode 1 always takes: 0.9 * 0.5 : 0.3 * 1.
    twice = perceived_robot_mode(policies, np.array([0, 1]), np.array([0, 1]))
    np.testing.assert_allclose(twice, [0.6, 0.4], atol=1e-15)
    # Action 0 there is impossible in mode 1, whatever came before.
    sure = perceived_robot_mode(policies, np.array([0, 1]), np.array([1, 0]))
    np.testing.assert_array_equal(sure, [1.0, 0.0])
