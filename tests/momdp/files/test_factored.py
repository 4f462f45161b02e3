"""Random factored problems against their definition; and the same with entries in other words."""

from __future__ import annotations

import tempfile
import warnings
from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from coadapt.momdp import MOMDP
from coadapt.momdp.check import check_momdp
from tests.momdp.files.factored import Factored, factored_problems
from tests.momdp.files.helpers import problem_from


def dense(problem: MOMDP) -> np.ndarray:
    """``[X, A, Y, X', Y']``."""
    states, size, actions, _ = problem.shape
    joint = np.zeros((states, actions, size, states, size))
    for x in range(states):
        for a in range(actions):
            for e in problem.edges(x, a):
                joint[x, a, :, problem.edge_next[e]] = problem.transition.matrix(
                    int(problem.edge_map[e])
                )
    return joint


@given(factored_problems(), st.booleans())
def test_product_of_factors(model: Factored, split: bool) -> None:
    with tempfile.TemporaryDirectory() as directory:
        problem = problem_from(Path(directory), model.text(split), ".pomdpx")
    close = {"rtol": 0.0, "atol": 1e-12}
    joint = model.joint()
    np.testing.assert_allclose(dense(problem), joint, **close)
    np.testing.assert_allclose(problem.reward, model.reward(), **close)
    observation = problem.observation[problem.observation_index]
    np.testing.assert_allclose(observation, model.observation(), **close)
    initial = np.zeros((problem.shape[0], problem.shape[1]))
    for root in problem.roots:
        initial[root.x] = root.probability * root.belief
    np.testing.assert_allclose(initial, model.initial(), **close)
    # Edges are only where something is possible, and lead to each x' once.
    assert len(problem.edge_next) == np.count_nonzero(joint.any(axis=(2, 4)))


@given(factored_problems())
def test_result_is_valid(model: Factored) -> None:
    with tempfile.TemporaryDirectory() as directory:
        problem = problem_from(Path(directory), model.text(split=False), ".pomdpx")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # some observed states may not be reachable
        check_momdp(problem)
