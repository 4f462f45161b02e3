"""Adaptability and the change of mode it brings."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

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
        (dict(values=[[0.5]]), "at least one"),
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
