"""The belief update against Bayes' rule written out over all hidden states."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.momdp import MOMDP, belief
from tests.momdp.problems import corridor, joint, observations, tiger
from tests.momdp.strategies import beliefs, momdps


@given(momdps(), st.integers(0, 2**32))
def test_update_is_bayes_rule(problem: MOMDP, seed: int) -> None:
    x_count, y_count, a_count, o_count = problem.shape
    moves, sees = joint(problem), observations(problem)
    for x, b in beliefs(problem, np.random.default_rng(seed)):
        for a in range(a_count):
            total = 0.0
            for x_next in range(x_count):
                for o in range(o_count):
                    # Ong et al. 2010, Eq. 2 (Eq. 9 of the paper), term by term.
                    mass = np.array(
                        [
                            sees[a, x_next, v, o]
                            * sum(moves[x, a, y, x_next, v] * b[y] for y in range(y_count))
                            for v in range(y_count)
                        ]
                    )
                    if mass.sum() == 0:
                        with pytest.raises(ValueError, match="probability 0"):
                            belief.update(problem, x, b, a, x_next, o)
                        continue
                    after, chance = belief.update(problem, x, b, a, x_next, o)
                    np.testing.assert_allclose(after, mass / mass.sum(), atol=1e-12)
                    np.testing.assert_allclose(chance, mass.sum(), atol=1e-14)
                    total += chance
            # Unless the task has ended something is seen next.
            assert total == pytest.approx(1.0 if len(problem.edges(x, a)) else 0.0, abs=1e-12)


def test_predict_sums_to_the_probability_of_the_successor() -> None:
    problem = tiger()
    np.testing.assert_allclose(
        belief.predict(problem, 0, np.array([0.3, 0.7]), 0, 0), [0.3, 0.7], atol=1e-16
    )
    # Opening a door puts the tiger anywhere.
    np.testing.assert_allclose(
        belief.predict(problem, 0, np.array([0.3, 0.7]), 1, 0), [0.5, 0.5], atol=1e-16
    )
    assert belief.predict(corridor(), 0, np.array([0.3, 0.7]), 0, 1).sum() == 0


def test_listening_twice_by_hand() -> None:
    # Two growls from the left at 85 % each: 0.85^2 to 0.15^2, or 289 to 9.
    problem = tiger()
    once, chance = belief.update(problem, 0, np.array([0.5, 0.5]), 0, 0, 0)
    twice, _ = belief.update(problem, 0, once, 0, 0, 0)
    assert chance == pytest.approx(0.5)
    np.testing.assert_allclose(once, [0.85, 0.15], atol=1e-15)
    np.testing.assert_allclose(twice, [289 / 298, 9 / 298], atol=1e-15)


def test_an_impossible_observation_is_named() -> None:
    with pytest.raises(ValueError, match="smile in far has probability 0 after stay in near"):
        belief.update(corridor(), 0, np.array([0.5, 0.5]), 0, 1, 0)
