"""The compiled planning problem against a slow construction from the equations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import coadapt as ca
from coadapt import SharedAutonomy
from coadapt.arrays import FloatArray
from coadapt.human import Adaptability
from coadapt.momdp import belief
from coadapt.momdp.check import MOMDPWarning, check_momdp
from tests.formalism.strategies import models
from tests.momdp.problems import joint, observations
from tests.momdp.strategies import random_rows

TABLE = ca.worlds.table_clearing()


def policies_by_linear_equations(model: SharedAutonomy) -> FloatArray:
    """``[M, X, A]`` maximum-entropy policies from ``z = exp(-c) sum_a z(T(x, a))``, z(goal) = 1."""
    world, e = model.world, np.exp(-model.step_cost)
    policies = np.full((len(world.goals), *world.moves.shape), 1 / world.actions)
    for g, goal in enumerate(world.goal_states):
        system = np.eye(world.states)
        for x, a in np.ndindex(world.moves.shape):
            if x not in world.goal_states:
                system[x, world.moves[x, a]] -= e
        z = np.linalg.solve(system, np.eye(world.states)[goal])
        for x in range(world.states):
            if x not in world.goal_states and world.distance(g)[x] >= 0:
                policies[g, x] = e * z[world.moves[x]] / z[x]
    return policies


def perceived_slowly(policies: FloatArray, x: int, a: int) -> FloatArray:
    """Eq. 2 for k = 1: ``P(m_r | x, a_r)`` is proportional to ``m_r(x, a_r)``."""
    weights = np.array([policies[m, x, a] for m in range(len(policies))])
    return weights / weights.sum() if weights.any() else np.full(len(weights), 1 / len(weights))


@given(models())
def test_the_problem_is_that_of_the_equations(model: SharedAutonomy) -> None:
    problem = model.to_momdp()
    world, alpha = model.world, model.adaptability
    assert isinstance(alpha, Adaptability)
    policies = policies_by_linear_equations(model) if model.policies is None else model.policies
    levels, modes = len(alpha.values), len(world.goals)
    hidden = [(i, m) for i in range(levels) for m in range(modes)]
    assert problem.shape == (world.states, len(hidden), world.actions, world.actions)
    moves, sees = joint(problem), observations(problem)
    for x, a in np.ndindex(world.moves.shape):
        expected = np.zeros((len(hidden), world.states, len(hidden)))
        perceived = perceived_slowly(policies, x, a)
        for y, (i, m) in enumerate(hidden):
            reward = 0.0
            for m_r in range(modes):
                reward += perceived[m_r] * (model.disagreement_cost if m_r != m else 0)  # Eq. 7-8
            if x in world.goal_states:
                reward = world.goals[world.goal_states.index(x)].reward  # Eq. 6
            np.testing.assert_allclose(problem.reward[x, a, y], reward, atol=1e-9)
            for v, (j, m_next) in enumerate(hidden):
                t_mh = sum(  # Eq. 3 with Eq. 4
                    perceived[m_r]
                    * (alpha.values[i] * (m_next == m_r) + (1 - alpha.values[i]) * (m_next == m))
                    for m_r in range(modes)
                )
                # T_x is deterministic; the task ends at a goal.
                if x not in world.goal_states:
                    expected[y, world.moves[x, a], v] = alpha.transition[i, j] * t_mh
        np.testing.assert_allclose(moves[x, a], expected, atol=1e-9)
        # O(a_h | m', x'): the human half of the modal policy, whatever alpha and a_r.
        for v, (_, m_next) in enumerate(hidden):
            np.testing.assert_allclose(sees[a, x, v], policies[m_next, x], atol=1e-9)
    assert problem.discount == model.discount


@given(models())
def test_the_roots_are_the_prior_after_each_first_input(model: SharedAutonomy) -> None:
    problem = model.to_momdp()
    alpha = model.adaptability
    assert isinstance(alpha, Adaptability)
    assert model.mode_prior is not None
    found = {root.label: root for root in problem.roots}
    for human_input, name in enumerate(model.world.action_names):
        # Step 1 and 2 of a time step: the input is drawn from the mode, the belief conditioned.
        mass = np.array(
            [
                p_alpha * p_mode * model.modal_policies[m, model.world.start, human_input]
                for p_alpha in alpha.prior
                for m, p_mode in enumerate(model.mode_prior)
            ]
        )
        if mass.sum() == 0:
            assert name not in found
            continue
        root = found.pop(name)
        assert root.x == model.world.start
        assert root.probability == pytest.approx(mass.sum(), abs=1e-12)
        np.testing.assert_allclose(root.belief, mass / mass.sum(), atol=1e-12)
    assert not found


@given(models(), st.integers(0, 2**32))
def test_the_planner_and_the_filter_hold_the_same_belief(model: SharedAutonomy, seed: int) -> None:
    problem = model.to_momdp()
    rng = np.random.default_rng(seed)
    shape = model.prior.shape
    for x, a in np.ndindex(model.world.moves.shape):
        if x in model.world.goal_states:
            continue
        before = random_rows(rng, (model.prior.size,), 0.3)
        x_next = int(model.world.moves[x, a])
        forecast = model.predict(before.reshape(shape), x, a)
        np.testing.assert_allclose(forecast.sum(), 1.0, atol=1e-12)
        for human_input in range(model.world.actions):
            likelihood = model.modal_policies[:, x_next, human_input]
            if (forecast * likelihood).sum() < 1e-9:
                continue
            planner, chance = belief.update(problem, x, before, a, x_next, human_input)
            robot = model.correct(forecast, x_next, human_input)
            np.testing.assert_allclose(robot.ravel(), planner, atol=1e-12)
            assert chance == pytest.approx((forecast * likelihood).sum(), abs=1e-12)


@given(models(), st.integers(0, 2**32))
def test_many_beliefs_at_once_are_those_one_by_one(model: SharedAutonomy, seed: int) -> None:
    rng = np.random.default_rng(seed)
    world, n = model.world, 5
    before = random_rows(rng, (n, model.prior.size), 0.3).reshape(n, *model.prior.shape)
    states = rng.integers(world.states, size=n)
    actions = rng.integers(world.actions, size=n)
    corrected = model.correct(before, states, actions)
    forecast = model.predict(before, states, actions)
    for i, (x, a) in enumerate(zip(states.tolist(), actions.tolist(), strict=True)):
        np.testing.assert_allclose(corrected[i], model.correct(before[i], x, a), atol=1e-15)
        np.testing.assert_allclose(forecast[i], model.predict(before[i], x, a), atol=1e-15)


@given(models())
@pytest.mark.filterwarnings(f"ignore::{MOMDPWarning.__module__}.{MOMDPWarning.__name__}")
def test_compiled_problems_pass_the_check(model: SharedAutonomy) -> None:
    check_momdp(model.to_momdp())


def test_table_clearing_has_520_states() -> None:
    model = SharedAutonomy(TABLE)
    problem = model.to_momdp()
    check_momdp(problem)
    # Sec. 6.5: 52 robot states, 5 values of alpha and 2 modes.
    assert problem.states == 520
    assert problem.shape == (52, 10, 3, 3)
    assert problem.hidden_names[:3] == ("alpha=0 left", "alpha=0 right", "alpha=0.25 left")
    assert problem.action_names == problem.observation_names == ("left", "forward", "right")
    # The two goals end the task, and nothing else does.
    assert np.flatnonzero(problem.terminal).tolist() == sorted(TABLE.goal_states)
    # A root for each first input: left and right are mirror images, so as likely as each other.
    left, forward, right = problem.roots
    assert left.probability == pytest.approx(right.probability, abs=1e-12)
    assert left.probability + forward.probability + right.probability == pytest.approx(1.0)
    np.testing.assert_allclose(forward.belief, 0.1, atol=1e-12)


def test_defaults_are_those_of_the_paper_and_ours() -> None:
    model = SharedAutonomy(TABLE)
    # C = -0.32 and the values of alpha: Sec. 6.5. Uniform priors, gamma, c: ours.
    assert model.disagreement_cost == -0.32
    assert model.alpha.values.tolist() == [0, 0.25, 0.5, 0.75, 1]
    assert model.alpha.is_fixed
    np.testing.assert_allclose(model.prior, np.full((5, 2), 0.1), atol=1e-15)
    assert (model.discount, model.step_cost, model.memory) == (0.99, 3.0, 1)
    assert model.mode_names == ("left", "right")


def test_moving_forward_from_the_start_commits_to_nothing() -> None:
    # Sec. 3.2: upwards from S is as likely for either goal.
    model = SharedAutonomy(TABLE)
    np.testing.assert_allclose(model.perceived[TABLE.start, 1], [0.5, 0.5], atol=1e-12)
    assert model.perceived[TABLE.start, 0, 0] > 0.9
    assert model.perceived[TABLE.start, 2, 1] > 0.9


def test_one_way_is_a_stubborn_person_and_equal_goals() -> None:
    # Sec. 6.1: fixing the adaptability to 0 and assigning equal reward to both goals.
    model = SharedAutonomy(TABLE, mode_prior=(0.3, 0.7), discount=0.9, step_cost=2.0)
    one_way = model.one_way()
    assert one_way.alpha.values.tolist() == [0.0]
    assert [goal.reward for goal in one_way.world.goals] == [11.0, 11.0]
    np.testing.assert_array_equal(one_way.prior, [[0.3, 0.7]])
    np.testing.assert_array_equal(one_way.modal_policies, model.modal_policies)
    assert (one_way.discount, one_way.disagreement_cost) == (0.9, -0.32)
    # The mode never moves.
    some = np.array([[0.4, 0.6]])
    np.testing.assert_allclose(one_way.predict(some, TABLE.start, 2), some, atol=1e-15)
    # The model itself stays as it was.
    assert [goal.reward for goal in model.world.goals] == [10.0, 11.0]


def test_adaptability_by_goal_is_hidden_by_the_row() -> None:
    model = SharedAutonomy(TABLE, adaptability=((0.0, 0.5), (0.25, 1.0)))
    problem = model.to_momdp()
    check_momdp(problem)
    assert problem.shape == (52, 4, 3, 3)
    assert problem.hidden_names[:3] == (
        "alpha=0/0.5 left",
        "alpha=0/0.5 right",
        "alpha=0.25/1 left",
    )
    # The same number for both goals is the model with one number.
    both = SharedAutonomy(TABLE, adaptability=((0.0, 0.0), (0.5, 0.5))).to_momdp()
    one = SharedAutonomy(TABLE, adaptability=(0.0, 0.5)).to_momdp()
    np.testing.assert_array_equal(both.transition.matrix(3), one.transition.matrix(3))


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (dict(memory=0), "memory"),
        (dict(memory=101), "memory"),
        (dict(memory=20), "a memory of 20 steps makes more than 2,000,000 windows"),
        (dict(disagreement_cost=0.1), "disagreement cost"),
        (dict(disagreement_cost=float("nan")), "disagreement cost"),
        # It would make the reward of perfect agreement -inf * 0, which is no number.
        (dict(disagreement_cost=float("-inf")), "disagreement cost"),
        (dict(discount=1.0), "discount"),
        (dict(discount=-0.1), "discount"),
        (dict(discount=float("nan")), "discount"),
        (dict(adaptability=(0.0, 1.5)), "adaptability"),
        (dict(adaptability=()), "adaptability"),
        (dict(adaptability=((0.0, 1.0, 0.5),)), "values for 3 goals, expected 2"),
        (dict(mode_prior=(0.5, 0.6)), "mode prior"),
        (dict(mode_prior=(1.0,)), "mode prior"),
        (dict(mode_prior=(float("nan"), 1.0)), "mode prior"),
        (dict(policies=np.full((2, 52, 2), 0.5)), "policies"),
        (dict(policies=np.full((2, 52, 3), 0.5)), "policies"),
    ],
)
def test_bad_parameters_are_refused(parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        SharedAutonomy(TABLE, **parameters)


def test_too_small_a_step_cost_is_refused() -> None:
    with pytest.raises(ValueError, match="step cost"):
        SharedAutonomy(TABLE, step_cost=0.5).to_momdp()
