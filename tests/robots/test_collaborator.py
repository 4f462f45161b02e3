"""The robot that acts at the same time as the human."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import coadapt as ca
from coadapt import Collaboration
from coadapt.human.history import NO_WINDOW
from coadapt.momdp.policy import AlphaVectorPolicy
from coadapt.robots import Collaborator
from tests.formalism.joint_strategies import collaborations
from tests.momdp.strategies import random_rows

LEFT, RIGHT = 0, 1


def some_policy(model: Collaboration, rng: np.random.Generator) -> AlphaVectorPolicy:
    """Two random vectors in each observed state."""
    count = len(model.windows)
    hidden = model.modes.human_chance.shape[2]
    vectors = random_rows(rng, (2 * count, hidden), 0.3)
    actions = rng.integers(model.world.actions, size=2 * count)
    return AlphaVectorPolicy(2 * np.arange(count + 1), vectors, actions)


def insisting(model: Collaboration) -> Collaborator:
    """A robot that always pushes right."""
    count, hidden = len(model.windows), len(model.alpha.values)
    return Collaborator(
        model,
        AlphaVectorPolicy(
            np.arange(count + 1), np.zeros((count, hidden)), np.full(count, RIGHT, dtype=np.int64)
        ),
    )


@given(collaborations(), st.integers(0, 2**32))
def test_the_action_does_not_wait_for_the_human(model: Collaboration, seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = Collaborator(model, some_policy(model, rng))
    state, forecast = model.world.start, model.prior
    window = int(model.windows.beginning[state])
    for _ in range(5):
        if model.world.ends[state]:
            return
        planned = robot.plan(state)
        possible = np.flatnonzero(model.modal_policies[1][:, state].any(axis=0))
        human = int(rng.choice(possible))
        for other in map(int, possible):
            # An episode can be continued anywhere by its forecast and window.
            again = Collaborator(model, robot.policy)
            again.reset(forecast, window)
            assert again.act(state, other) == planned
        decision = robot.decide(state, human)
        assert decision.action == decision.planned == planned
        assert (decision.human_input, decision.asked, decision.matched) == (human, None, False)
        np.testing.assert_array_equal(robot.belief, decision.belief)
        assert decision.belief.sum() == pytest.approx(1.0)
        assert decision.forecast.sum() == pytest.approx(1.0)
        forecast = decision.forecast
        here, action, human_action = (np.array([i]) for i in (decision.window, planned, human))
        possible = model.after(here, action, human_action)[0]
        window = int(rng.choice(possible[possible != NO_WINDOW]))
        state = int(model.windows.state[window])


def test_a_person_who_insists_is_taken_for_stubborn() -> None:
    model = Collaboration(ca.worlds.hallway())
    robot = insisting(model)
    state, means = 0, list[float]()
    for _ in range(3):
        decision = robot.decide(state, LEFT)
        means.append(float(decision.adaptability_belief @ model.alpha.values))
        state = int(model.world.moves[state, decision.action, LEFT])
    # The belief is uniform, then proportional to 1 - alpha and (1 - alpha)^2.
    alpha = model.alpha.values
    expected = [(alpha * (1 - alpha) ** n).sum() / ((1 - alpha) ** n).sum() for n in range(3)]
    assert means == pytest.approx(expected, abs=1e-12)
    # The person sees the robot in the right mode, and is not in it.
    assert decision.agreement == pytest.approx(0.0, abs=1e-12)


def test_the_value_of_an_action_is_that_of_the_planning_problem() -> None:
    model = Collaboration(ca.worlds.hallway(), discount=0.9)
    solution = ca.SARSOP(gap=1e-6).solve(model.to_momdp())
    robot = Collaborator(model, solution.policy)
    decision = robot.decide(0, LEFT)
    # The first human action says nothing about alpha, so the belief is that before it.
    values = robot.action_values(decision)
    assert values.max() == pytest.approx(solution.lower, abs=1e-5)
    assert values.argmax() == decision.action


def test_what_cannot_be_is_refused() -> None:
    model = Collaboration(ca.worlds.table_carrying())
    robot = insisting(model)
    here = model.world.start
    for call in (robot.plan, lambda x: robot.act(x, LEFT)):
        with pytest.raises(ValueError, match="state 20 is not one of 0 to 13"):
            call(20)
        with pytest.raises(ValueError, match="the task has ended: orientation 0 is a goal"):
            call(0)
        with pytest.raises(ValueError, match="state 3 does not follow from the last action"):
            call(3)
    with pytest.raises(ValueError, match="input 2 is not one of 0 to 1"):
        robot.act(here, 2)
    with pytest.raises(ValueError, match="needs an action of the human in every step"):
        robot.act(here, None)
    robot.act(here, RIGHT)
    with pytest.raises(ValueError, match=f"state {here + 2} does not follow"):
        robot.plan(here + 2)
    assert robot.plan(here + 1) == RIGHT


def test_human_actions_of_no_mode_are_refused() -> None:
    # A third human action, in which they let go.
    table = ca.worlds.table_carrying()
    world = ca.worlds.JointWorld(
        name="table_carrying",
        moves=np.concatenate([table.moves, np.arange(14)[:, None, None].repeat(2, axis=1)], axis=2),
        goals=table.goals,
        starts=table.starts,
        state_names=table.state_names,
        action_names=table.action_names,
        human_action_names=("left", "right", "let go"),
        positions=table.positions,
    )
    with pytest.raises(ValueError, match="the human action let go belongs to no mode"):
        insisting(Collaboration(world)).act(world.start, 2)
