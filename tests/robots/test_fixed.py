"""The robot that does not adapt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from coadapt import SharedAutonomy
from coadapt.robots import NoAdaptation
from coadapt.worlds import Goal
from tests.formalism.strategies import models
from tests.robots.worlds import HIGH, LOW, MODEL, ROW, A, B, C, D
from tests.worlds.test_world import steps_forward


@given(models())
def test_it_takes_a_shortest_path_to_the_best_goal(model: SharedAutonomy) -> None:
    world = model.world
    best = max(range(len(world.goals)), key=lambda g: world.goals[g].reward)
    length = steps_forward(world, world.start, best)
    if length < 0:
        with pytest.raises(ValueError, match="cannot be reached"):
            NoAdaptation(model)
        return
    robot, state, steps = NoAdaptation(model), world.start, 0
    while state not in world.goal_states:
        # The first of the actions that come one step nearer; inputs are not looked at.
        nearer = [
            a
            for a, n in enumerate(world.moves[state].tolist())
            if steps_forward(world, n, best) == length - steps - 1
        ]
        assert robot.act(state, steps % world.actions) == nearer[0]
        state, steps = int(world.moves[state, nearer[0]]), steps + 1
    assert (state, steps) == (world.goals[best].at, length)


def test_a_discount_of_zero_changes_nothing() -> None:
    robot = NoAdaptation(replace(MODEL, discount=0.0))
    assert [robot.act(state, 0) for state in (B, C)] == [1, 1]


@pytest.mark.parametrize("reward", [0.0, -1.0])
def test_a_best_reward_that_is_not_positive_changes_nothing(reward: float) -> None:
    goals = (Goal("low", A, reward - 1), Goal("high", D, reward))
    robot = NoAdaptation(replace(MODEL, world=replace(ROW, goals=goals)))
    assert [robot.act(state, 0) for state in (B, C)] == [1, 1]


def test_what_it_believes_does_not_move() -> None:
    robot = NoAdaptation(MODEL)
    decision = robot.decide(B, 0)
    np.testing.assert_array_equal(decision.belief, MODEL.prior)
    np.testing.assert_array_equal(decision.forecast, MODEL.prior)
    # Low and high are as likely as each other: half of 0.2 / 0.95 + 0.75 / 0.95.
    assert decision.agreement == pytest.approx(0.5)
    assert (decision.planned, decision.action, decision.matched) == (1, 1, False)


def test_action_values_are_discounted_rewards_of_the_best_goal() -> None:
    robot = NoAdaptation(MODEL)
    # From c: up reaches 7 in one move, down and back takes three. Discount 1/2.
    np.testing.assert_allclose(robot.action_values(robot.decide(C, None)), [7 / 8, 7 / 2])
    # From b down leads to the other goal, where the task is over.
    np.testing.assert_allclose(robot.action_values(robot.decide(B, None)), [-np.inf, 7 / 4])


def test_a_goal_out_of_reach_is_refused() -> None:
    goals = (ROW.goals[LOW], replace(ROW.goals[HIGH]))
    cut = replace(ROW, moves=np.array([[A, B], [A, C], [B, B], [C, D]]), goals=goals)
    with pytest.raises(ValueError, match="the optimal goal, high, cannot be reached"):
        NoAdaptation(replace(MODEL, world=cut))
