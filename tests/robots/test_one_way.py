"""The robot that adapts one way."""

from __future__ import annotations

import numpy as np
import pytest

from coadapt.robots import NEVER_MATCH, OneWayAdaptation
from tests.robots.worlds import DOWN, HIGH, LOW, MODEL, UP, B, C, always, towards_the_likelier


def test_it_takes_people_for_stubborn_and_goals_for_equal() -> None:
    robot = OneWayAdaptation(MODEL, towards_the_likelier(2), NEVER_MATCH)
    assert robot.model is MODEL
    assert robot.planning_model.alpha.values.tolist() == [0.0]
    # Sec. 6.1: equal reward to both goals; the larger one of 5 and 7.
    assert [goal.reward for goal in robot.planning_model.world.goals] == [7.0, 7.0]
    assert robot.belief.shape == (1, 2)


def test_its_belief_moves_with_inputs_alone() -> None:
    robot = OneWayAdaptation(MODEL, towards_the_likelier(2), NEVER_MATCH)
    first = robot.decide(B, DOWN)
    # 4/5 against 1/4, as in tests/robots/test_mutual.py.
    np.testing.assert_allclose(first.belief, [[16 / 21, 5 / 21]], atol=1e-15)
    np.testing.assert_allclose(first.forecast, first.belief, atol=1e-15)
    assert first.action == DOWN
    # In c, after two inputs up: 16 * 1/10 against 5 * 3/5.
    robot.reset(first.forecast)
    second = robot.decide(C, UP)
    np.testing.assert_allclose(second.belief, [[1.6 / 4.6, 3 / 4.6]], atol=1e-15)
    assert second.action == UP
    np.testing.assert_array_equal(robot.belief, second.belief)


def test_action_values_are_those_of_the_one_way_model() -> None:
    # With a policy worth nothing anywhere: C = -1 times the disagreement. The belief in low after
    # down in b is 16/21; down is seen as low with 16/21, up with 4/19.
    robot = OneWayAdaptation(MODEL, always(UP, UP, UP, UP, hidden=2))
    low, high = 16 / 21, 5 / 21
    expected = [-(low * 5 / 21 + high * 16 / 21), -(low * 15 / 19 + high * 4 / 19)]
    found = robot.action_values(robot.decide(B, DOWN))
    np.testing.assert_allclose(found, expected, atol=1e-14)
    assert robot.policy.actions.tolist() == [UP] * 4


@pytest.mark.parametrize("mode", [LOW, HIGH])
def test_it_follows_a_clear_wish(mode: int) -> None:
    robot = OneWayAdaptation(MODEL, towards_the_likelier(2), NEVER_MATCH)
    wish = (DOWN, UP)[mode]
    assert [robot.act(C, wish) for _ in range(3)] == [wish] * 3
