"""Adaptability and the change of mode it brings."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import beta

from coadapt.human import Adaptability, mode_transition
from tests.momdp.strategies import random_rows

ALPHAS = st.sampled_from((0.0, 0.25, 1.0)) | st.floats(0, 1)


@given(ALPHAS, st.integers(1, 4), st.sampled_from((0.0, 0.6)), st.integers(0, 2**32))
def test_the_transition_is_that_of_the_paper(
    alpha: float, modes: int, zeros: float, seed: int
) -> None:
    perceived = random_rows(np.random.default_rng(seed), (modes,), zeros)
    found = mode_transition(alpha, perceived)
    expected = np.zeros((modes, modes))
    for m in range(modes):
        for m_next in range(modes):
            for m_r in range(modes):
                # Eq. 4, its cases in order; where m_r = m they coincide, and the person stays.
                if m_r == m:
                    chance = 1.0 if m_next == m else 0.0
                elif m_next == m_r:
                    chance = alpha
                elif m_next == m:
                    chance = 1 - alpha
                else:
                    chance = 0.0
                expected[m, m_next] += chance * perceived[m_r]  # Eq. 3
    np.testing.assert_allclose(found, expected, atol=1e-15)
    np.testing.assert_allclose(found.sum(axis=1), 1.0, atol=1e-14)
    assert np.all(found >= 0)


@given(ALPHAS, st.integers(1, 4), st.integers(0, 3))
def test_agreement_keeps_the_mode(alpha: float, modes: int, mode: int) -> None:
    mode %= modes
    certain = np.eye(modes)[mode]
    np.testing.assert_allclose(mode_transition(alpha, certain)[mode], certain, atol=1e-15)


def test_the_ends_of_the_scale() -> None:
    perceived = np.array([0.2, 0.8])
    # Sec. 2.1: alpha = 0 insists, alpha = 1 switches with certainty.
    np.testing.assert_array_equal(mode_transition(0.0, perceived), np.eye(2))
    np.testing.assert_array_equal(mode_transition(1.0, perceived), [perceived, perceived])


def test_defaults_are_uniform_and_fixed() -> None:
    adaptability = Adaptability.over([0, 0.5, 1])
    np.testing.assert_array_equal(adaptability.values, [0, 0.5, 1])
    np.testing.assert_allclose(adaptability.prior, 1 / 3)
    np.testing.assert_array_equal(adaptability.transition, np.eye(3))
    assert adaptability.is_fixed


def test_prior_and_transition_are_kept() -> None:
    moves = np.array([[0.5, 0.5], [0.0, 1.0]])
    adaptability = Adaptability.over([0, 1], prior=[0.25, 0.75], transition=moves)
    np.testing.assert_array_equal(adaptability.prior, [0.25, 0.75])
    np.testing.assert_array_equal(adaptability.transition, moves)
    assert not adaptability.is_fixed


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (dict(values=[]), "at least one"),
        (dict(values=[[]]), "at least one"),
        (dict(values=[[[0.5]]]), "at least one"),
        (dict(values=[[0.5, 0.2], [0.5, 0.2]]), "differ"),
        (dict(values=[[0.5, 1.2], [0.5, 0.2]]), "lie in"),
        (dict(values=[-0.1, 0.5]), "lie in"),
        (dict(values=[0.5, 1.1]), "lie in"),
        (dict(values=[0.5, float("nan")]), "lie in"),
        (dict(values=[0.5, 0.5]), "increase"),
        (dict(values=[0.5, 0.25]), "increase"),
        (dict(values=[0, 1], prior=[1.0]), "prior has shape"),
        (dict(values=[0, 1], prior=[0.5, 0.6]), "prior must be non-negative and sum to 1"),
        (dict(values=[0, 1], prior=[1.5, -0.5]), "prior must be"),
        (dict(values=[0, 1], prior=[float("nan"), 1.0]), "prior must be"),
        (dict(values=[0, 1], transition=np.eye(3)), "transition has shape"),
        (dict(values=[0, 1], transition=np.full((2, 2), 0.4)), "transition must be"),
        (dict(values=[0, 1], transition=np.array([[2.0, -1.0], [0.0, 1.0]])), "transition must be"),
    ],
)
def test_bad_values_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Adaptability.over(**arguments)


BY_GOAL = [[0.0, 0.5], [0.0, 1.0], [0.25, 1.0]]


@given(st.integers(1, 4), st.sampled_from((0.0, 0.6)), st.integers(0, 2**32))
def test_the_transition_by_goal_is_that_of_the_paper(modes: int, zeros: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    perceived = random_rows(rng, (modes,), zeros)
    towards = np.clip(rng.uniform(-0.3, 1.3, modes), 0, 1)
    found = mode_transition(towards, perceived)
    for m in range(modes):
        for m_next in range(modes):
            # Eq. 3-4 with the adaptability towards the mode perceived.
            expected = sum(
                perceived[m_r]
                * (towards[m_r] * (m_next == m_r) + (1 - towards[m_r]) * (m_next == m))
                for m_r in range(modes)
            )
            assert found[m, m_next] == pytest.approx(expected, abs=1e-15)
    np.testing.assert_allclose(found.sum(axis=1), 1.0, atol=1e-14)
    np.testing.assert_array_equal(
        mode_transition(np.full(modes, towards[0]), perceived),
        mode_transition(float(towards[0]), perceived),
    )


def test_names_and_rates() -> None:
    same, by_goal = Adaptability.over([0, 1 / 3, 1]), Adaptability.over(BY_GOAL)
    assert same.names == ("alpha=0", "alpha=0.3333333333333333", "alpha=1")
    assert by_goal.names == ("alpha=0/0.5", "alpha=0/1", "alpha=0.25/1")
    assert (same.is_by_goal, by_goal.is_by_goal) == (False, True)
    np.testing.assert_array_equal(same.rates(2), [[0, 0], [1 / 3, 1 / 3], [1, 1]])
    np.testing.assert_array_equal(by_goal.rates(2), BY_GOAL)
    np.testing.assert_array_equal(same.levels, same.values)
    np.testing.assert_array_equal(by_goal.levels, [0.25, 0.5, 0.625])
    with pytest.raises(ValueError, match="values for 2 goals, expected 3"):
        by_goal.rates(3)


@pytest.mark.parametrize(("a", "b"), [(2.0, 5.0), (0.5, 0.5), (1.0, 1.0)])
@pytest.mark.parametrize("points", [1, 4, 10])
def test_a_density_gives_every_cell_its_mass(a: float, b: float, points: int) -> None:
    # The beta distribution's own distribution function, from scipy.
    cells = np.diff(beta.cdf(np.linspace(0, 1, points + 1), a, b))
    found = Adaptability.from_density(lambda x: 7 * x ** (a - 1) * (1 - x) ** (b - 1), points)
    np.testing.assert_allclose(found.prior, cells, rtol=1e-7)
    np.testing.assert_array_equal(found.values, [(2 * i + 1) / (2 * points) for i in range(points)])
    assert found.is_fixed


@pytest.mark.parametrize(
    "density",
    [
        lambda _: 0.0,
        lambda _: -1.0,
        lambda x: x - 0.5,
        lambda _: float("nan"),
        lambda _: float("inf"),
        lambda x: 1 / x**2,
    ],
)
def test_what_is_no_density(density: Any) -> None:
    with pytest.raises(ValueError, match="non-negative with a finite positive mass"):
        Adaptability.from_density(density, 4)
    with pytest.raises(ValueError, match="at least 1 point"):
        Adaptability.from_density(lambda _: 1.0, 0)


CHANGES = st.sampled_from(("drifting", "tiring", "switching"))


@given(CHANGES, st.integers(1, 6), st.floats(0, 1), st.integers(0, 2**32))
def test_changing_adaptability_stays_a_distribution(
    change: str, count: int, rate: float, seed: int
) -> None:
    prior = random_rows(np.random.default_rng(seed), (count,), 0.0)
    fixed = Adaptability.over([i / 10 for i in range(count)], prior)
    changing = getattr(fixed, change)(rate)
    moves = changing.transition
    assert np.all(moves >= 0)
    np.testing.assert_allclose(moves.sum(axis=1), 1.0, atol=1e-14)
    np.testing.assert_array_equal(changing.values, fixed.values)
    np.testing.assert_array_equal(changing.prior, prior)
    if change == "drifting":  # symmetric, so nothing is favoured in the long run
        np.testing.assert_array_equal(moves, moves.T)
        if count >= 3:  # the variance that the docstring promises, from the middle
            d = np.array(fixed.values) - fixed.values[1]
            assert (moves[1] * d**2).sum() == pytest.approx(rate * 0.1**2)
            assert (moves[1] * d).sum() == pytest.approx(0.0, abs=1e-15)
    elif change == "tiring":
        assert not np.triu(moves, 1).any()
        np.testing.assert_allclose(np.diag(moves)[1:], 1 - rate)
        assert moves[0, 0] == 1
    else:  # the prior is kept
        np.testing.assert_allclose(prior @ moves, prior, atol=1e-14)


@pytest.mark.parametrize("change", ["drifting", "tiring", "switching"])
@pytest.mark.parametrize("rate", [-0.1, 1.1, float("nan")])
def test_a_rate_of_change_is_a_probability(change: str, rate: float) -> None:
    with pytest.raises(ValueError, match="rate of change"):
        getattr(Adaptability.over([0, 1]), change)(rate)


def test_tiring_needs_values_that_fall_towards_the_first() -> None:
    Adaptability.over(BY_GOAL).tiring(0.1)
    with pytest.raises(ValueError, match="can only fall"):
        Adaptability.over([[0, 1], [1, 0]]).tiring(0.1)


def test_no_change_is_no_change() -> None:
    for change in ("drifting", "tiring", "switching"):
        assert getattr(Adaptability.over([0, 0.5, 1]), change)(0.0).is_fixed
