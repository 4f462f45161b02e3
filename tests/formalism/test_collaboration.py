"""The compiled problem against the definitions on whole histories."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import coadapt as ca
from coadapt.arrays import FloatArray
from coadapt.formalism.collaboration import Collaboration
from coadapt.human import Adaptability
from coadapt.momdp import MOMDP
from coadapt.momdp.check import MOMDPWarning, check_momdp
from coadapt.worlds.hallway import hallway
from coadapt.worlds.table_carrying import table_carrying
from tests.formalism.joint_recall import JointRecall, Step
from tests.formalism.joint_strategies import collaborations
from tests.momdp.problems import joint

IGNORE_UNREACHED = f"ignore::{MOMDPWarning.__module__}.{MOMDPWarning.__name__}"


@given(collaborations(), st.integers(0, 2**32))
@pytest.mark.filterwarnings(IGNORE_UNREACHED)
def test_along_random_actions_the_problem_is_that_of_the_histories(
    model: Collaboration, seed: int
) -> None:
    problem = model.to_momdp()
    check_momdp(problem)
    named = {name: x for x, name in enumerate(problem.observed_names)}
    moves = joint(problem)
    rng = np.random.default_rng(seed)
    for root in problem.roots:
        recall = JointRecall(model, int(model.windows.state[root.x]))
        assert root.probability == 1 / len(problem.roots)
        np.testing.assert_allclose(root.belief, list(recall.prior().values()), atol=1e-12)
        steps: list[Step] = []
        for _ in range(6):
            x = named[recall.name(steps)]
            if recall.done(steps):
                assert not moves[x].any()
                goal = model.world.goal_at(recall.state(steps))
                assert goal is not None
                np.testing.assert_array_equal(problem.reward[x], model.world.goals[goal].reward)
                break
            assert not problem.reward[x].any()
            for a in recall.actions:
                expected = np.zeros(moves.shape[2:])
                for h, (i, y) in product(recall.human_actions, enumerate(recall.hidden)):
                    acts = recall.human_chance(steps, y, h)
                    for later, chance in recall.following(steps, a, h) if acts > 0 else ():
                        x_next = named[recall.name(later)]
                        for j, y_next in enumerate(recall.hidden):
                            moved = recall.hidden_moves(later, y, y_next)
                            expected[i, x_next, j] += acts * chance * moved
                np.testing.assert_allclose(moves[x, a], expected, atol=1e-12)
            # On with a human action that shows a mode, however unlikely it is.
            possible = np.flatnonzero(model.modal_policies[1][:, recall.state(steps)].any(axis=0))
            a, h = int(rng.integers(model.world.actions)), int(rng.choice(possible))
            histories = recall.following(steps, a, h)
            steps, _ = histories[int(rng.integers(len(histories)))]


def best(problem: MOMDP, x: int, mass: FloatArray, horizon: int) -> float:
    """The largest expected discounted reward of ``horizon`` actions in a planning problem."""
    if horizon == 0:
        return 0.0
    values = problem.reward[x] @ mass
    for a in range(len(values)):
        for e in problem.edges(x, a):
            moved = problem.transition.forward(int(problem.edge_map[e]), mass)
            later = best(problem, int(problem.edge_next[e]), moved, horizon - 1)
            values[a] += problem.discount * later
    return float(values.max())


@given(collaborations(goals=2), st.integers(2, 4))
@settings(max_examples=25)
def test_values_are_those_of_the_histories(model: Collaboration, horizon: int) -> None:
    problem = model.to_momdp()
    for root in problem.roots:
        recall = JointRecall(model, int(model.windows.state[root.x]))
        found = best(problem, root.x, root.belief, horizon)
        assert found == pytest.approx(recall.best(recall.prior(), [], horizon), abs=1e-12)


@given(collaborations(), st.integers(0, 2**32))
@pytest.mark.filterwarnings(IGNORE_UNREACHED)
def test_the_planner_and_the_filter_hold_the_same_belief(model: Collaboration, seed: int) -> None:
    problem, rng = model.to_momdp(), np.random.default_rng(seed)
    x, belief = problem.roots[0].x, model.prior[None]
    planner = problem.roots[0].belief
    for _ in range(6):
        np.testing.assert_allclose(model.modes.hidden(belief)[0], planner, atol=1e-12)
        if problem.terminal[x]:
            return
        a = int(rng.integers(model.world.actions))
        edges = list(problem.edges(x, a))
        masses = [problem.transition.forward(int(problem.edge_map[e]), planner) for e in edges]
        chances = np.array([mass.sum() for mass in masses])
        assert chances.sum() == pytest.approx(1.0, abs=1e-12)
        e = int(rng.choice(len(edges), p=chances / chances.sum()))
        x_next = int(problem.edge_next[edges[e]])
        (which,) = np.flatnonzero(model.windows.next[x, a] == x_next)
        h = which // (model.windows.next.shape[2] // model.world.human_actions)
        here, action, human = np.array([x]), np.array([a]), np.array([h])
        corrected = model.correct(belief, here, human)
        belief = model.predict(corrected, here, action, human)
        assert belief.min() >= 0
        assert belief.sum() == pytest.approx(1.0, abs=1e-9)
        x, planner = x_next, masses[e] / chances[e]


@pytest.mark.parametrize(
    ("memory", "skewed_to"),
    # HRI 2016, Fig. 6: T = 4 in the 1-step and in the 3-step model.
    [(1, "adaptable"), (3, "stubborn")],
)
def test_the_published_course_of_beliefs(memory: int, skewed_to: str) -> None:
    model = Collaboration(table_carrying(), memory=memory, mode_prior=(1.0, 0.0))
    left, right = np.array([0]), np.array([1])
    window, belief = model.windows.beginning[[model.world.start]], model.prior[None]
    means: list[float] = []
    # Human and robot: the human insists twice, switches as the robot gives in, and switches back.
    for human, robot in ((left, right), (left, right), (right, left), (left, left)):
        belief = model.correct(belief, window, human)
        means.append(float((belief.sum(axis=2) * model.alpha.values).sum()))
        belief = model.predict(belief, window, robot, human)
        window = model.windows.next[window, robot, human]
    # After the first disagreement the belief stays uniform, then it moves to smaller values, and
    # back when the human switches to the robot's mode: it is symmetric, alpha (1 - alpha).
    assert means[:3] == pytest.approx([0.5, 0.25, 0.5], abs=1e-12)
    # Then it is alpha^2 (1 - alpha) with one step and alpha (1 - alpha)^2 with three.
    alpha = model.alpha.values
    weight = alpha**2 * (1 - alpha) if skewed_to == "adaptable" else alpha * (1 - alpha) ** 2
    assert means[3] == pytest.approx((alpha * weight).sum() / weight.sum(), abs=1e-12)


@pytest.mark.parametrize(
    ("world", "observed", "count"),
    [
        # HRI 2016: 734 observable states; the last one is where the finished task stays.
        (table_carrying(), "closed", 734),
        (table_carrying(), "reached", 733),
        # 14 orientations after each of the 1 + 4 + 16 + 64 windows.
        (table_carrying(), "all", 1190),
        # IJRR 2017: 340 = 4 x (1 + 4 + 16 + 64) observable states.
        (hallway(), "all", 340),
        (hallway(), "reached", 30),
    ],
    ids=lambda v: v.name if hasattr(v, "name") else str(v),
)
@pytest.mark.filterwarnings(IGNORE_UNREACHED)
def test_published_numbers_of_states(world: Any, observed: Any, count: int) -> None:
    problem = Collaboration(world, observed=observed).to_momdp()
    check_momdp(problem)
    assert problem.shape == (count, 5, 2, 1)


def test_defaults_are_ours_where_not_published() -> None:
    model = Collaboration(table_carrying())
    assert (model.memory, model.ties, model.discount) == (3, "latest", 0.99)
    np.testing.assert_allclose(model.prior, np.full((5, 2), 0.1), atol=1e-15)
    # Each mode turns the table its way, everywhere.
    for half in model.modal_policies:
        np.testing.assert_array_equal(half[:, 1:13].argmax(axis=2), [[0] * 12, [1] * 12])


def test_hidden_modes_have_maximum_entropy_policies() -> None:
    robot, human = Collaboration(table_carrying(), hidden_modes=True).modal_policies
    # The task is the same for both of them, and its mirror image for the other goal.
    np.testing.assert_allclose(robot, human, atol=1e-12)
    np.testing.assert_allclose(robot[0, 1:13, 0], robot[1, 12:0:-1, 1], atol=1e-12)
    assert np.all(robot[0, 1:13, 0] > 0.9)


TABLE = table_carrying()
SAME = np.tile([1.0, 0.0], (2, 14, 1))


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (dict(memory=0), "memory must be 1 to 100 steps, not 0"),
        (dict(memory=12), "a memory of 12 steps makes more than 200,000 windows"),
        (dict(discount=1.0), "discount"),
        (dict(ties="first"), "ties must be one of latest, earliest, even, not first"),
        (dict(observed="some"), "observed must be one of reached, closed, all, not some"),
        (dict(observed="all", hidden_modes=True), "where modes are hidden"),
        (dict(mode_prior=(0.5, 0.6)), "mode prior"),
        (dict(robot_policies=np.full((2, 14, 3), 1 / 3)), "robot policies has shape"),
        (dict(human_policies=np.full((2, 14, 2), 1.0)), "human policies must be"),
        (dict(robot_policies=np.full((2, 14, 2), 0.5)), "robot policies are not deterministic"),
        (dict(human_policies=SAME), "the same human action in orientation 6"),
        (dict(adaptability=Adaptability.over([[0.1, 0.2, 0.3]])), "adaptability has values for 3"),
    ],
)
def test_bad_parameters_are_refused(parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Collaboration(TABLE, **parameters)


@pytest.mark.parametrize(
    "model",
    [
        Collaboration(table_carrying(), observed="closed"),
        Collaboration(hallway(), observed="all"),
        Collaboration(hallway(), hidden_modes=True),
    ],
    ids=["table_carrying", "hallway", "hallway with hidden modes"],
)
def test_a_written_problem_has_the_same_bounds(model: Collaboration, tmp_path: Path) -> None:
    problem = model.to_momdp()
    ca.write_pomdpx(problem, tmp_path / "task.pomdpx")
    again = ca.read_pomdp(tmp_path / "task.pomdpx")
    # A state for the end is added where the problem has none.
    assert again.shape[0] == problem.shape[0] + bool(problem.terminal.any())
    # Bounds that close hold the same value; which way the search goes may differ.
    first, second = (ca.SARSOP(gap=1e-6).solve(p) for p in (problem, again))
    assert second.lower == pytest.approx(first.lower, abs=1e-6)
    assert second.upper == pytest.approx(first.upper, abs=1e-6)
