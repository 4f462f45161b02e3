"""The cost that explains demonstrated paths best."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from coadapt.arrays import FloatArray, IntArray
from coadapt.human import maximum_entropy_policy
from coadapt.human.demonstrations import fit_cost, fit_step_cost
from coadapt.human.path_likelihood import Demonstration, PathLikelihood
from coadapt.worlds import grid
from coadapt.worlds.grid import FOUR_WAYS
from tests.human.test_modal import graphs, paths

WORLD = grid(
    7,
    5,
    (3, 0),
    [("left", (0, 4), 1.0), ("right", (6, 4), 1.0)],
    actions=FOUR_WAYS,
    obstacles=[(3, 2)],
)
MOVES, START = WORLD.moves, WORLD.start
LEFT, RIGHT = WORLD.goal_states
GOALS = ((LEFT,), (RIGHT,))


def features() -> FloatArray:
    """1, whether the move is blocked, whether it ends in the middle column."""
    middle = WORLD.positions[MOVES][:, :, 0] == 3
    blocked = np.arange(len(MOVES))[:, None] == MOVES
    return np.stack([np.ones(MOVES.shape), blocked, middle], axis=-1)


def sample(
    cost: float | FloatArray, goal: int, count: int, rng: np.random.Generator
) -> list[Demonstration]:
    """Paths drawn from the maximum-entropy policy, step by step."""
    others = [s for g, states in enumerate(GOALS) if g != goal for s in states]
    policy = maximum_entropy_policy(MOVES, GOALS[goal], cost, others)
    drawn: list[Demonstration] = []
    for _ in range(count):
        state, steps = START, list[tuple[int, int]]()
        while state not in GOALS[goal]:
            action = int(rng.choice(MOVES.shape[1], p=policy[state]))
            steps.append((state, action))
            state = int(MOVES[state, action])
        drawn.append(Demonstration(goal, steps))
    return drawn


@given(graphs(states=4), st.integers(1, 2), st.integers(0, 2**32))
def test_the_likelihood_is_a_sum_over_paths(
    graph: tuple[IntArray, int, list[int]], count: int, seed: int
) -> None:
    # Paths of up to 6 steps, each of cost 4 or more: what is longer weighs less than
    # sum_{n > 6} (3 exp(-4))^n < 2e-9, with features of at most 1 a step.
    moves, goal, others = graph
    rng = np.random.default_rng(seed)
    sources = [s for s in range(len(moves)) if s not in (goal, *others)]
    assume(sources)
    start = int(rng.choice(sources))
    found = paths(moves, start, goal, others, 6)
    assume(found)
    weights = rng.uniform(4, 6, size=count)
    f = rng.random((*moves.shape, count))
    f[:, :, 0] = 1.0
    f[0, 0] = 1.0  # of size 1 at most, as the scaling wants it
    along = [Demonstration.along(moves, start, path, 0) for path in found]
    sums = np.array([sum(f[step] for step in path.steps) for path in along])
    weight = np.exp(-sums @ weights)
    chance = weight / weight.sum()
    chosen = int(rng.integers(len(found)))
    point = PathLikelihood.of(
        moves, [[goal], *([other] for other in others)], [along[chosen], along[0]], f
    ).at(weights)
    assert point is not None
    mean = chance @ sums
    spread = (sums - mean).T @ np.diag(chance) @ (sums - mean)
    shortest = weight.max()
    tolerance = 1e-6 / shortest * 1e-2  # what is missing, relative to what is there
    assume(tolerance < 1e-3)
    expected = np.log(chance[chosen]) + np.log(chance[0])
    assert point.log_likelihood == pytest.approx(expected, abs=tolerance)
    np.testing.assert_allclose(
        point.gradient, 2 * mean - sums[chosen] - sums[0], atol=100 * tolerance
    )
    np.testing.assert_allclose(point.information, 2 * spread, atol=1000 * tolerance)


def test_the_derivatives_are_those_of_finite_differences() -> None:
    rng = np.random.default_rng(0)
    drawn = sample(2.0, 0, 5, rng) + sample(2.0, 1, 3, rng)
    likelihood = PathLikelihood.of(MOVES, GOALS, drawn, features())
    weights, h = np.array([2.0, 0.3, 0.7]), 1e-5
    here = likelihood.at(weights)
    assert here is not None
    for k, unit in enumerate(np.eye(3)):
        above, below = likelihood.at(weights + h * unit), likelihood.at(weights - h * unit)
        assert above is not None
        assert below is not None
        slope = (above.log_likelihood - below.log_likelihood) / (2 * h)
        assert slope == pytest.approx(here.gradient[k], rel=1e-6)
        curvature = (below.gradient - above.gradient) / (2 * h)
        np.testing.assert_allclose(curvature, here.information[k], rtol=1e-6)


@pytest.mark.parametrize("cost", [1.5, 2.0, 3.0])
def test_a_step_cost_is_recovered(cost: float) -> None:
    rng = np.random.default_rng(1)
    fit = fit_step_cost(MOVES, GOALS, sample(cost, 0, 200, rng) + sample(cost, 1, 100, rng))
    assert fit.demonstrations == 300
    assert abs(fit.weights[0] - cost) < 3 * fit.standard_errors[0]
    assert fit.standard_errors[0] < 0.1
    # At the maximum the gradient is 0: as many steps as expected.
    np.testing.assert_allclose(fit.expected, fit.observed, rtol=1e-5)


def test_feature_weights_are_recovered() -> None:
    rng, true = np.random.default_rng(2), np.array([1.8, 0.5, 1.0])
    f = features()
    drawn = sample(f @ true, 0, 300, rng) + sample(f @ true, 1, 300, rng)
    fit = fit_cost(MOVES, GOALS, drawn, f)
    assert np.all(np.abs(fit.weights - true) < 3 * fit.standard_errors)
    np.testing.assert_allclose(fit.step_costs(f), f @ fit.weights)
    np.testing.assert_allclose(fit.expected, fit.observed, rtol=1e-5)
    # Other units of a feature are other units of its weight, and nothing else.
    scaled = fit_cost(MOVES, GOALS, drawn, f * [1.0, 10.0, 0.1])
    np.testing.assert_allclose(scaled.weights * [1.0, 10.0, 0.1], fit.weights, rtol=1e-5)
    np.testing.assert_allclose(
        scaled.standard_errors * [1.0, 10.0, 0.1], fit.standard_errors, rtol=1e-5
    )
    assert scaled.log_likelihood == pytest.approx(fit.log_likelihood)


def test_standard_errors_are_the_spread_of_the_estimates() -> None:
    rng = np.random.default_rng(3)
    fits = [fit_step_cost(MOVES, GOALS, sample(2.0, 0, 40, rng)) for _ in range(60)]
    scores = [(fit.weights[0] - 2.0) / fit.standard_errors[0] for fit in fits]
    # 60 standard normal numbers: the mean has a spread of 0.13, the standard deviation of 0.09.
    assert abs(np.mean(scores)) < 4 * 0.13
    assert abs(np.std(scores) - 1) < 4 * 0.09


def test_a_weight_that_would_be_negative_is_zero() -> None:
    rng, f = np.random.default_rng(4), features()
    drawn = sample(f @ np.array([2.0, 0.4, -0.3]), 0, 300, rng)
    fit = fit_cost(MOVES, GOALS, drawn, f)
    assert fit.weights[2] == 0
    assert np.isnan(fit.standard_errors[2])
    assert np.all(fit.standard_errors[:2] > 0)
    # The likelihood would rise below 0: fewer steps in the middle are expected than were seen.
    assert fit.expected[2] < fit.observed[2]


def test_a_goal_may_be_a_region() -> None:
    goals = ((LEFT, LEFT + 1), (RIGHT,))
    one_left = Demonstration.along(MOVES, START, [0, 0, 1, 1, 1, 1], 0)
    detour = Demonstration.along(MOVES, START, [3, *SHORT], 0)
    fit = fit_step_cost(MOVES, goals, [one_left, detour])
    assert fit.observed == [6 + 8]
    np.testing.assert_allclose(fit.expected, fit.observed, rtol=1e-4)
    # To the corner alone the first is no path.
    with pytest.raises(ValueError, match=f"ends in state {LEFT + 1}, expected"):
        fit_step_cost(MOVES, GOALS, [one_left, detour])


SHORT = [0] * 3 + [1] * 4


@pytest.mark.parametrize(
    ("demonstrations", "message"),
    [
        ([], "no demonstrations"),
        ([Demonstration(2, [(START, 0)])], "demonstration 0 has goal 2, expected 0 to 1"),
        ([Demonstration(0, [])], "demonstration 0 has no steps"),
        ([Demonstration(0, [(START, 4)])], "step 0: found state 3 and action 4, expected"),
        ([Demonstration(0, [(-1, 0)])], "step 0: found state -1"),
        ([Demonstration(0, [(3, 0), (3, 0)])], "step 1: found state 3, expected 2, to which"),
        ([Demonstration.along(MOVES, START, [0, 0], 0)], f"ends in state 1, expected .*: {LEFT}"),
        ([Demonstration.along(MOVES, START, SHORT, 1)], f"ends in state {LEFT}, expected"),
        ([Demonstration.along(MOVES, START, [*SHORT, 0], 0)], f"step 7: state {LEFT} is a goal"),
        ([Demonstration.along(MOVES, START, SHORT, 0)] * 9, "no likeliest cost.*add paths"),
    ],
)
def test_what_is_no_demonstration(demonstrations: list[Demonstration], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fit_step_cost(MOVES, GOALS, demonstrations)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda f: f[:, :, 0], "features have shape"),
        (lambda f: f[:, :, :0], "features have shape"),
        (lambda f: f * np.nan, "finite"),
        (lambda f: f * [1, 0, 1], "feature 1 is 0 everywhere"),
        (lambda f: f[:, :, [0, 0]], "cannot tell the features apart"),
        (lambda f: -f, "no weights for which"),
    ],
)
def test_what_is_no_feature(change: Any, message: str) -> None:
    drawn = sample(2.0, 0, 20, np.random.default_rng(5))
    with pytest.raises(ValueError, match=message):
        fit_cost(MOVES, GOALS, drawn, change(features()))


def test_paths_longer_than_any_cost_explains() -> None:
    # From 0 to 2 at once or by 1, where two actions lead on: P(this path by 1) = 1 / (exp(c) + 2)
    # is largest at a cost of 0.
    moves = np.array([[2, 1], [2, 2], [2, 2]])
    by_1 = Demonstration.along(moves, 0, [1, 0], 0)
    with pytest.raises(ValueError, match="longer than any cost"):
        fit_step_cost(moves, [[2]], [by_1])
    # With one path of each kind P(by 1) = 2 / (exp(c) + 2) must be 1/2: c = ln 2.
    at_once = Demonstration.along(moves, 0, [0], 0)
    assert fit_step_cost(moves, [[2]], [by_1, at_once]).weights[0] == pytest.approx(np.log(2))


def test_uncertain_moves_are_refused() -> None:
    with pytest.raises(ValueError, match="every move has one outcome"):
        fit_cost(MOVES[:, :, None], GOALS, [], features())
