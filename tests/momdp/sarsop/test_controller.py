"""Policies as finite-state controllers: to start from, and condensed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import coadapt as ca
from coadapt.momdp import MOMDP, AlphaVectorPolicy, action_values
from coadapt.momdp.exact import exact_value
from coadapt.momdp.sarsop import SARSOP, condensed
from tests.momdp.problems import tiger
from tests.momdp.strategies import beliefs, jump_momdps, momdps

ROUNDING = 1e-9
NO_SEARCH = SARSOP(max_backups=0)
SOLVED = 1e-3
"""Gap of a solution to start from."""


@pytest.mark.parametrize(
    "problem",
    [tiger(), ca.SharedAutonomy(ca.worlds.table_clearing()).to_momdp()],
    ids=["tiger", "table clearing"],
)
def test_a_solution_is_as_good_a_start(problem: MOMDP) -> None:
    solved = SARSOP(gap=SOLVED).solve(problem)
    again = NO_SEARCH.solve(problem, solved.policy)
    # The controller follows the policy from the roots. A vector that is best at several beliefs is
    # followed as at the first of them, which may cost a little: much less than the solver left.
    assert np.all(again.root_lower >= solved.root_lower - 0.1 * SOLVED)
    assert np.all(again.root_lower <= solved.root_upper + ROUNDING)


@given(momdps() | jump_momdps(discounts=(0.7,)), st.integers(0, 2**32))
@settings(max_examples=60)
def test_values_in_the_start_are_not_believed(problem: MOMDP, seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, y, a, _ = problem.shape
    boast = AlphaVectorPolicy(
        start=2 * np.arange(x + 1),
        vectors=rng.normal(scale=1e6, size=(2 * x, y)),
        actions=rng.integers(a, size=2 * x),
    )
    solution = NO_SEARCH.solve(problem, boast)
    exact = exact_value(problem, 1e-3)
    assert np.all(solution.root_lower <= exact.upper + ROUNDING)
    # It adds to what the solver begins with.
    assert np.all(solution.root_lower >= NO_SEARCH.solve(problem).root_lower - ROUNDING)


def test_a_start_for_other_rewards_is_valued_anew() -> None:
    problem = tiger()
    policy = SARSOP(gap=1e-3).solve(problem).policy
    halved = replace(problem, reward=problem.reward / 2)
    # The same choices earn half: 19.37136837 / 2, from tests/momdp/test_exact.py.
    solution = NO_SEARCH.solve(halved, policy)
    assert solution.lower == pytest.approx(19.37136837 / 2, abs=1e-3)
    assert solution.lower <= 19.37136837 / 2 + ROUNDING


def test_a_start_of_other_sizes_is_refused() -> None:
    policy = AlphaVectorPolicy(np.array([0, 1]), np.zeros((1, 3)), np.array([0]))
    with pytest.raises(ValueError, match="and 3 hidden states, expected one for 1 and 2"):
        SARSOP().solve(tiger(), policy)
    with pytest.raises(ValueError, match="found action 3 in the policy, expected one of 0 to 2"):
        SARSOP().solve(tiger(), replace(policy, vectors=np.zeros((1, 2)), actions=np.array([3])))
    with pytest.raises(ValueError, match="no vector for x0"):
        SARSOP().solve(
            tiger(),
            AlphaVectorPolicy(np.array([0, 0]), np.zeros((0, 2)), np.zeros(0, dtype=np.int64)),
        )


@given(
    momdps() | jump_momdps(discounts=(0.7,)), st.sampled_from((0, 5, 500)), st.integers(0, 2**32)
)
@settings(max_examples=60)
def test_a_condensed_policy_earns_its_value(problem: MOMDP, backups: int, seed: int) -> None:
    solution = SARSOP(gap=1e-3, max_backups=backups).solve(problem)
    policy = condensed(problem, solution.policy)
    assert np.all(np.diff(policy.start) > 0)
    # As of the solver's own policies: V <= Q of its action everywhere.
    for x, b in beliefs(problem, np.random.default_rng(seed)):
        following = action_values(problem, policy, x, b)[policy.action(x, b)]
        assert policy.value(x, b) <= following + ROUNDING
    values = np.array([policy.value(root.x, root.belief) for root in problem.roots])
    assert np.all(values <= solution.root_upper + ROUNDING)


def test_condensing_costs_little() -> None:
    problem = ca.SharedAutonomy(ca.worlds.table_clearing()).to_momdp()
    solved = SARSOP(gap=SOLVED).solve(problem)
    policy = condensed(problem, solved.policy)
    values = np.array([policy.value(root.x, root.belief) for root in problem.roots])
    assert np.all(values >= solved.root_lower - 0.1 * SOLVED)
    assert len(policy.vectors) < len(solved.policy.vectors) / 2
