"""The solver against exact values of small problems."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import coadapt as ca
from coadapt.momdp import MOMDP, action_values, belief
from coadapt.momdp.exact import evaluate_policy, exact_value
from coadapt.momdp.files import read_pomdp
from coadapt.momdp.sarsop import SARSOP, Record, Solution, Status
from coadapt.momdp.sarsop.sample import DEPTH_LIMIT
from tests.momdp.apart import run_apart
from tests.momdp.problems import corridor, tiger
from tests.momdp.strategies import beliefs, jump_momdps, momdps, sparse_momdps

SRC = Path(ca.__file__).parents[1]
ROUNDING = 1e-9


@cache
def table_clearing() -> tuple[MOMDP, Solution]:
    problem = ca.SharedAutonomy(ca.worlds.table_clearing()).to_momdp()
    return problem, SARSOP(gap=1e-3).solve(problem)


@given(momdps(), st.sampled_from((1e-1, 1e-3)))
def test_the_bounds_hold_the_optimal_value(problem: MOMDP, gap: float) -> None:
    solution = SARSOP(gap=gap, max_backups=2000).solve(problem)
    exact = exact_value(problem, 1e-4)
    assert solution.root_lower.shape == solution.root_upper.shape == (len(problem.roots),)
    assert np.all(solution.root_lower <= exact.upper + ROUNDING)
    assert np.all(solution.root_upper >= exact.lower - ROUNDING)
    assert np.all(solution.root_lower <= solution.root_upper + ROUNDING)
    if solution.status is Status.GAP:
        assert np.all(solution.root_upper - solution.root_lower <= gap + ROUNDING)
    else:
        assert solution.status is Status.BACKUPS


@given(jump_momdps(mixing=True, discounts=(0.7,)))
def test_the_bounds_hold_where_blocks_mix(problem: MOMDP) -> None:
    solution = SARSOP(gap=1e-3, max_backups=2000).solve(problem)
    exact = exact_value(problem, 1e-3)
    assert np.all(solution.root_lower <= exact.upper + ROUNDING)
    assert np.all(solution.root_upper >= exact.lower - ROUNDING)


@given(momdps())
@settings(max_examples=20)
def test_small_problems_are_solved(problem: MOMDP) -> None:
    solution = SARSOP(gap=0.05, max_backups=20_000).solve(problem)
    assert solution.status is Status.GAP
    assert solution.gap <= 0.05 + ROUNDING


def expect_the_policy_to_earn_its_value(problem: MOMDP, backups: int, seed: int) -> None:
    """At every belief, not only where the solver has been."""
    # If V(x, b) <= Q(x, b, a) for the policy's action a at every belief, with Q looking one step
    # ahead to V, then the policy earns at least V: V <= r + gamma P V implies V <= (I - gamma
    # P)^-1 r.
    policy = SARSOP(gap=1e-3, max_backups=backups).solve(problem).policy
    for x, b in beliefs(problem, np.random.default_rng(seed)):
        following = action_values(problem, policy, x, b)[policy.action(x, b)]
        assert policy.value(x, b) <= following + ROUNDING


@given(momdps(), st.sampled_from((0, 5, 500)), st.integers(0, 2**32))
def test_the_policy_earns_its_value_everywhere(problem: MOMDP, backups: int, seed: int) -> None:
    expect_the_policy_to_earn_its_value(problem, backups, seed)


@given(sparse_momdps(revealing=True, discounts=(0.7,)), st.integers(0, 2**32))
@settings(max_examples=80)
def test_it_does_where_successors_are_impossible(problem: MOMDP, seed: int) -> None:
    # The vector of a belief that rules out a successor still holds at beliefs that do not.
    expect_the_policy_to_earn_its_value(problem, 100, seed)


@given(momdps(discounts=(0.0, 0.3)))
@settings(max_examples=20)
def test_the_policy_earns_at_least_its_bound(problem: MOMDP) -> None:
    solution = SARSOP(gap=1e-3, max_backups=500).solve(problem)
    found = evaluate_policy(problem, solution.policy, 1e-4, max_beliefs=1000)
    assert np.all(found.upper >= solution.root_lower - ROUNDING)
    assert np.all(found.lower <= solution.root_upper + ROUNDING)


def test_tiger() -> None:
    # Solved by hand in tests/momdp/test_exact.py: 19.37136837 for two growls ahead.
    solution = SARSOP(gap=1e-3).solve(tiger())
    assert solution.status is Status.GAP
    assert solution.lower <= 19.37136837 + 1e-7
    assert solution.upper >= 19.37136837 - 1e-7
    assert solution.upper - solution.lower <= 1e-3
    found = evaluate_policy(tiger(), solution.policy)
    assert found.lower[0] >= solution.lower - ROUNDING
    # Listening three times the same comes to a door, whichever it is.
    b = np.array([0.5, 0.5])
    for _ in range(3):
        assert solution.policy.action(0, b) == 0 or b.max() > 0.95
        b, _ = belief.update(tiger(), 0, b, 0, 0, 0)
    assert solution.policy.action(0, b) == 2  # growls from the left: open the right door


@pytest.mark.parametrize("name", ["1d", "hanks.95", "mcc-example1", "tiger.aaai"])
def test_published_problems(shared: Path, name: str) -> None:
    # Problems of Cassandra's collection with few hidden states.
    problem = read_pomdp(shared / "problems" / f"{name}.pomdp")
    solution = SARSOP(gap=1e-3).solve(problem)
    exact = exact_value(problem, 1e-2)
    assert solution.status is Status.GAP
    assert np.all(solution.root_lower <= exact.upper + ROUNDING)
    assert np.all(solution.root_upper >= exact.lower - ROUNDING)
    found = evaluate_policy(problem, solution.policy, 1e-4, max_beliefs=2000)
    assert np.all(found.upper >= solution.root_lower - ROUNDING)


def test_an_end_is_worth_its_last_reward() -> None:
    # By hand in tests/momdp/test_exact.py: 2.5 + 6.5 / 2 + 10.5 / 4 and 6 + 10.25 / 2.
    solution = SARSOP(gap=1e-6).solve(corridor())
    np.testing.assert_allclose(solution.root_lower, [8.375, 11.125], atol=1e-6)
    np.testing.assert_allclose(solution.root_upper, [8.375, 11.125], atol=1e-6)
    # Weighted by the probability of the roots, a quarter and three quarters.
    assert solution.lower == pytest.approx(0.25 * 8.375 + 0.75 * 11.125, abs=1e-6)
    assert solution.upper == pytest.approx(0.25 * 8.375 + 0.75 * 11.125, abs=1e-6)


@pytest.mark.parametrize("jump", [False, True])
def test_both_transition_kinds_give_the_same_bounds(jump: bool) -> None:
    # The jump corridor has the maps of the sparse one.
    solution = SARSOP(gap=1e-6).solve(corridor(jump=jump))
    np.testing.assert_allclose(solution.root_lower, [8.375, 11.125], atol=1e-6)


def same(one: Solution, other: Solution) -> bool:
    arrays = [
        (one.policy.start, other.policy.start),
        (one.policy.vectors, other.policy.vectors),
        (one.policy.actions, other.policy.actions),
        (one.root_lower, other.root_lower),
        (one.root_upper, other.root_upper),
    ]
    work = [
        [(r.backups, r.lower, r.upper, r.gap, r.vectors) for r in s.trace] for s in (one, other)
    ]
    return (
        all(np.array_equal(a, b) for a, b in arrays)
        and work[0] == work[1]
        and (one.status, one.backups) == (other.status, other.backups)
    )


@given(momdps())
@settings(max_examples=15)
def test_the_result_is_fixed(problem: MOMDP) -> None:
    solver = SARSOP(gap=1e-3, max_backups=300)
    assert same(solver.solve(problem), solver.solve(problem))


def test_the_result_is_fixed_on_a_longer_run() -> None:
    problem, solution = table_clearing()
    assert same(solution, SARSOP(gap=1e-3).solve(problem))


def test_it_stops_after_the_backups() -> None:
    problem, solved = table_clearing()
    none = SARSOP(gap=1e-3, max_backups=0).solve(problem)
    assert (none.status, none.backups) == (Status.BACKUPS, 0)
    some = SARSOP(gap=1e-3, max_backups=200).solve(problem)
    assert some.status is Status.BACKUPS
    # The trial under way is finished, which is at most DEPTH_LIMIT + 1 backups.
    assert 200 <= some.backups <= 200 + DEPTH_LIMIT + 1
    assert some.backups < solved.backups
    # More work, better bounds.
    for less, more in ((none, some), (some, solved)):
        assert np.all(more.root_lower >= less.root_lower - ROUNDING)
        assert np.all(more.root_upper <= less.root_upper + ROUNDING)
        assert less.gap > more.gap


def test_it_stops_at_the_relative_gap() -> None:
    solution = SARSOP(gap=1e-9, relative_gap=0.05).solve(tiger())
    assert solution.status is Status.GAP
    # Not long after it could, so not for the other reason.
    assert 1e-3 < solution.gap <= 0.05 * solution.lower + ROUNDING


def test_it_stops_at_the_memory() -> None:
    problem, solved = table_clearing()
    solution = SARSOP(gap=1e-9, memory_limit=4 << 20).solve(problem)
    assert solution.status is Status.MEMORY
    assert np.all(solution.root_lower <= solved.root_upper + ROUNDING)
    assert np.all(solution.root_upper >= solved.root_lower - ROUNDING)
    more = SARSOP(gap=1e-9, memory_limit=16 << 20, max_backups=20_000).solve(problem)
    assert more.backups > solution.backups
    for found, limit in ((solution, 4 << 20), (more, 16 << 20)):
        assert all(0 < record.memory <= limit for record in found.trace)


def test_it_refuses_where_the_first_bounds_take_more_memory() -> None:
    problem, _ = table_clearing()
    with pytest.raises(MemoryError, match=r"memory_limit: the first bounds take [\d,]+ bytes"):
        SARSOP(memory_limit=2 << 20).solve(problem)


def test_it_stops_at_the_time() -> None:
    problem = ca.SharedAutonomy(ca.worlds.table_clearing()).to_momdp()
    solution = SARSOP(gap=1e-12, time_limit=0.0).solve(problem)
    assert solution.status is Status.TIME
    assert np.all(solution.root_lower <= solution.root_upper)


def test_an_interruption_keeps_what_was_found() -> None:
    seen: list[Record] = []

    def interrupt(record: Record) -> None:
        seen.append(record)
        if len(seen) == 3:
            raise KeyboardInterrupt

    problem, solved = table_clearing()
    solution = SARSOP(gap=1e-9, callback=interrupt).solve(problem)
    assert solution.status is Status.INTERRUPTED
    assert solution.backups >= seen[2].backups > 0
    assert solution.lower <= solved.upper
    assert solution.upper >= solved.lower
    assert solution.policy.action(problem.roots[0].x, problem.roots[0].belief) in range(3)


def test_the_trace_shows_the_bounds_closing() -> None:
    _, solution = table_clearing()
    trace = solution.trace
    assert trace[0].backups == 0
    assert trace[-1].backups == solution.backups
    for before, after in pairwise(trace):
        assert after.backups >= before.backups
        assert after.seconds >= before.seconds
        assert after.lower >= before.lower - ROUNDING
        assert after.upper <= before.upper + ROUNDING
    assert trace[-1].lower == pytest.approx(solution.lower, abs=ROUNDING)
    assert trace[-1].upper == pytest.approx(solution.upper, abs=ROUNDING)
    assert solution.seconds >= trace[-1].seconds
    assert solution.vectors == len(solution.policy.vectors)


def test_table_clearing_is_solved() -> None:
    problem, solution = table_clearing()
    assert solution.status is Status.GAP
    assert solution.gap <= 1e-3
    weights = [root.probability for root in problem.roots]
    assert solution.lower == pytest.approx(float(weights @ solution.root_lower))
    # The best a robot can do is to go straight to the optimal goal without any disagreement:
    # 9 moves (tests/worlds), 11 * 0.99^9. The sub-optimal goal at the most complete disagreement
    # all the way is the worst it would do.
    assert solution.upper <= 11 * 0.99**9
    assert solution.lower >= 10 * 0.99**9 - 9 * 0.32
    found = evaluate_policy(problem, solution.policy, 1e-2, max_beliefs=4000)
    assert np.all(found.upper >= solution.root_lower - ROUNDING)
    assert np.all(found.lower <= solution.root_upper + ROUNDING)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (dict(gap=0.0), "gap"),
        (dict(gap=-1.0), "gap"),
        (dict(gap=float("nan")), "gap"),
        (dict(relative_gap=-0.1), "relative_gap"),
        (dict(relative_gap=1.0), "relative_gap"),
        (dict(relative_gap=float("nan")), "relative_gap"),
        (dict(memory_limit=0), "memory_limit"),
        (dict(max_backups=-1), "max_backups"),
        (dict(time_limit=-1.0), "time_limit"),
        (dict(time_limit=float("nan")), "time_limit"),
    ],
)
def test_bad_settings_are_refused(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        SARSOP(**settings)


UNCOMPILED = """
import json
import numba
from coadapt.momdp.sarsop import SARSOP
from tests.momdp.problems import corridor, tiger
found = []
for problem in (tiger(0.8), corridor(), corridor(jump=True)):
    solution = SARSOP(gap=1e-2, max_backups=150).solve(problem)
    found.append([[r.backups, r.lower, r.upper, r.gap, r.vectors] for r in solution.trace])
    found.append(solution.policy.vectors.tolist())
print(json.dumps({"compiled": not numba.config.DISABLE_JIT, "found": found}))
"""


def test_kernels_do_the_same_uncompiled() -> None:
    # Same operations in the same order: the same bounds to the last bit.
    plain = run_apart(UNCOMPILED, NUMBA_DISABLE_JIT="1")
    compiled = run_apart(UNCOMPILED, NUMBA_DISABLE_JIT="0")
    assert (plain["compiled"], compiled["compiled"]) == (False, True)
    assert plain["found"] == compiled["found"]
