"""Modal policies against sums over paths."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.arrays import FloatArray, IntArray
from coadapt.human import maximum_entropy_policy, soft_value
from coadapt.worlds import grid
from tests.worlds.strategies import random_outcomes

UNSEEN = -1


@st.composite
def graphs(draw: st.DrawFn, states: int = 5, actions: int = 3) -> tuple[IntArray, int, list[int]]:
    """Moves ``[X, A]``, a goal and up to two other goals."""
    x, a = draw(st.integers(2, states)), draw(st.integers(1, actions))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    goal, *others = rng.permutation(x)[: draw(st.integers(1, min(3, x)))]
    return rng.integers(x, size=(x, a)), int(goal), [int(g) for g in others]


def paths(
    moves: IntArray, start: int, goal: int, others: list[int], longest: int
) -> list[tuple[int, ...]]:
    """All action sequences of up to ``longest`` steps that end on first reaching a goal, at it."""
    found: list[tuple[int, ...]] = []
    growing: list[tuple[int, tuple[int, ...]]] = [(start, ())]
    for _ in range(longest):
        longer: list[tuple[int, tuple[int, ...]]] = []
        for (state, path), a in product(growing, range(moves.shape[1])):
            following = int(moves[state, a])
            if following == goal:
                found.append((*path, a))
            elif following not in others:
                longer.append((following, (*path, a)))
        growing = longer
    return found


def shortest_paths(moves: IntArray, goal: int, others: list[int]) -> tuple[IntArray, IntArray]:
    """For every state the length and the number of shortest paths, `UNSEEN` where there is none."""
    length, number = np.full(len(moves), UNSEEN), np.zeros(len(moves), dtype=np.int64)
    length[goal], number[goal] = 0, 1
    for steps in range(1, len(moves)):
        for state in range(len(moves)):
            if length[state] == UNSEEN and state not in others:
                number[state] = sum(number[n] for n in moves[state] if length[n] == steps - 1)
        length[(length == UNSEEN) & (number > 0)] = steps
    return length, number


@given(graphs(), st.floats(1.2, 20.0))
def test_rows_are_distributions(graph: tuple[IntArray, int, list[int]], cost: float) -> None:
    moves, goal, others = graph
    policy = maximum_entropy_policy(moves, goal, cost, others)
    assert policy.shape == moves.shape
    assert np.all(policy >= 0)
    np.testing.assert_allclose(policy.sum(axis=1), 1.0, atol=1e-12)
    # Where nothing matters all actions are alike.
    value = soft_value(moves, goal, cost, others)
    np.testing.assert_array_equal(policy[[goal, *others]], 1 / moves.shape[1])
    np.testing.assert_array_equal(policy[np.isneginf(value)], 1 / moves.shape[1])


@given(graphs(states=4), st.floats(3.5, 6.0))
def test_paths_have_the_probability_of_their_length(
    graph: tuple[IntArray, int, list[int]], cost: float
) -> None:
    # Ziebart et al. 2008, Eq. 4 with a cost of c a step: P(path) = exp(-c n) / Z. Of the Z summed
    # here at most sum_{n > 6} (3 exp(-3.5))^n < 5e-8 is missing in every state.
    moves, goal, others = graph
    policy = maximum_entropy_policy(moves, goal, cost, others)
    value = soft_value(moves, goal, cost, others)
    length, _ = shortest_paths(moves, goal, others)
    for start in range(len(moves)):
        if start == goal or start in others:
            continue
        found = paths(moves, start, goal, others, 6)
        weights = np.array([np.exp(-cost * len(path)) for path in found])
        assert (length[start] != UNSEEN) == bool(found) == bool(np.isfinite(value[start]))
        if not found:
            continue
        total = float(np.exp(value[start]))
        assert weights.sum() <= total * (1 + 1e-9)
        assert weights.sum() >= total - 5e-8
        for path, weight in zip(found, weights, strict=True):
            state, chance = start, 1.0
            for a in path:
                chance *= policy[state, a]
                state = int(moves[state, a])
            assert chance == pytest.approx(weight / total, rel=1e-8)


@given(graphs())
def test_a_large_cost_leaves_the_shortest_paths_alone(
    graph: tuple[IntArray, int, list[int]],
) -> None:
    # All shortest paths alike: an action is taken in proportion to the number of those it begins.
    # The next longer path weighs exp(-40) as much.
    moves, goal, others = graph
    policy = maximum_entropy_policy(moves, goal, 40.0, others)
    length, number = shortest_paths(moves, goal, others)
    for state in range(len(moves)):
        if state == goal or state in others or length[state] == UNSEEN:
            continue
        begins = [
            number[n] if length[n] == length[state] - 1 else 0 for n in map(int, moves[state])
        ]
        np.testing.assert_allclose(policy[state], np.array(begins) / number[state], atol=1e-12)


def spectral_radius(moves: IntArray, ends: list[int], cost: float) -> float:
    """Of exp(-c) times the adjacency matrix among the states that are no ends."""
    adjacency = np.zeros((len(moves), len(moves)))
    for state, row in enumerate(moves):
        for following in row:
            adjacency[state, following] += np.exp(-cost)
    inner = [s for s in range(len(moves)) if s not in ends]
    return max(np.abs(np.linalg.eigvals(adjacency[np.ix_(inner, inner)])), default=0.0)


@given(graphs(), st.floats(-1.0, 1.4))
def test_it_refuses_exactly_where_the_sum_over_paths_diverges(
    graph: tuple[IntArray, int, list[int]], cost: float
) -> None:
    moves, goal, others = graph
    radius = spectral_radius(moves, [goal, *others], cost)
    if radius < 0.999:
        maximum_entropy_policy(moves, goal, cost, others)
    elif radius > 1.001:
        with pytest.raises(ValueError, match="too small"):
            maximum_entropy_policy(moves, goal, cost, others)


@pytest.mark.parametrize("actions", [1, 2, 3, 4])
def test_it_refuses_the_boundary_itself(actions: int) -> None:
    # A state that every action keeps, at a cost of ln A: radius 1, and a singular system.
    moves = np.array([[0] * actions, [1] * actions])
    with pytest.raises(ValueError, match="too small"):
        maximum_entropy_policy(moves, 0, float(np.log(actions)))


@given(graphs(), st.floats(0.05, 3.0))
def test_a_cost_above_the_logarithm_of_the_actions_is_safe(
    graph: tuple[IntArray, int, list[int]], above: float
) -> None:
    moves, goal, others = graph
    cost = float(np.log(moves.shape[1])) + above
    assert spectral_radius(moves, [goal, *others], cost) < 1
    value = soft_value(moves, goal, cost, others)
    # V satisfies its equation, and no state is better than a goal would be.
    for state in range(len(moves)):
        if state != goal and state not in others:
            total = np.exp(value[moves[state]] - cost).sum()
            assert np.exp(value[state]) == pytest.approx(total, rel=1e-9, abs=1e-300)


@pytest.mark.parametrize("cost", [float("nan"), float("inf"), float("-inf")])
def test_a_cost_is_a_finite_number(cost: float) -> None:
    with pytest.raises(ValueError, match="finite"):
        maximum_entropy_policy(np.array([[1], [1]]), 1, cost)


def test_no_path_leads_through_another_goal() -> None:
    # 0 - 1 - 2 in a row, actions left and right, goals 0 and 2: from 1 both are one step away.
    moves = np.array([[0, 1], [0, 2], [1, 2]])
    to_left = maximum_entropy_policy(moves, 0, 3.0, [2])
    assert to_left[1].tolist() == [1.0, 0.0]
    # With 2 an ordinary state there are detours over it.
    assert maximum_entropy_policy(moves, 0, 3.0)[1, 1] > 0


def row_by_row(columns: int, rows: int, cost: float) -> FloatArray:
    """``V`` of the far left cell of a grid with moves left, forward, right, in another way.

    Nothing leads back a row, so the linear equations ``z = exp(-c) (z_left + z_forward + z_right)``
    of ``z = exp(V)`` are solved a row at a time, from the far one, scaled by the largest of each.
    """
    e = np.exp(-cost)
    sideways = np.zeros((columns, columns))
    for c in range(columns):
        sideways[c, max(c - 1, 0)] += e
        sideways[c, min(c + 1, columns - 1)] += e
    far = sideways + e * np.eye(columns)  # forward is blocked in the last row
    far[0] = 0
    z = np.linalg.solve(np.eye(columns) - far, np.eye(columns)[0])
    value = [np.log(z)]
    for _ in range(rows - 1):
        scale = z.max()
        z = np.linalg.solve(np.eye(columns) - sideways, e * z / scale)
        value.insert(0, np.log(z) + value[0].max())
    return np.array(value)


@pytest.mark.parametrize(("cost", "below", "detours"), [(3.0, -1100, 10), (1.15, -50, 300)])
def test_a_long_corridor_does_not_underflow(cost: float, below: float, detours: float) -> None:
    world = grid(3, 400, (1, 0), [("far left", (0, 399), 1.0)])
    value = soft_value(world.moves, world.goal_states[0], cost)
    expected = row_by_row(3, 400, cost)
    # exp(-3 * 400) is far below the smallest number, 5e-324. Near the smallest possible cost, ln 3,
    # all paths together weigh more than exp(300) times a shortest one.
    assert value[world.start] < below
    assert value[world.start] + 400 * cost > detours
    np.testing.assert_allclose(value.reshape(400, 3), expected, rtol=1e-12)
    policy = maximum_entropy_policy(world.moves, world.goal_states[0], cost)
    np.testing.assert_allclose(policy.sum(axis=1), 1.0, atol=1e-12)
    # In every row but the last one, forward leads to a state as good as its own but a step nearer.
    forward = np.exp(expected[1:] - expected[:-1] - cost)
    np.testing.assert_allclose(policy[:-3, 1].reshape(399, 3), forward, rtol=1e-9)


def test_a_goal_that_nothing_leads_to() -> None:
    moves = np.array([[0, 1], [1, 0], [2, 2]])
    assert soft_value(moves, 2, 3.0).tolist() == [-np.inf, -np.inf, 0.0]
    np.testing.assert_array_equal(maximum_entropy_policy(moves, 2, 3.0), 0.5)


@pytest.mark.parametrize("cost", [-1.0, 0.0])
def test_steps_may_be_free_where_paths_cannot_go_round(cost: float) -> None:
    # 0 leads to 1 and 1 to the goal 2; nothing leads from 3 and 4 to it.
    moves = np.array([[1], [2], [2], [4], [4]])
    with pytest.raises(ValueError, match="too small"):  # 4 may stay where it is forever
        soft_value(moves, 2, cost)
    found = soft_value(moves, 2, cost, [4])
    assert found.tolist() == [-2 * cost, -cost, 0.0, -np.inf, -np.inf]


@given(graphs(), st.integers(0, 2**32))
def test_uncertain_moves_and_costs_of_their_own(
    graph: tuple[IntArray, int, list[int]], seed: int
) -> None:
    # Ziebart et al. 2008, Eq. 4: Z(s) = sum_a exp(-c(s, a)) sum_s' P(s' | s, a) Z(s'), solved as
    # linear equations; the policy is the part of each action.
    _, goal, others = graph
    states, rng = len(graph[0]), np.random.default_rng(seed)
    moves, chances = random_outcomes(rng, states, 3)
    costs = rng.uniform(1.2, 4.0, size=(states, 3))
    policy = maximum_entropy_policy(moves, goal, costs, others, chances)
    system, ends = np.eye(states), [goal, *others]
    factor = np.exp(-costs)[:, :, None] * chances
    for s in range(states):
        for a, n in np.ndindex(moves.shape[1:]):
            if s not in ends:
                system[s, moves[s, a, n]] -= factor[s, a, n]
    z = np.linalg.solve(system, np.eye(states)[goal])
    for s in range(states):
        if s in ends or z[s] < 1e-12:
            continue
        part = (factor[s] * z[moves[s]]).sum(axis=1)
        np.testing.assert_allclose(policy[s], part / z[s], atol=1e-9)
    np.testing.assert_allclose(policy.sum(axis=1), 1.0, atol=1e-12)
    value = soft_value(moves, goal, costs, others, chances)
    np.testing.assert_allclose(np.exp(value[z > 1e-12]), z[z > 1e-12], rtol=1e-9)


def test_a_goal_region_is_as_good_anywhere() -> None:
    # 0 - 1 - 2 - 3 - 4 in a row, actions left and right; both ends are the goal.
    moves = np.array([[0, 1], [0, 2], [1, 3], [2, 4], [3, 4]])
    policy = maximum_entropy_policy(moves, [0, 4], 3.0)
    assert policy[2] == pytest.approx([0.5, 0.5])
    assert policy[1, 0] == pytest.approx(policy[3, 1])
    assert policy[1, 0] > 0.9


def test_an_equal_cost_for_all_is_that_cost() -> None:
    moves = np.array([[0, 1], [0, 2], [1, 2]])
    one = maximum_entropy_policy(moves, 2, 2.0)
    np.testing.assert_allclose(maximum_entropy_policy(moves, 2, np.full((3, 2), 2.0)), one)
    # A dear move is taken less often.
    dear = np.array([[2.0, 2.0], [3.0, 2.0], [2.0, 2.0]])
    assert maximum_entropy_policy(moves, 2, dear)[1, 0] < one[1, 0]


@pytest.mark.parametrize(
    ("costs", "message"),
    [
        (np.full((3, 1), 2.0), "have shape"),
        (np.zeros((3, 2)), "must be above 0"),
        (np.full((3, 2), 0.1), "too small"),
        (np.full((3, 2), np.nan), "finite"),
    ],
)
def test_bad_costs_are_refused(costs: FloatArray, message: str) -> None:
    moves = np.array([[0, 1], [0, 2], [1, 2]])
    with pytest.raises(ValueError, match=message):
        maximum_entropy_policy(moves, 2, costs)
