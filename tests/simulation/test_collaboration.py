"""Collaboration simulated and evaluated: against whole histories, and what the studies found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import coadapt as ca
from coadapt import Collaboration, SimulatedPartner, evaluate, simulate, simulate_batch
from coadapt.human import Adaptability
from coadapt.human.history import NO_STATE
from coadapt.robots import Collaborator
from tests.formalism.joint_recall import JointRecall, Step
from tests.formalism.joint_strategies import collaborations
from tests.robots.test_collaborator import some_policy

LEFT, RIGHT = 0, 1


def enumerate_histories(robot: Collaborator, partner: SimulatedPartner, longest: int) -> np.ndarray:
    """``[G + 1]`` the probability of ending at each goal in ``longest`` steps, and the mean steps.

    The person is that of the definitions, with one adaptability that is known.
    """
    assert partner.mode is not None
    world = robot.model.world
    person = replace(
        robot.model,
        adaptability=Adaptability.over(partner.rates(len(world.goals))[None]),
        mode_prior=np.eye(len(world.goals))[partner.mode].tolist(),
    )
    sums = np.zeros(len(world.goals) + 1)

    def go(recall: JointRecall, steps: list[Step], person_is: dict[tuple[int, ...], float]) -> None:
        if recall.done(steps):
            goal = world.goal_at(recall.state(steps))
            assert goal is not None
            sums[goal] += sum(person_is.values())
            return
        if len(steps) == longest:
            return
        sums[-1] += sum(person_is.values())
        robot.reset()
        state = recall.start
        for x, _, h, _ in steps:
            robot.decide(x, h)
        state = recall.state(steps)
        action = robot.plan(state)
        for h in recall.human_actions:
            now = {y: p * recall.human_chance(steps, y, h) for y, p in person_is.items()}
            if not any(now.values()):
                continue
            for later, chance in recall.following(steps, action, h):
                moved = {
                    y_next: chance
                    * sum(p * recall.hidden_moves(later, y, y_next) for y, p in now.items())
                    for y_next in recall.hidden
                }
                go(recall, later, moved)

    for start, chance in world.starts.items():
        recall = JointRecall(person, start)
        go(recall, [], {y: chance * p for y, p in recall.prior().items()})
    return sums


@given(collaborations(goals=2), st.booleans(), st.integers(0, 2**32))
@settings(max_examples=25)
def test_the_evaluation_is_that_of_the_histories(
    model: Collaboration, by_goal: bool, seed: int
) -> None:
    rng, goals = np.random.default_rng(seed), len(model.world.goals)
    robot = Collaborator(model, some_policy(model, rng))
    alpha = tuple(rng.random(goals).tolist()) if by_goal else float(rng.random())
    partner = SimulatedPartner(alpha, mode=int(rng.integers(goals)))
    expected = enumerate_histories(robot, partner, 4)
    found = evaluate(robot, partner, max_steps=4, tolerance=1e-9)
    np.testing.assert_allclose(found.goal_probability, expected[:-1], atol=1e-9)
    assert found.steps == pytest.approx(expected[-1], abs=1e-9)


@pytest.fixture(scope="module")
def table() -> Collaborator:
    model = Collaboration(ca.worlds.table_carrying())
    return Collaborator(model, ca.SARSOP(gap=1e-3).solve(model.to_momdp()).policy)


@pytest.fixture(scope="module")
def hallway() -> Collaborator:
    model = Collaboration(ca.worlds.hallway())
    return Collaborator(model, ca.SARSOP(gap=1e-3).solve(model.to_momdp()).policy)


@pytest.mark.parametrize("name", ["table", "hallway"])
@pytest.mark.parametrize(("alpha", "goal"), [(0.0, LEFT), (1.0, RIGHT)])
def test_stubborn_people_get_their_goal_and_adaptable_ones_the_best(
    name: str, alpha: float, goal: int, request: pytest.FixtureRequest
) -> None:
    robot = request.getfixturevalue(name)
    partner = SimulatedPartner(alpha, mode=LEFT)
    assert evaluate(robot, partner).goal_probability[goal] == pytest.approx(1.0, abs=1e-9)
    episodes = simulate(robot, partner, 20, np.random.default_rng(0))
    assert [episode.goal for episode in episodes] == [goal] * 20
    # People who want the best goal get it, whatever their adaptability.
    willing = evaluate(robot, SimulatedPartner(alpha, mode=RIGHT))
    assert willing.goal_probability[RIGHT] == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("name", ["table", "hallway"])
def test_simulation_and_evaluation_agree(name: str, request: pytest.FixtureRequest) -> None:
    robot = request.getfixturevalue(name)
    partner = SimulatedPartner(0.25, mode=LEFT)
    exact = evaluate(robot, partner)
    n = 400
    episodes = simulate(robot, partner, n, np.random.default_rng(1))
    chance = exact.goal_probability[RIGHT]
    error = np.sqrt(chance * (1 - chance) / n)
    assert np.mean([e.goal == RIGHT for e in episodes]) == pytest.approx(chance, abs=4 * error)
    steps = np.array([e.steps for e in episodes])
    assert steps.mean() == pytest.approx(exact.steps, abs=4 * steps.std() / np.sqrt(n))
    missed = np.array([e.disagreement for e in episodes])
    assert missed.mean() == pytest.approx(exact.disagreement, abs=4 * missed.std() / np.sqrt(n))


def test_a_table_that_slips() -> None:
    # With probability 0.3 it does not turn although both push the same way.
    table = ca.worlds.table_carrying(4)
    stays = np.broadcast_to(np.arange(table.states)[:, None, None], table.moves.shape)
    turns = table.moves != stays
    world = replace(
        table,
        moves=np.stack([table.moves, np.where(turns, stays, NO_STATE)], axis=3),
        chances=np.stack([np.where(turns, 0.7, 1.0), np.where(turns, 0.3, 0.0)], axis=3),
    )
    model = Collaboration(world, memory=2)
    robot = Collaborator(model, ca.SARSOP(gap=1e-3).solve(model.to_momdp()).policy)
    partner = SimulatedPartner(1.0, mode=RIGHT)
    exact = evaluate(robot, partner)
    # Three turns, each after 1 / 0.7 steps on average.
    assert exact.goal_probability[RIGHT] == pytest.approx(1.0, abs=1e-3)
    assert exact.steps == pytest.approx(3 / 0.7, abs=0.02)
    episodes = simulate(robot, partner, 400, np.random.default_rng(0))
    steps = np.array([e.steps for e in episodes])
    assert steps.mean() == pytest.approx(3 / 0.7, abs=4 * steps.std() / 20)
    assert {e.goal for e in episodes} == {RIGHT}


def test_an_episode_is_what_both_did(table: Collaborator) -> None:
    (episode,) = simulate(table, SimulatedPartner(0.0, mode=LEFT), 1, np.random.default_rng(0))
    world = table.model.world
    state = world.start
    for decision, human in zip(episode.decisions, episode.inputs, strict=True):
        assert decision.state == state
        assert human == LEFT
        state = int(world.moves[state, decision.action, human])
    assert state == episode.final_state == 0
    # The robot insists on its goal, as long as it may hope, and gives in for good.
    given_in = episode.actions.index(LEFT)
    assert given_in > 0
    assert set(episode.actions[given_in:]) == {LEFT}
    assert episode.overridden == 0


def after_tasks(
    robot: Collaborator, alpha: float, rng: np.random.Generator, tasks: int
) -> tuple[bool, float]:
    """Whether the last of some tasks ends at the best goal, and the mean of alpha after it.

    The person begins each task in their own mode, the robot with the belief so far.
    """
    partner = SimulatedPartner(alpha, mode=LEFT)
    batch = simulate_batch(robot, partner, 1, rng, trials=tasks, keep_mode=False, beliefs=True)
    assert batch.belief is not None
    last = batch.belief[0, -1].sum(axis=1)
    return bool(batch.goal[0, -1] == RIGHT), float(last @ robot.model.alpha.values)


def test_estimates_separate_those_who_adapt_from_those_who_do_not(table: Collaborator) -> None:
    rng = np.random.default_rng(0)
    # HRI 2016 estimated .85 for participants who adapted and .07 for those who did not. Here are
    # people of alpha 1 and 0 in two tasks with one belief. The estimates do not depend on chance:
    # alpha^2 after two switches, and (1 - alpha)^n after n insistent steps.
    adapted, high = after_tasks(table, 1.0, rng, 2)
    assert adapted
    assert high == pytest.approx(0.8333, abs=1e-4)
    adapted, low = after_tasks(table, 0.0, rng, 2)
    assert not adapted
    assert low < 0.1
    # People of all kinds, as the robot's prior has them: the groups stay apart.
    people = [after_tasks(table, float(a), rng, 2) for a in np.tile(table.model.alpha.values, 30)]
    estimates = [np.mean([mean for did, mean in people if did is group]) for group in (True, False)]
    assert estimates[0] > 0.6
    assert estimates[1] < 0.15
