"""The identities, and that the comparison would notice if they did not hold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from coadapt import MOMDP, SharedAutonomy
from coadapt.momdp.check import check_momdp
from coadapt.report.goal_planner import GoalPlanner, goal_problem
from coadapt.report.identities import (
    always_optimal,
    identities,
    one_way_is_goal_planning,
    problem_difference,
)
from coadapt.worlds import table_clearing


@pytest.fixture(scope="module")
def model() -> SharedAutonomy:
    return SharedAutonomy(table_clearing())


def build(model: SharedAutonomy) -> MOMDP:
    one_way = model.one_way()
    return goal_problem(
        one_way.world,
        one_way.windows,
        one_way.modal_policies,
        one_way.disagreement_cost,
        one_way.discount,
    )


def test_identities_hold_on_the_papers_task(model: SharedAutonomy) -> None:
    one_way, no_penalty, fully_adaptable = identities(model, gap=1e-3)
    assert one_way.holds
    assert one_way.differing == 0
    assert one_way.decisions > 10_000
    # 3 inputs in each of the 9 steps of a shortest path: no two histories lead to one belief.
    assert no_penalty.decisions == sum(3**step for step in range(1, 10))
    for identity in (no_penalty, fully_adaptable):
        assert identity.holds
        assert identity.complete
        assert identity.differing == identity.ties
        assert identity.largest_loss == 0
        assert identity.optimal_goal == pytest.approx(1, abs=1e-9)


def test_goal_problem_is_valid_and_the_one_way_model(model: SharedAutonomy) -> None:
    problem = build(model)
    check_momdp(problem)
    assert problem_difference(model.one_way().to_momdp(), problem) < 1e-12


@pytest.mark.parametrize(
    "change", [{"disagreement_cost": -0.33}, {"discount": 0.98}, {"step_cost": 3.1}]
)
def test_another_problem_is_noticed(model: SharedAutonomy, change: dict[str, float]) -> None:
    other = replace(model, **change).one_way().to_momdp()
    assert problem_difference(other, build(model)) > 1e-3


def test_another_layout_is_noticed(model: SharedAutonomy) -> None:
    smaller = replace(model, world=table_clearing(11, 4)).one_way().to_momdp()
    assert problem_difference(smaller, build(model)) == float("inf")


def test_robot_that_complies_is_noticed(model: SharedAutonomy) -> None:
    """The robot of the paper's parameters does not always go to the optimal goal."""
    identity = always_optimal("", "", replace(model, adaptability=(0.0,)), gap=1e-3)
    assert not identity.holds
    assert identity.differing > identity.ties
    assert identity.optimal_goal is not None
    assert identity.optimal_goal < 0.9


@pytest.mark.parametrize("memory", [1, 3])
def test_one_way_robot_of_another_world_is_the_goal_planner(memory: int) -> None:
    model = SharedAutonomy(table_clearing(7, 3), memory=memory, discount=0.9, step_cost=2.0)
    assert one_way_is_goal_planning(model, 1e-6).holds


def test_goal_planner_follows_bayes_rule(model: SharedAutonomy) -> None:
    policies = np.array([[[0.8, 0.2]], [[0.3, 0.7]]])  # [G, X, A]
    planner = GoalPlanner(policies, policy=None)  # type: ignore[arg-type]
    belief = planner.correct(planner.prior[None], np.array([0]), np.array([0]))
    assert belief[0] == pytest.approx([8 / 11, 3 / 11])  # 0.5 * 0.8 and 0.5 * 0.3, scaled
