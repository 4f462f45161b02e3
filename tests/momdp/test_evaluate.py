"""Simulated values of policies against exact ones, and single steps against the model."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import coadapt as ca
from coadapt.momdp import MOMDP, AlphaVectorPolicy, belief
from coadapt.momdp.evaluate import BLOCK, LONGEST, default_horizon, simulate_policy
from coadapt.momdp.exact import evaluate_policy, exact_value
from coadapt.momdp.sarsop.episodes import OVER, Episodes, as_columns, mark_ended, run_steps
from coadapt.momdp.sarsop.problem import as_arrays
from tests.momdp.apart import run_apart
from tests.momdp.problems import corridor, known_hidden_policy, tiger
from tests.momdp.strategies import beliefs, momdps

ROUNDING = 1e-9


def expect_the_exact_value(problem: MOMDP, policy: AlphaVectorPolicy, episodes: int) -> None:
    found = simulate_policy(problem, policy, episodes, rng=np.random.default_rng(1))
    exact = evaluate_policy(problem, policy, 1e-4, max_beliefs=3000)
    weight = np.array([root.probability for root in problem.roots])
    reach = 4 * found.standard_error + found.truncation + ROUNDING
    assert found.mean >= weight @ exact.lower - reach
    assert found.mean <= weight @ exact.upper + reach


def test_tiger() -> None:
    expect_the_exact_value(tiger(), exact_value(tiger(), 1e-3).policy, 20_000)


@pytest.mark.parametrize("jump", [False, True])
def test_corridor(jump: bool) -> None:
    problem = corridor(jump=jump)
    expect_the_exact_value(problem, exact_value(problem, 1e-6).policy, 20_000)


@given(momdps())
def test_random_problems(problem: MOMDP) -> None:
    expect_the_exact_value(problem, known_hidden_policy(problem), 2000)


def test_a_policy_earns_what_the_solver_promises() -> None:
    problem = ca.SharedAutonomy(ca.worlds.table_clearing(7, 3)).to_momdp()
    solution = ca.SARSOP(gap=1e-2).solve(problem)
    found = simulate_policy(problem, solution.policy, 5000, rng=np.random.default_rng(2))
    assert found.mean >= solution.lower - 4 * found.standard_error
    assert found.mean <= solution.upper + 4 * found.standard_error
    # All episodes come to a goal long before the horizon.
    assert (found.unfinished, found.truncation) == (0, 0)


@given(momdps(), st.integers(0, 2**32))
@settings(max_examples=20)
def test_a_step_follows_the_model(problem: MOMDP, seed: int) -> None:
    rng = np.random.default_rng(seed)
    policy = known_hidden_policy(problem)
    p, columns = as_arrays(problem), as_columns(policy)
    never = np.zeros((problem.shape[0], problem.shape[1]), dtype=np.bool_)
    for x, b in beliefs(problem, rng):
        y = int(rng.choice(len(b), p=b))
        now = Episodes(np.array([x]), np.array([y]), b[None].copy(), np.zeros(1))
        assert run_steps(p, columns, never, now, 0.5, rng.random((1, 1, 2))) == 1
        a = policy.action(x, b)
        assert now.total[0] == 0.5 * problem.reward[x, a, y]
        if now.x[0] == OVER:
            # At an end, or nothing will ever change.
            stays = {int(problem.edge_next[e]) for e in problem.edges(x, a)} <= {x}
            assert stays or len(problem.edges(x, a)) == 0
            continue
        to, after = int(now.x[0]), now.belief[0]
        moved = sum(
            problem.transition.matrix(int(problem.edge_map[e]))[y, now.y[0]]
            for e in problem.edges(x, a)
            if problem.edge_next[e] == to
        )
        assert moved > 0
        assert after[now.y[0]] > 0
        mass = belief.predict(problem, x, b, a, to)
        possible = [
            belief.update(problem, x, b, a, to, o)[0]
            for o in range(problem.shape[3])
            if (mass * belief.likelihood(problem, a, to, o)).sum() > 0
        ]
        assert min(np.abs(after - other).max() for other in possible) < ROUNDING


@given(momdps())
@settings(max_examples=20)
def test_nothing_follows_a_state_that_has_ended(problem: MOMDP) -> None:
    # With random rewards, only the states from which every action ends; set some to 0 first.
    reward = problem.reward.copy()
    reward[0] = 0
    quiet = replace(problem, reward=reward)
    ended = mark_ended(as_arrays(quiet))
    for x, y in np.ndindex(ended.shape):
        later = {
            (int(quiet.edge_next[e]), int(to))
            for a in range(quiet.shape[2])
            for e in quiet.edges(x, a)
            for to in np.flatnonzero(quiet.transition.matrix(int(quiet.edge_map[e]))[y])
        }
        silent = not quiet.reward[x, :, y].any()
        if ended[x, y]:
            assert silent
        assert not (ended[x, y] and any(not ended[state] for state in later))
        # And it is marked unless a reward, or a state that is not marked, can follow.
        assert ended[x, y] or not silent or any(not ended[state] for state in later)


def test_an_episode_without_further_rewards_is_finished() -> None:
    found = simulate_policy(
        corridor(),
        exact_value(corridor(), 1e-6).policy,
        100,
        rng=np.random.default_rng(0),
        horizon=10,
    )
    # Go, go, and the door, which pays once and ends.
    assert found.unfinished == 0
    assert 2 * 100 <= found.steps <= 3 * 100


def test_the_horizon_cuts_off() -> None:
    policy = exact_value(tiger(), 1e-3).policy
    one = simulate_policy(tiger(), policy, 100, rng=np.random.default_rng(0), horizon=1)
    # The first action is to listen, at a cost of 1.
    assert (one.mean, one.standard_error, one.steps, one.unfinished) == (-1, 0, 100, 100)
    # What follows is at worst -100 in each step: 0.95 * 100 / (1 - 0.95).
    assert one.truncation == pytest.approx(1900)
    low, high = one.interval
    assert (low, high) == (-1, -1)


@pytest.mark.parametrize(("discount", "steps"), [(0.0, 1), (1e-5, 1), (0.1, 4), (0.95, 180)])
def test_the_default_horizon(discount: float, steps: int) -> None:
    # 0.95 ** 180 = 0.98e-4 and 0.95 ** 179 = 1.03e-4.
    assert default_horizon(discount) == steps
    assert discount ** default_horizon(discount) <= 1e-4 * (1 + ROUNDING)


def test_the_default_horizon_has_an_end() -> None:
    assert default_horizon(0.99999) == LONGEST


def test_a_seed_fixes_the_result_and_progress_is_told() -> None:
    policy = exact_value(tiger(), 1e-2).policy
    told: list[int] = []
    one, other, third = (
        simulate_policy(tiger(), policy, 2 * BLOCK + 7, rng=np.random.default_rng(s), progress=tell)
        for s, tell in ((3, told.append), (3, None), (4, None))
    )
    assert one == other
    assert one != third
    assert told == sorted(told)
    assert told[0] == 0
    assert 2 * BLOCK <= told[-1] < 2 * BLOCK + 7


def test_confidence_intervals_hold_the_value_as_often_as_they_say() -> None:
    problem = corridor()
    policy = exact_value(problem, 1e-6).policy
    exact = evaluate_policy(problem, policy)
    value = 0.25 * exact.lower[0] + 0.75 * exact.lower[1]
    held = 0
    for seed in range(200):
        low, high = simulate_policy(problem, policy, 400, rng=np.random.default_rng(seed)).interval
        held += low <= value <= high
    # 95 % of 200 is 190, with a standard deviation of sqrt(200 * 0.95 * 0.05) = 3.1.
    assert abs(held - 190) <= 4 * math.sqrt(200 * 0.95 * 0.05)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"episodes": 1}, "episodes must be at least 2, not 1"),
        ({"horizon": 0}, "horizon must be at least 1 step, not 0"),
        ({"problem": corridor()}, "for 1 observed and 2 hidden states, expected one for 3 and 2"),
        ({"actions": np.array([7])}, "found action 7 in the policy, expected one of 0 to 2"),
        ({"vectors": np.zeros((1, 3))}, "for 1 observed and 3 hidden states"),
        ({"start": np.array([0, 0])}, "found no alpha vector for an observed state"),
    ],
)
def test_what_cannot_be_used_is_refused(changes: dict[str, object], message: str) -> None:
    given: dict[str, object] = {
        "problem": tiger(),
        "episodes": 10,
        "horizon": None,
        "start": np.array([0, 1]),
        "vectors": np.zeros((1, 2)),
        "actions": np.array([0]),
    } | changes
    policy = AlphaVectorPolicy(given["start"], given["vectors"], given["actions"])
    with pytest.raises(ValueError, match=message):
        simulate_policy(
            given["problem"],
            policy,
            given["episodes"],
            rng=np.random.default_rng(0),
            horizon=given["horizon"],
        )


UNCOMPILED = """
import json
import numba
import numpy as np
from coadapt.momdp.evaluate import simulate_policy
from tests.momdp.problems import corridor, known_hidden_policy, tiger
found = []
for problem in (tiger(0.8), corridor(), corridor(jump=True)):
    policy = known_hidden_policy(problem)
    value = simulate_policy(problem, policy, 300, rng=np.random.default_rng(0))
    found.append([value.mean, value.standard_error, value.steps])
print(json.dumps({"compiled": not numba.config.DISABLE_JIT, "found": found}))
"""


def test_kernels_do_the_same_uncompiled() -> None:
    # Same operations in the same order: the same numbers to the last bit.
    plain = run_apart(UNCOMPILED, NUMBA_DISABLE_JIT="1")
    compiled = run_apart(UNCOMPILED, NUMBA_DISABLE_JIT="0")
    assert (plain["compiled"], compiled["compiled"]) == (False, True)
    assert plain["found"] == compiled["found"]
