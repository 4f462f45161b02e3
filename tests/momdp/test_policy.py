"""Alpha-vector policies and one step of look-ahead."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from coadapt.momdp import MOMDP, AlphaVectorPolicy, action_values
from tests.momdp.problems import joint, known_hidden_policy, observations
from tests.momdp.strategies import beliefs, momdps

POLICY = AlphaVectorPolicy(
    start=np.array([0, 3, 4]),
    vectors=np.array([[1.0, 0.0], [0.0, 1.0], [0.6, 0.6], [-5.0, 7.0]]),
    actions=np.array([2, 0, 1, 3]),
)


def test_the_best_vector_decides() -> None:
    # In state 0 the three vectors are worth b_0, b_1 and 0.6.
    assert POLICY.action(0, np.array([0.9, 0.1])) == 2
    assert POLICY.action(0, np.array([0.1, 0.9])) == 0
    assert POLICY.action(0, np.array([0.5, 0.5])) == 1
    assert POLICY.value(0, np.array([0.9, 0.1])) == 0.9
    assert POLICY.value(0, np.array([0.5, 0.5])) == 0.6
    # State 1 has one vector alone.
    assert POLICY.action(1, np.array([1.0, 0.0])) == 3
    assert POLICY.value(1, np.array([0.5, 0.5])) == 1.0


def test_on_a_tie_the_first_vector_decides() -> None:
    tied = AlphaVectorPolicy(np.array([0, 3]), np.ones((3, 2)), np.array([2, 0, 1]))
    assert tied.action(0, np.array([0.5, 0.5])) == 2


@given(momdps(), st.integers(0, 2**32))
def test_many_actions_are_those_one_by_one(problem: MOMDP, seed: int) -> None:
    rng = np.random.default_rng(seed)
    policy = known_hidden_policy(problem)
    # No two vectors share an action, so that a mix-up of states shows.
    policy = replace(policy, actions=rng.permutation(len(policy.actions)))
    some = beliefs(problem, rng)
    some = [some[i] for i in rng.permutation(len(some))]
    expected = [policy.action(x, b) for x, b in some]
    states, stacked = np.array([x for x, _ in some]), np.array([b for _, b in some])
    assert policy.actions_at(states, stacked).tolist() == expected
    for x, b in some[:2]:
        assert policy.actions_at(np.array([x]), b[None]).tolist() == [policy.action(x, b)]


@given(momdps(), st.integers(0, 2**32))
def test_action_values_look_one_step_ahead(problem: MOMDP, seed: int) -> None:
    x_count, _, a_count, o_count = problem.shape
    policy = known_hidden_policy(problem)
    moves, sees = joint(problem), observations(problem)
    for x, b in beliefs(problem, np.random.default_rng(seed)):
        expected = np.zeros(a_count)
        for a in range(a_count):
            expected[a] = problem.reward[x, a] @ b
            for x_next in range(x_count):
                for o in range(o_count):
                    mass = (b @ moves[x, a, :, x_next, :]) * sees[a, x_next, :, o]
                    rows = slice(policy.start[x_next], policy.start[x_next + 1])
                    expected[a] += problem.discount * max(policy.vectors[rows] @ mass)
        np.testing.assert_allclose(action_values(problem, policy, x, b), expected, atol=1e-12)
