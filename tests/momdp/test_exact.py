"""The exact values against calculations by hand and against a tree of all futures."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from coadapt.arrays import FloatArray
from coadapt.momdp import MOMDP, AlphaVectorPolicy, Root
from coadapt.momdp.exact import ExactSolution, evaluate_policy, exact_value
from tests.momdp.problems import corridor, joint, known_hidden_policy, observations, tiger
from tests.momdp.strategies import beliefs, momdps


def futures(
    problem: MOMDP, depth: int, policy: AlphaVectorPolicy | None = None
) -> list[tuple[float, float]]:
    """At every root the value of ``depth`` steps, and the probability of still going on.

    The tree of all actions and observations, without any alpha vector. With a policy, its action
    alone is followed; the probability is discounted.
    """
    moves, sees = joint(problem), observations(problem)
    x_count, _, a_count, o_count = problem.shape

    def value(x: int, b: FloatArray, left: int) -> tuple[float, float]:
        """Of the unnormalised belief ``b``."""
        if left == 0:
            return 0.0, float(b.sum())
        allowed = range(a_count) if policy is None else [policy.action(x, b / b.sum())]
        options: list[tuple[float, float]] = []
        for a in allowed:
            total, rest = float(problem.reward[x, a] @ b), 0.0
            for x_next in range(x_count):
                for o in range(o_count):
                    after = (b @ moves[x, a, :, x_next, :]) * sees[a, x_next, :, o]
                    if after.any():
                        later, going = value(x_next, after, left - 1)
                        total += problem.discount * later
                        rest += problem.discount * going
            options.append((total, rest))
        return max(options)[0], max(rest for _, rest in options)

    return [value(root.x, root.belief, depth) for root in problem.roots]


@given(momdps(discounts=(0.0, 0.1, 0.25)))
@settings(max_examples=15)
def test_values_agree_with_the_tree_of_all_futures(problem: MOMDP) -> None:
    solution = exact_value(problem, 1e-4)
    # Rewards lie in [-1, 1]: what follows after the tree is worth at most this.
    beyond = 1 / (1 - problem.discount)
    for r, (value, rest) in enumerate(futures(problem, 3)):
        assert solution.lower[r] <= value + rest * beyond + 1e-9
        assert solution.upper[r] >= value - rest * beyond - 1e-9


@given(momdps(), st.integers(0, 2**32))
@settings(max_examples=15)
def test_a_coarse_interval_holds_the_fine_one(problem: MOMDP, seed: int) -> None:
    coarse, fine = exact_value(problem, 0.05), exact_value(problem, 1e-3)
    assert np.all(fine.upper - fine.lower <= 1e-3)
    assert np.all(coarse.lower <= fine.upper)
    assert np.all(coarse.upper >= fine.lower)
    # And so it is at all beliefs, by the vectors.
    for x, b in beliefs(problem, np.random.default_rng(seed)):
        low, high = fine.policy.value(x, b), fine.policy.value(x, b) + fine.error
        assert coarse.policy.value(x, b) <= high
        assert coarse.policy.value(x, b) + coarse.error >= low


@given(momdps(), st.integers(0, 2**32))
@settings(max_examples=15)
def test_the_vectors_satisfy_the_bellman_equation(problem: MOMDP, seed: int) -> None:
    # V* = H V*, so a V within e below V* has |H V - V| <= (1 + gamma) e.
    solution = exact_value(problem, 1e-3)
    moves, sees = joint(problem), observations(problem)
    for x, b in beliefs(problem, np.random.default_rng(seed)):
        best = max(
            problem.reward[x, a] @ b
            + problem.discount
            * sum(
                solution.policy.value(u, (b @ moves[x, a, :, u, :]) * sees[a, u, :, o])
                for u in range(problem.shape[0])
                for o in range(problem.shape[3])
            )
            for a in range(problem.shape[2])
        )
        assert best == pytest.approx(solution.policy.value(x, b), abs=2e-3)


@cache
def tiger_solution() -> ExactSolution:
    return exact_value(tiger(), 1e-3)


def test_tiger() -> None:
    # 19.371 is what the C++ implementation of SARSOP reports (AdaCompNUS/sarsop, gap 1e-3).
    solution = tiger_solution()
    assert solution.upper[0] - solution.lower[0] <= 1e-3
    assert solution.lower[0] <= 19.3715
    assert solution.upper[0] >= 19.3705


def test_tiger_policy_exactly() -> None:
    # The best policy listens until one side is two growls ahead (0.85^2 against 0.15^2), so only
    # the beliefs 0, +-1 and +-2 growls are met; the mirror images make it a chain of three:
    #   v0 = -1 + g v1,  v1 = -1 + g (p v2 + (1 - p) v0),  v2 = 10 w - 100 (1 - w) + g v0
    # with p the chance of another growl of the same side and w = 0.85^2 / (0.85^2 + 0.15^2).
    g, hit, miss = 0.95, 0.85, 0.15
    again = hit * hit + miss * miss
    sure = hit * hit / again
    chain = np.array([[1, -g, 0], [-g * (1 - again), 1, -g * again], [-g, 0, 1]])
    expected = np.linalg.solve(chain, [-1, -1, 10 * sure - 100 * (1 - sure)])[0]
    found = evaluate_policy(tiger(), tiger_solution().policy)
    assert found.lower[0] == pytest.approx(expected, abs=1e-8)
    assert found.upper[0] == pytest.approx(expected, abs=1e-8)
    assert found.beliefs == 5
    # It is the optimum.
    assert tiger_solution().lower[0] <= expected <= tiger_solution().upper[0]


def test_a_constant_reward_for_ever() -> None:
    problem = replace(tiger(0.9), reward=np.full((1, 3, 2), -2.0))
    solution = exact_value(problem, 1e-6)
    # -2 (1 + 0.9 + 0.81 + ...) = -20
    assert solution.lower[0] <= -20.0 + 1e-9
    assert solution.upper[0] >= -20.0 - 1e-9
    assert solution.upper[0] - solution.lower[0] <= 1e-6


def test_an_end_ends_the_rewards() -> None:
    # Rewards are numbered 0 to 11 along x, a, y; discount 1/2. Nothing is learned that matters:
    # every reward for go exceeds that for stay by 2, and the later states pay more. From far:
    # go (6 + y), then 8 + y + 2 at the door at best: 6.5 + 0.5 * 10.5 for a uniform y, which
    # stays uniform. Staying for ever in far is worth less: 4.5 / (1 - 0.5) = 9.
    solution = exact_value(corridor(), 1e-6)
    from_near = 2.5 + 0.5 * (6.5 + 0.5 * 10.5)
    assert solution.lower[0] <= from_near <= solution.upper[0]
    # The second root is calm for certain: y = 1 has probability 0.25 after one step, 0.375 after
    # two, so go in far is worth 6 and the door 10.25.
    assert solution.lower[1] <= 6 + 0.5 * 10.25 <= solution.upper[1]
    found = evaluate_policy(corridor(), solution.policy)
    np.testing.assert_allclose(found.lower, [from_near, 6 + 0.5 * 10.25], atol=1e-12)
    np.testing.assert_allclose(found.upper, found.lower, atol=1e-12)


@pytest.mark.parametrize("discount", [0.0, 0.5, 0.9])
def test_the_interval_is_as_wide_as_the_contraction_says(discount: float) -> None:
    # Rewards are -100 to 10: U - L = 110 / (1 - gamma). Every step takes (1 - gamma) / 2 off.
    solution = exact_value(tiger(discount), 0.1)
    width = 110 / (1 - discount)
    steps = int(np.ceil(np.log(0.1 / width) / np.log((1 + discount) / 2)))
    assert solution.iterations == steps
    assert solution.error == pytest.approx(width * ((1 + discount) / 2) ** steps)
    assert solution.upper[0] - solution.lower[0] == pytest.approx(solution.error)


def test_it_refuses_what_is_too_large() -> None:
    with pytest.raises(ValueError, match="more than 3 alpha vectors"):
        exact_value(tiger(), 1e-3, max_vectors=3)
    with pytest.raises(ValueError, match="tolerance"):
        exact_value(tiger(), 0.0)
    with pytest.raises(ValueError, match="tolerance"):
        exact_value(tiger(), float("nan"))
    many = MOMDP.from_arrays(
        np.ones((1, 1, 1)),
        np.eye(7)[None, None],
        np.ones((1, 1, 7, 1)),
        np.zeros((1, 1, 7)),
        0.5,
        [Root(0, np.full(7, 1 / 7))],
    )
    with pytest.raises(ValueError, match="7 hidden states"):
        exact_value(many)


@given(momdps(discounts=(0.0, 0.25, 0.5)))
@settings(max_examples=15)
def test_evaluation_agrees_with_the_tree_of_all_futures(problem: MOMDP) -> None:
    policy = known_hidden_policy(problem)
    found = evaluate_policy(problem, policy, 1e-3, max_beliefs=500)
    beyond = 1 / (1 - problem.discount)
    for r, (value, rest) in enumerate(futures(problem, 4, policy)):
        assert found.lower[r] <= found.upper[r]
        assert found.lower[r] <= value + rest * beyond + 1e-9
        assert found.upper[r] >= value - rest * beyond - 1e-9


@given(momdps(discounts=(0.0, 0.25)))
@settings(max_examples=15)
def test_more_beliefs_narrow_the_interval(problem: MOMDP) -> None:
    policy = known_hidden_policy(problem)
    few = evaluate_policy(problem, policy, 1e-3, max_beliefs=1)
    many = evaluate_policy(problem, policy, 1e-3, max_beliefs=2000)
    assert few.beliefs <= 1
    assert np.all(few.lower <= many.lower + 1e-9)
    assert np.all(few.upper >= many.upper - 1e-9)
    if many.beliefs < 2000:
        assert np.all(many.upper - many.lower <= 1e-3)


@given(momdps(discounts=(0.0, 0.25)))
@settings(max_examples=15)
def test_the_policy_of_the_exact_solution_earns_its_value(problem: MOMDP) -> None:
    solution = exact_value(problem, 1e-4)
    found = evaluate_policy(problem, solution.policy, 1e-4, max_beliefs=2000)
    # Nothing earns more than the optimum.
    assert np.all(found.lower <= solution.upper + 1e-9)
    # The vectors are greedy, up to d (1 - gamma) / 2, for the V of the step before, which is within
    # d = 2 e / (1 + gamma) of V* for e = 1e-4. That loses at most (2 gamma d + d (1 - gamma) / 2) /
    # (1 - gamma) (Singh and Yee 1994), below 2.2 e for gamma <= 1/4.
    assert np.all(found.upper >= solution.lower - 2.2e-4)
