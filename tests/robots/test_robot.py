"""What all robots have in common."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import coadapt as ca
from coadapt.human.history import NO_ACTION
from coadapt.robots import (
    NO_INPUT,
    Decision,
    MatchRule,
    MutualAdaptation,
    NoAdaptation,
    OneWayAdaptation,
    Robot,
)
from coadapt.robots.decide import DecisionsInTurn
from coadapt.robots.tables import TabledRobot
from tests.momdp.problems import known_hidden_policy
from tests.momdp.strategies import random_rows

TABLE = ca.SharedAutonomy(ca.worlds.table_clearing(5, 3))
THREE = replace(TABLE, memory=3)
POLICY = known_hidden_policy(TABLE.to_momdp())
ONE_WAY_POLICY = known_hidden_policy(TABLE.one_way().to_momdp())
THREE_POLICY = known_hidden_policy(THREE.to_momdp(), sweeps=60)
THREE_ONE_WAY_POLICY = known_hidden_policy(THREE.one_way().to_momdp(), sweeps=60)

ROBOTS: list[Callable[[], Robot]] = [
    lambda: NoAdaptation(TABLE),
    lambda: MutualAdaptation(TABLE, POLICY, MatchRule(0.8)),
    lambda: OneWayAdaptation(TABLE, ONE_WAY_POLICY, MatchRule(0.8)),
    lambda: NoAdaptation(THREE),
    lambda: MutualAdaptation(THREE, THREE_POLICY, MatchRule(0.8)),
    lambda: OneWayAdaptation(THREE, THREE_ONE_WAY_POLICY, MatchRule(0.8)),
]
IDS = [f"{name}-{memory}" for memory in (1, 3) for name in ("no", "mutual", "one-way")]
robots = pytest.mark.parametrize("make", ROBOTS, ids=IDS)


def run(robot: Robot, inputs: list[int | None]) -> list[Decision]:
    """The decisions from the start, until a goal."""
    world, state = robot.model.world, robot.model.world.start
    decisions: list[Decision] = []
    for human_input in inputs:
        if state in world.goal_states:
            break
        decisions.append(robot.decide(state, human_input))
        state = int(world.moves[state, decisions[-1].action])
    return decisions


def equal(one: Decision, other: Decision) -> bool:
    return (
        (
            one.window,
            one.state,
            one.human_input,
            one.action,
            one.planned,
            one.agreement,
            one.matched,
        )
        == (
            other.window,
            other.state,
            other.human_input,
            other.action,
            other.planned,
            other.agreement,
            other.matched,
        )
        and np.array_equal(one.belief, other.belief)
        and np.array_equal(one.forecast, other.forecast)
    )


INPUTS: list[int | None] = [1, 0, None, 0, 1, 0, 0, 2, 0]


@robots
def test_names_and_models(make: Callable[[], Robot]) -> None:
    robot = make()
    assert robot.model is TABLE or robot.model is THREE
    assert robot.planning_model.world.states == TABLE.world.states
    assert (
        robot.name
        == {
            NoAdaptation: "no_adaptation",
            MutualAdaptation: "mutual_adaptation",
            OneWayAdaptation: "one_way_adaptation",
        }[type(robot)]
    )


@robots
def test_an_episode_begins_with_the_prior(make: Callable[[], Robot]) -> None:
    robot = make()
    prior = robot.planning_model.prior
    np.testing.assert_array_equal(robot.belief, prior)
    run(robot, INPUTS)
    robot.reset()
    np.testing.assert_array_equal(robot.belief, prior)
    other = np.full_like(prior, 1 / prior.size)
    robot.reset(other)
    np.testing.assert_array_equal(robot.belief, other)


@robots
def test_episodes_do_not_depend_on_each_other(make: Callable[[], Robot]) -> None:
    robot = make()
    first = run(robot, INPUTS)
    robot.reset()
    second = run(robot, INPUTS)
    assert len(first) >= 4
    assert all(map(equal, first, second))
    assert all(map(equal, first, run(make(), INPUTS)))


@robots
def test_act_is_the_action_of_decide(make: Callable[[], Robot]) -> None:
    one, other = make(), make()
    for decision in run(one, INPUTS):
        assert other.act(decision.state, decision.human_input) == decision.action


@robots
@given(inputs=st.lists(st.sampled_from([None, 0, 1, 2]), max_size=12))
def test_decisions_in_turn_are_those_of_decide(
    make: Callable[[], Robot], inputs: list[int | None]
) -> None:
    robot = make()
    decisions = run(robot, inputs)
    assert isinstance(robot, TabledRobot)
    robot.reset()
    in_turn = DecisionsInTurn(robot.tables, robot.belief)
    for decision in decisions:
        given_input = NO_INPUT if decision.human_input is None else decision.human_input
        planned, asked, action, agreement, matched = in_turn.decide(decision.window, given_input)
        assert (planned, action, agreement, matched) == (
            decision.planned,
            decision.action,
            decision.agreement,
            decision.matched,
        )
        assert asked == (NO_ACTION if decision.asked is None else decision.asked)
        assert in_turn.belief.tobytes() == decision.belief.tobytes()  # to the bit
        assert in_turn.forecast.tobytes() == decision.forecast.tobytes()


@robots
def test_the_belief_is_that_of_the_last_decision(make: Callable[[], Robot]) -> None:
    robot = make()
    for decision in run(make(), INPUTS):
        robot.decide(decision.state, decision.human_input)
        np.testing.assert_array_equal(robot.belief, decision.belief)
        np.testing.assert_allclose(decision.belief.sum(), 1.0, atol=1e-12)
        np.testing.assert_allclose(decision.forecast.sum(), 1.0, atol=1e-12)
        np.testing.assert_allclose(decision.mode_belief, decision.belief.sum(axis=0))
        np.testing.assert_allclose(decision.adaptability_belief, decision.belief.sum(axis=1))


@robots
def test_an_episode_goes_on_anywhere_from_the_forecast(make: Callable[[], Robot]) -> None:
    decisions = run(make(), INPUTS)
    for i in range(1, len(decisions)):
        robot = make()
        robot.reset(decisions[i - 1].forecast, decisions[i].window)
        again = [robot.decide(d.state, d.human_input) for d in decisions[i:]]
        assert all(map(equal, decisions[i:], again))


@robots
@given(seed=st.integers(0, 2**32))
def test_many_decisions_are_those_one_by_one(make: Callable[[], Robot], seed: int) -> None:
    robot, rng, n = make(), np.random.default_rng(seed), 8
    world, shape = robot.model.world, robot.planning_model.prior.shape
    end = robot.model.windows.state
    free = [w for w in range(len(end)) if end[w] not in world.goal_states]
    windows = rng.choice(free, size=n)
    inputs = rng.integers(NO_INPUT, world.actions, size=n)
    beliefs = random_rows(rng, (n, shape[0] * shape[1]), 0.4).reshape(n, *shape)
    decisions = robot.decide_many(windows, inputs, beliefs)
    assert len(decisions) == n
    for i in range(n):
        robot.reset(beliefs[i], int(windows[i]))
        human_input = None if inputs[i] == NO_INPUT else int(inputs[i])
        alone = robot.decide(int(end[windows[i]]), human_input)
        assert (alone.state, alone.human_input) == (end[windows[i]], human_input)
        assert equal(decisions[i], alone)


@robots
@pytest.mark.parametrize(
    ("state", "human_input", "message"),
    [
        (-1, 0, "state -1 is not one of 0 to 14"),
        (15, 0, "state 15 is not one of 0 to 14"),
        (10, 0, "the task has ended: column 0 row 2 is a goal"),
        (2, -1, "input -1 is not one of 0 to 2"),
        (2, 3, "input 3 is not one of 0 to 2"),
    ],
)
def test_bad_situations_are_refused(
    make: Callable[[], Robot], state: int, human_input: int, message: str
) -> None:
    robot = make()
    with pytest.raises(ValueError, match=message):
        robot.act(state, human_input)
    # And leave no trace.
    np.testing.assert_array_equal(robot.belief, robot.planning_model.prior)
    assert equal(robot.decide(2, 0), make().decide(2, 0))


@robots
def test_action_values_have_one_entry_for_each_action(make: Callable[[], Robot]) -> None:
    robot = make()
    decision = robot.decide(TABLE.world.start, 1)
    assert robot.action_values(decision).shape == (3,)


def test_the_window_slides_with_the_executed_actions() -> None:
    robot = MutualAdaptation(THREE, THREE_POLICY, MatchRule(0.8))
    decisions = run(robot, INPUTS)
    assert len(decisions) > 3
    for i, decision in enumerate(decisions):
        taken = [d.action for d in decisions[max(0, i - 2) : i]]
        kept = THREE.windows.actions[decision.window]
        assert kept[kept >= 0].tolist() == taken
        assert THREE.windows.first[decision.window] == decisions[max(0, i - 2)].state


def test_with_several_steps_a_state_must_follow_from_the_last_action() -> None:
    robot = MutualAdaptation(THREE, THREE_POLICY)
    with pytest.raises(ValueError, match="state 7 does not follow from the last action"):
        robot.act(7, 0)
    start = THREE.world.start
    first = robot.decide(start, 0)
    # Put back to the start: the person's memory begins anew, the robot's belief goes on.
    again = robot.decide(start, 0)
    assert again.window == first.window
    assert not np.array_equal(again.belief, first.belief)
