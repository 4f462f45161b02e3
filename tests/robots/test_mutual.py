"""The mutually adaptive robot: one time step by hand, and its limits."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import coadapt as ca
from coadapt import SharedAutonomy, SimulatedPartner, evaluate
from coadapt.momdp import AlphaVectorPolicy
from coadapt.momdp.sarsop import SARSOP
from coadapt.robots import NEVER_MATCH, MatchRule, MutualAdaptation, OneWayAdaptation
from tests.robots.worlds import DOWN, MODEL, UP, B, C, always, towards_the_likelier

# Beliefs are [alpha, mode] with alpha 0 and 1, modes low and high, at first 1/4 each.
# Down in b has probability 4/5 in low and 1/4 in high, that is 16 : 5.
AFTER_DOWN = np.array([[16, 5], [16, 5]]) / 42


def test_the_events_of_one_step_come_in_order() -> None:
    robot = MutualAdaptation(MODEL, always(UP, UP, UP, UP), NEVER_MATCH)
    first = robot.decide(B, DOWN)
    # The input corrects the belief before the robot decides.
    np.testing.assert_allclose(first.belief, AFTER_DOWN, atol=1e-15)
    # Up in b has probability 1/5 in low and 3/4 in high: the person perceives 4 : 15.
    assert first.agreement == pytest.approx(16 / 21 * 4 / 19 + 5 / 21 * 15 / 19)
    assert (first.planned, first.action, first.matched) == (UP, UP, False)
    # Then the action moves the mode: not at all for alpha = 0, to what is perceived for alpha = 1.
    forecast = np.array([[16 / 42, 5 / 42], [2 / 19, 7.5 / 19]])
    np.testing.assert_allclose(first.forecast, forecast, atol=1e-15)
    # The world moved to c. Up there has probability 1/10 in low and 3/5 in high.
    second = robot.decide(C, UP)
    mass = forecast * [0.1, 0.6]
    np.testing.assert_allclose(second.belief, mass / mass.sum(), atol=1e-15)
    np.testing.assert_array_equal(robot.belief, second.belief)


def test_the_decision_follows_the_corrected_belief() -> None:
    # The prior is even; only the input tells which mode is the likelier.
    for human_input in (DOWN, UP):
        robot = MutualAdaptation(MODEL, towards_the_likelier(), NEVER_MATCH)
        assert robot.act(B, human_input) == human_input


def test_without_an_input_the_belief_is_only_predicted() -> None:
    robot = MutualAdaptation(MODEL, always(UP, UP, UP, UP))
    decision = robot.decide(B, None)
    np.testing.assert_array_equal(decision.belief, MODEL.prior)
    np.testing.assert_allclose(decision.forecast, [[1 / 4, 1 / 4], [2 / 19, 7.5 / 19]], atol=1e-15)
    assert (decision.action, decision.matched) == (UP, False)


def test_a_match_executes_the_input_and_predicts_with_it() -> None:
    agreement = 16 / 21 * 4 / 19 + 5 / 21 * 15 / 19  # 0.348, see above
    robot = MutualAdaptation(MODEL, always(UP, UP, UP, UP), MatchRule(0.34))
    decision = robot.decide(B, DOWN)
    assert decision.agreement == pytest.approx(agreement)  # of the planned action
    assert (decision.planned, decision.action, decision.matched) == (UP, DOWN, True)
    # The person sees down, 16 : 5, not up.
    np.testing.assert_allclose(
        decision.forecast, [[16 / 42, 5 / 42], [16 / 42, 5 / 42]], atol=1e-15
    )
    # Just above that agreement the plan is executed, and without an input there is no match.
    assert MutualAdaptation(MODEL, always(UP, UP, UP, UP), MatchRule(0.35)).act(B, DOWN) == UP
    assert MutualAdaptation(MODEL, always(UP, UP, UP, UP), MatchRule(0.0)).act(B, None) == UP


def test_action_values_look_one_step_ahead() -> None:
    # With a policy worth nothing anywhere what remains is the reward of the step, C = -1 times the
    # disagreement: down is seen as low with 16/21, up as low with 4/19.
    robot = MutualAdaptation(MODEL, always(UP, UP, UP, UP))
    decision = robot.decide(B, DOWN)
    low, high = AFTER_DOWN.sum(axis=0)
    expected = [-(low * 5 / 21 + high * 16 / 21), -(low * 15 / 19 + high * 4 / 19)]
    np.testing.assert_allclose(robot.action_values(decision), expected, atol=1e-14)


@cache
def solved(
    alpha: tuple[float, ...] = (0.0, 0.25, 0.5, 0.75, 1.0), cost: float = -0.32, left: float = 10.0
) -> tuple[SharedAutonomy, AlphaVectorPolicy]:
    model = SharedAutonomy(
        ca.worlds.table_clearing(left_reward=left), adaptability=alpha, disagreement_cost=cost
    )
    return model, SARSOP(gap=1e-3).solve(model.to_momdp()).policy


@pytest.mark.parametrize(("alpha", "cost"), [((1.0,), -0.32), ((0.0, 0.5, 1.0), 0.0)])
def test_without_doubt_or_penalty_it_always_goes_to_the_optimal_goal(
    alpha: tuple[float, ...], cost: float
) -> None:
    # Sec. 7: "If we fix adaptability to 1 in the model (or we remove the penalty for mode
    # disagreement), the robot will always go to the optimal goal." With the policy alone: the
    # match rule would follow a wrong input now and then.
    robot = MutualAdaptation(*solved(alpha, cost), NEVER_MATCH)
    for partner in (SimulatedPartner(0.0, mode=0), SimulatedPartner(0.75, mode=0)):
        found = evaluate(robot, partner)
        assert found.goal_probability[0] <= 1e-12
        assert found.goal_probability[1] >= 1 - 1e-3


def test_the_paper_as_it_stands_complies_with_the_stubborn_and_guides_the_adaptable() -> None:
    robot = MutualAdaptation(*solved())
    rewards = [evaluate(robot, SimulatedPartner(alpha, mode=0)).reward for alpha in (0.0, 0.5, 1.0)]
    # Sec. 5.4: for alpha = 0 a little above R_sub = 10, and the more adaptable the better.
    assert 10.0 < rewards[0] < 10.4
    assert rewards[0] < rewards[1] < rewards[2] <= 11.0
    # To someone who steers left it first answers forward, which commits to nothing (Fig. 4).
    robot.reset()
    assert robot.act(robot.model.world.start, 0) == 1


def test_with_a_stubborn_person_and_equal_goals_it_is_the_one_way_robot() -> None:
    # Sec. 7: "If we fix in the model the human adaptability to 0 and assign equal costs for both
    # goals, the robot would assist the user in their goal (One-way adaptation)."
    stubborn, policy = solved((0.0,), -0.32, 11.0)
    base, _ = solved()
    one_way_policy = SARSOP(gap=1e-3).solve(base.one_way().to_momdp()).policy
    mutual, one_way = MutualAdaptation(stubborn, policy), OneWayAdaptation(base, one_way_policy)
    rng = np.random.default_rng(5)
    for _ in range(20):
        mutual.reset()
        one_way.reset()
        state = base.world.start
        while state not in base.world.goal_states:
            human_input = int(rng.integers(3))
            one, other = mutual.decide(state, human_input), one_way.decide(state, human_input)
            assert (one.action, one.matched) == (other.action, other.matched)
            np.testing.assert_array_equal(one.belief, other.belief)
            state = int(base.world.moves[state, one.action])
    # And it does assist: the stubborn get what they want.
    for mode in range(2):
        found = evaluate(one_way, SimulatedPartner(0.0, mode=mode))
        assert found.goal_probability[mode] > 0.9


def test_the_model_is_left_alone() -> None:
    model = replace(MODEL)
    robot = MutualAdaptation(model, always(UP, UP, UP, UP))
    robot.decide(B, DOWN)
    np.testing.assert_array_equal(model.prior, np.full((2, 2), 0.25))
