"""The filter over adaptability and mode against an enumeration of everything hidden."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.human import Adaptability, mode_transition
from coadapt.human import filter as human_filter
from tests.momdp.strategies import random_rows


def eq_4(alpha: float, m: int, m_r: int, m_next: int) -> float:
    """``P(m' | alpha, m, m_r)``: switch to m_r with probability alpha, else keep m."""
    return alpha * (m_next == m_r) + (1 - alpha) * (m_next == m)


@given(
    st.integers(1, 2),
    st.integers(1, 3),
    st.integers(1, 3),
    st.booleans(),
    st.sampled_from((0.0, 0.5)),
    st.integers(0, 2**32),
)
def test_the_filter_sums_over_all_hidden_trajectories(
    levels: int, modes: int, steps: int, fixed: bool, zeros: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    alpha = np.sort(rng.random(levels))
    alpha[0] = 0.0 if zeros else alpha[0]
    prior = random_rows(rng, (levels * modes,), 0.0).reshape(levels, modes)
    likelihood = rng.random((steps, modes)) * (rng.random((steps, modes)) >= zeros)
    perceived = random_rows(rng, (steps, modes), zeros)
    t_alpha = np.eye(levels) if fixed else random_rows(rng, (levels, levels), 0.3)

    # The joint probability of the inputs and of one course (alpha_0, m_0), ..., (alpha_n, m_n),
    # summed by its last pair. Eq. 9, unrolled.
    corrected, forecast = np.zeros((levels, modes)), np.zeros((levels, modes))
    pairs = list(product(range(levels), range(modes)))
    for course in product(pairs, repeat=steps + 1):
        weight = prior[course[0]]
        for t in range(steps):
            (i, m), (i_next, m_next) = course[t], course[t + 1]
            weight *= likelihood[t, m]
            if t == steps - 1 and (i_next, m_next) == (0, 0):
                corrected[i, m] += weight  # once for each course up to here
            weight *= t_alpha[i, i_next] * sum(
                eq_4(alpha[i], m, m_r, m_next) * perceived[t, m_r] for m_r in range(modes)
            )
        forecast[course[-1]] += weight

    belief = before = prior
    for t in range(steps):
        if not (belief * likelihood[t]).any():
            return  # nothing explains the input; see below
        before = human_filter.correct(belief, likelihood[t])
        belief = human_filter.predict(before, alpha, perceived[t], None if fixed else t_alpha)
    np.testing.assert_allclose(before, corrected / corrected.sum(), atol=1e-12)
    np.testing.assert_allclose(belief, forecast / forecast.sum(), atol=1e-12)


@given(
    st.integers(1, 3),
    st.integers(1, 4),
    st.booleans(),
    st.booleans(),
    st.sampled_from((0.0, 0.5)),
    st.integers(0, 2**32),
)
def test_a_forecast_is_a_product_with_the_matrix(
    levels: int, modes: int, by_goal: bool, fixed: bool, zeros: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    shape = (levels, modes) if by_goal else (levels,)
    alpha = np.clip(rng.uniform(-0.3, 1.3, size=shape), 0, 1)
    beliefs = random_rows(rng, (2, levels * modes), zeros).reshape(2, levels, modes)
    perceived = random_rows(rng, (2, modes), zeros)
    t_alpha = np.eye(levels) if fixed else random_rows(rng, (levels, levels), zeros)
    expected = np.zeros_like(beliefs)
    for n, i, j in product(range(2), range(levels), range(levels)):
        moved = beliefs[n, i] @ mode_transition(alpha[i], perceived[n])
        expected[n, j] += t_alpha[i, j] * moved
    found = human_filter.predict(beliefs, alpha, perceived, None if fixed else t_alpha)
    np.testing.assert_allclose(found, expected, atol=1e-15)
    assert np.all(found >= 0)
    np.testing.assert_allclose(found.sum(axis=(1, 2)), 1.0, atol=1e-14)
    # One number for all goals or the same number for each.
    if not by_goal:
        each = np.repeat(alpha[:, None], modes, axis=1)
        same = human_filter.predict(beliefs, each, perceived, None if fixed else t_alpha)
        np.testing.assert_allclose(same, found, atol=1e-15)


def test_adaptability_differs_by_goal() -> None:
    # By hand: alpha 0.25 towards the right goal and 1 towards the left one, mode left for certain,
    # the robot is seen in mode right with 0.8: the mode becomes right with 0.25 * 0.8.
    alpha = Adaptability.over([[1.0, 0.25]])
    belief = human_filter.predict(
        np.array([[1.0, 0.0]]), alpha.rates(2), np.array([0.2, 0.8]), None
    )
    np.testing.assert_allclose(belief, [[0.8, 0.2]], atol=1e-15)


@pytest.mark.parametrize("belief", [[[0.5, 0.5]], [[1.0, 0.0]]])
def test_an_inexplicable_input_changes_nothing(belief: list[list[float]]) -> None:
    given_belief = np.array(belief)
    after = human_filter.correct(given_belief, np.array([0.0, 0.0]))
    np.testing.assert_array_equal(after, belief)
    after[0, 0] = 7.0
    np.testing.assert_array_equal(given_belief, belief)  # a copy
    # So it is when only modes explain it that were ruled out.
    certain = np.array([[1.0, 0.0]])
    np.testing.assert_array_equal(human_filter.correct(certain, np.array([0.0, 0.9])), certain)


def test_insisting_makes_adaptability_unlikely() -> None:
    # Sec. 5.4: the robot disagrees, the human insists, and lower values of alpha gain. By hand:
    # prior 1/2 each for alpha 0 and 1, mode L for certain; the robot is seen in mode R; then only
    # alpha = 0 keeps L, so an input of L (0.9 in L, 0.2 in R) gives odds 0.9 : 0.2.
    belief = np.array([[0.5, 0.0], [0.5, 0.0]])
    forecast = human_filter.predict(belief, np.array([0.0, 1.0]), np.array([0.0, 1.0]), None)
    np.testing.assert_array_equal(forecast, [[0.5, 0.0], [0.0, 0.5]])
    after = human_filter.correct(forecast, np.array([0.9, 0.2]))
    np.testing.assert_allclose(after.sum(axis=1), [9 / 11, 2 / 11], atol=1e-15)
