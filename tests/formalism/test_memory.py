"""Memories of several steps against the equations on whole histories."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import coadapt as ca
from coadapt import MOMDP, SharedAutonomy
from coadapt.arrays import FloatArray
from coadapt.human.remembered import locate
from coadapt.momdp.check import MOMDPWarning, check_momdp
from tests.formalism.recall import Past, Recall
from tests.formalism.strategies import models
from tests.momdp.problems import joint, observations


@given(models(memory=4, general=True), st.integers(0, 2**32))
def test_along_random_actions_the_problem_is_that_of_the_histories(
    model: SharedAutonomy, seed: int
) -> None:
    problem, recall = model.to_momdp(), Recall(model)
    moves, sees = joint(problem), observations(problem)
    hidden = list(recall.prior())
    rng = np.random.default_rng(seed)
    x = problem.roots[0].x
    past = Past((), int(model.windows.state[x]))
    while True:
        for a in recall.actions:
            found = [problem.reward[x, a, y] for y in range(len(hidden))]
            expected = [recall.reward(past, a, m) for _, m in hidden]
            np.testing.assert_allclose(found, expected, atol=1e-12)
        if recall.goal(past) is not None:
            assert not moves[x].any()
            return
        if len(past.steps) == 8:
            return
        a = int(rng.integers(model.world.actions))
        outcomes = recall.moves(past.state, a)
        # One observed state follows for each outcome, the one that ends in its robot state.
        following = np.flatnonzero(moves[x, a].any(axis=(0, 2)))
        reached = {int(model.windows.state[w]): int(w) for w in following}
        assert len(reached) == len(following)
        assert reached.keys() == outcomes.keys()
        for state, chance in outcomes.items():
            for y, (i, m) in enumerate(hidden):
                for v, (j, m_next) in enumerate(hidden):
                    share = chance * float(recall.alpha.transition[i, j])
                    expected = share * recall.mode_moves(past, a, i, m, m_next)
                    assert moves[x, a, y, reached[state], v] == pytest.approx(expected, abs=1e-12)
            for v, (_, m) in enumerate(hidden):
                expected = [recall.input_chance(state, m, o) for o in recall.observations]
                np.testing.assert_allclose(sees[a, reached[state], v], expected, atol=1e-12)
        state = int(rng.choice(list(outcomes)))
        past, x = past.then(a, state), reached[state]


def best(problem: MOMDP, x: int, mass: FloatArray, horizon: int) -> float:
    """The largest expected discounted reward of ``horizon`` actions in a planning problem."""
    if horizon == 0:
        return 0.0
    values = problem.reward[x] @ mass
    for a in range(len(values)):
        for e in problem.edges(x, a):
            following = int(problem.edge_next[e])
            moved = problem.transition.forward(int(problem.edge_map[e]), mass)
            likelihood = problem.observation[problem.observation_index[a, following]]
            for o in range(likelihood.shape[1]):
                later = best(problem, following, moved * likelihood[:, o], horizon - 1)
                values[a] += problem.discount * later
    return float(values.max())


def one_step(
    model: SharedAutonomy, recall: Recall, past: Past, window: int, rng: np.random.Generator
) -> tuple[int, Past, int]:
    """A random action, the past and the window after it."""
    a = int(rng.integers(model.world.actions))
    state = int(rng.choice(list(recall.moves(past.state, a))))
    return a, past.then(a, state), locate(model.windows, model.windows.next[window, a], state)


@given(models(memory=4, goals=2, general=True), st.integers(0, 4), st.integers(0, 2**32))
@settings(max_examples=25)
def test_values_are_those_of_the_histories(model: SharedAutonomy, before: int, seed: int) -> None:
    problem, recall = model.to_momdp(), Recall(model)
    rng = np.random.default_rng(seed)
    belief, x = recall.prior(), problem.roots[0].x
    past = Past((), int(model.windows.state[x]))
    # Some steps without input first, so that windows slide.
    for _ in range(before):
        if recall.goal(past) is not None:
            break
        a, later, x = one_step(model, recall, past, x, rng)
        belief, past = recall.after_action(belief, past, a), later
    found = best(problem, x, np.array(list(belief.values())), 2)
    assert found == pytest.approx(recall.best(belief, past, 2), abs=1e-12)


@given(models(memory=4, general=True), st.integers(0, 2**32))
def test_the_filter_is_that_of_the_histories(model: SharedAutonomy, seed: int) -> None:
    recall, rng = Recall(model), np.random.default_rng(seed)
    past = Past((), model.world.start)
    window = int(model.windows.beginning[past.state])
    expected, found = recall.prior(), model.prior
    for _ in range(8):
        if recall.goal(past) is not None:
            return
        human_input = int(rng.integers(len(model.interface)))
        mass = recall.after_input(expected, past.state, human_input)
        total = sum(mass.values())
        if total == 0:
            return
        expected = {y: p / total for y, p in mass.items()}
        found = model.correct(found, window, human_input)
        np.testing.assert_allclose(found.ravel(), list(expected.values()), atol=1e-12)
        before = window
        a, later, window = one_step(model, recall, past, window, rng)
        expected, past = recall.after_action(expected, past, a), later
        found = model.predict(found, before, a)
        np.testing.assert_allclose(found.ravel(), list(expected.values()), atol=1e-12)


@given(models(general=True))
def test_the_roots_are_those_of_every_start_and_first_observation(model: SharedAutonomy) -> None:
    recall, found = Recall(model), list(model.to_momdp().roots)
    for start, chance in model.world.start_chances.items():
        for o in recall.observations:
            mass = recall.after_input(recall.prior(), start, o)
            total = sum(mass.values())
            if total == 0:
                continue
            root = found.pop(0)
            assert model.windows.state[root.x] == start
            assert root.label == model.interface.observation_names[o]
            assert root.probability == pytest.approx(chance * total, abs=1e-12)
            expected = [p / total for p in mass.values()]
            np.testing.assert_allclose(root.belief, expected, atol=1e-12)
    assert not found


@given(models(memory=4, general=True))
@pytest.mark.filterwarnings(f"ignore::{MOMDPWarning.__module__}.{MOMDPWarning.__name__}")
def test_compiled_problems_pass_the_check(model: SharedAutonomy) -> None:
    problem = model.to_momdp()
    check_momdp(problem)
    assert problem.shape[0] == len(model.windows)
    assert len(set(problem.observed_names)) == len(model.windows)


def test_table_clearing_with_three_steps() -> None:
    model = SharedAutonomy(ca.worlds.table_clearing(), memory=3)
    problem = model.to_momdp()
    check_momdp(problem)
    # 442 windows, see tests/human/test_history.py, times 5 values of alpha and 2 modes.
    assert problem.states == 4420
    names = problem.observed_names
    assert names[0] == "column 6 row 0"
    assert names[3] == "column 6 row 0, right"
    assert "column 0 row 0, forward, left" in names
    # A first step to the left looks like the left goal; after it a step to the right, which brings
    # the robot back, looks like none.
    left = int(model.windows.next[0, 0, 0])
    assert model.perceived[0, 0, 0] > 0.9
    assert 0.4 < model.perceived[left, 2, 0] < 0.6
    one_step = replace(model, memory=1)
    assert one_step.perceived[5, 2, 0] < 0.1


def test_longer_memories_contain_shorter_ones() -> None:
    # In the first k steps the person remembers all of them, whatever the memory.
    world = ca.worlds.table_clearing(7, 3)
    one, other = SharedAutonomy(world, memory=3), SharedAutonomy(world, memory=4)
    a = b = 0
    for action in (0, 2, 1):
        np.testing.assert_allclose(one.perceived[a], other.perceived[b], atol=1e-12)
        a, b = int(one.windows.next[a, action, 0]), int(other.windows.next[b, action, 0])
    assert np.abs(one.perceived[a] - other.perceived[b]).max() > 0.01
