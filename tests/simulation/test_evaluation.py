"""The exact evaluation against an enumeration of hidden trajectories and against simulation."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import coadapt as ca
from coadapt import SharedAutonomy, SimulatedPartner, evaluate, simulate
from coadapt.arrays import FloatArray
from coadapt.robots import MatchRule, MutualAdaptation, NoAdaptation, OneWayAdaptation, Robot
from coadapt.simulation import evaluate_all, evaluation, expand
from tests.formalism.strategies import models
from tests.momdp.problems import known_hidden_policy
from tests.robots.worlds import LOW, MODEL, UP, B, always


@dataclass
class Sums:
    """What the enumeration adds up, each weighted with the probability of the trajectory."""

    goal_probability: FloatArray
    discounted_return: float = 0.0
    steps: float = 0.0
    disagreement: float = 0.0
    overridden: float = 0.0
    going: float = 0.0
    occupancy: list[float] = field(default_factory=list[float])


def enumerate_trajectories(robot: Robot, partner: SimulatedPartner, longest: int) -> Sums:
    """Every sequence of modes and inputs of up to ``longest`` steps, one by one."""
    model, world, windows = robot.model, robot.model.world, robot.model.windows
    sums = Sums(np.zeros(len(world.goals)), occupancy=[0.0] * longest)

    inputs, alpha = model.interface, partner.rates(len(world.goals))

    def go(window: int, mode: int, belief: FloatArray, chance: float, step: int) -> None:
        if chance == 0:
            return
        if step == longest:
            sums.going += chance
            return
        state = int(windows.state[window])
        for observed in range(len(inputs.observation_names)):
            now = chance * float(model.input_likelihood[state, observed, mode])
            if now == 0:
                continue
            human_input = observed if observed < len(inputs) else None
            asked = -1 if human_input is None else int(inputs.asks[human_input])
            robot.reset(belief, window)
            decision = robot.decide(state, human_input)
            perceived = model.perceived[window, decision.action]
            seen = sum(perceived[m_r] for m_r in range(len(perceived)) if m_r != mode)
            sums.occupancy[step] += now
            sums.steps += now
            sums.disagreement += now * seen
            sums.overridden += now * (asked >= 0 and asked != decision.action)
            paid = float(model.reward[window, decision.action, mode])
            sums.discounted_return += now * model.discount**step * paid
            outcomes = world.outcomes[state, decision.action]
            chances = world.outcome_chances[state, decision.action]
            for n, following in enumerate(map(int, outcomes)):
                then = now * float(chances[n])
                if then == 0:
                    continue
                goal = world.goal_at(following)
                if goal is not None:
                    sums.goal_probability[goal] += then
                    reward = model.discount ** (step + 1) * world.goals[goal].reward
                    sums.discounted_return += then * reward
                    continue
                for mode_next in range(len(world.goals)):
                    # Eq. 3-4 written out.
                    moves = float(alpha[mode_next] * perceived[mode_next])
                    moves += float((1 - alpha) @ perceived) * (mode_next == mode)
                    later = int(windows.next[window, decision.action, n])
                    go(later, mode_next, decision.forecast, then * moves, step + 1)

    robot.reset()
    prior = robot.belief
    for start, begins in world.start_chances.items():
        for mode, chance in enumerate(partner.mode_distribution(model)):
            go(int(windows.beginning[start]), mode, prior, begins * float(chance), 0)
    return sums


@given(
    models(states=4, goals=2, memory=3, general=True),
    st.sampled_from((0.0, 0.3, 1.0)),
    st.booleans(),
    st.sampled_from((0.5, 0.9)),
    st.integers(1, 4),
)
@settings(max_examples=25)
def test_it_sums_over_all_hidden_trajectories(
    model: SharedAutonomy, alpha: float, by_goal: bool, threshold: float, longest: int
) -> None:
    policy = known_hidden_policy(model.to_momdp(), sweeps=30)
    robot = MutualAdaptation(model, policy, MatchRule(threshold))
    partner = SimulatedPartner((alpha, 0.8)[: len(model.world.goals)] if by_goal else alpha)
    expected = enumerate_trajectories(robot, partner, longest)
    found = evaluate(robot, partner, tolerance=1e-9, max_steps=longest)
    np.testing.assert_allclose(found.goal_probability, expected.goal_probability, atol=1e-9)
    assert found.steps == pytest.approx(expected.steps, abs=1e-8)
    assert found.disagreement == pytest.approx(expected.disagreement, abs=1e-8)
    assert found.overridden == pytest.approx(expected.overridden, abs=1e-8)
    assert found.discounted_return == pytest.approx(expected.discounted_return, abs=1e-7)
    assert found.unresolved == pytest.approx(expected.going, abs=1e-8)
    assert found.goal_probability.sum() + found.unresolved == pytest.approx(1.0, abs=1e-12)


TABLE = ca.SharedAutonomy(ca.worlds.table_clearing(7, 3), discount=0.9)
THREE = replace(TABLE, memory=3, disagreement_cost=-1.0)
ROBOTS: list[Robot] = [
    MutualAdaptation(TABLE, known_hidden_policy(TABLE.to_momdp())),
    OneWayAdaptation(TABLE, known_hidden_policy(TABLE.one_way().to_momdp())),
    NoAdaptation(TABLE),
    MutualAdaptation(THREE, known_hidden_policy(THREE.to_momdp(), sweeps=60)),
]
IDS = [f"{robot.name}-{robot.model.memory}" for robot in ROBOTS]


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
@pytest.mark.parametrize("partner", [SimulatedPartner(0.0, LOW), SimulatedPartner(0.6)], ids=str)
def test_simulation_agrees_within_four_standard_errors(
    robot: Robot, partner: SimulatedPartner
) -> None:
    n = 600
    exact = evaluate(robot, partner, tolerance=1e-6)
    episodes = simulate(robot, partner, n, np.random.default_rng(12))
    measured = {
        "reward": [e.reward for e in episodes],
        "steps": [e.steps for e in episodes],
        "disagreement": [e.disagreement for e in episodes],
        "overridden": [e.overridden for e in episodes],
        "discounted_return": [
            robot.model.discount**e.steps * e.reward
            + sum(
                robot.model.discount**t
                * robot.model.disagreement_cost
                * (1 - robot.model.perceived[d.window, d.action, m])
                for t, (d, m) in enumerate(zip(e.decisions, e.modes, strict=True))
            )
            for e in episodes
        ],
    }
    for name, values in measured.items():
        error = np.std(values, ddof=1) / np.sqrt(n)
        # What happens once in n episodes may have happened in none.
        assert abs(np.mean(values) - getattr(exact, name)) <= 4 * error + 1 / n, name
    for goal, chance in enumerate(exact.goal_probability):
        share = np.mean([e.goal == goal for e in episodes])
        assert abs(share - chance) <= 4 * np.sqrt(chance * max(0.0, 1 - chance) / n) + 1e-4


@pytest.mark.parametrize("robot", ROBOTS, ids=IDS)
def test_probabilities_sum_to_one(robot: Robot) -> None:
    partners = [SimulatedPartner(0.0, LOW), SimulatedPartner(0.5)]
    arrived = np.zeros(2)
    for visits in expand(robot, *partners, threshold=0.0, max_steps=9):
        assert visits.weight.shape == (len(visits.decisions), 2, 2)
        assert np.all(visits.weight >= 0)
        # Whoever has not arrived takes a decision.
        np.testing.assert_allclose(visits.weight.sum(axis=(0, 2)) + arrived, 1.0, atol=1e-12)
        taken = visits.decisions
        ends = np.isin(TABLE.world.moves[taken.state, taken.action], TABLE.world.goal_states)
        arrived += visits.weight[ends].sum(axis=(0, 2))
    for i, partner in enumerate(partners):
        found = evaluate(robot, partner, tolerance=1e-6)
        assert found.goal_probability.sum() + found.unresolved == pytest.approx(1.0, abs=1e-12)
        assert found.unresolved <= 1e-6
        assert found.goal_probability.sum() >= arrived[i] - 1e-6


def test_several_partners_at_once_are_those_one_by_one() -> None:
    robot = ROBOTS[0]
    partners = [SimulatedPartner(a, LOW) for a in (0.0, 0.4, 1.0)]
    together = evaluate_all(robot, partners, tolerance=1e-6)
    for partner, found in zip(partners, together, strict=True):
        alone = evaluate(robot, partner, tolerance=1e-6)
        np.testing.assert_allclose(found.goal_probability, alone.goal_probability, atol=2e-6)
        assert found.reward == pytest.approx(alone.reward, abs=1e-4)
        assert found.steps == pytest.approx(alone.steps, abs=1e-3)
        assert found.discounted_return == pytest.approx(alone.discounted_return, abs=1e-4)


@pytest.mark.parametrize("tolerance", [1e-1, 1e-2, 1e-4])
def test_the_tolerance_bounds_what_is_left_out(tolerance: float) -> None:
    partner = SimulatedPartner(0.5)
    fine = evaluate(ROBOTS[0], partner, tolerance=1e-8)
    found = evaluate(ROBOTS[0], partner, tolerance=tolerance)
    assert found.unresolved <= tolerance
    assert abs(found.reward - fine.reward) <= found.reward_error + 1e-7
    # Rewards are 10 and 11: half of the difference on what is unresolved.
    assert found.reward_error == pytest.approx(0.5 * found.unresolved)
    assert np.all(found.goal_probability <= fine.goal_probability + 1e-12)
    assert np.all(found.goal_probability >= fine.goal_probability - found.unresolved - 1e-7)


def test_it_looks_closer_until_the_tolerance_is_met(monkeypatch: pytest.MonkeyPatch) -> None:
    partner = SimulatedPartner(0.5)
    expected = evaluate(ROBOTS[0], partner, tolerance=1e-6)
    # A first attempt that leaves out everything.
    monkeypatch.setattr(evaluation, "FIRST_THRESHOLD", 1e7)
    found = evaluate(ROBOTS[0], partner, tolerance=1e-6)
    assert found.unresolved <= 1e-6
    np.testing.assert_allclose(found.goal_probability, expected.goal_probability, atol=2e-6)


@pytest.mark.parametrize("tolerance", [0.0, 1e-17, -1.0, float("nan")])
def test_a_tolerance_that_rounding_may_never_meet_is_refused(tolerance: float) -> None:
    with pytest.raises(ValueError, match="tolerance"):
        evaluate(ROBOTS[0], SimulatedPartner(0.5), tolerance=tolerance)


def test_the_robot_without_adaptation_by_hand() -> None:
    # b to c to d in two moves, whatever the person does. Up is seen as low with 4/19 and 1/7.
    found = evaluate(NoAdaptation(MODEL), SimulatedPartner(0.0, LOW))
    assert (found.reward, found.steps) == (pytest.approx(7.0), pytest.approx(2.0))
    np.testing.assert_allclose(found.goal_probability, [0.0, 1.0], atol=1e-12)
    assert found.disagreement == pytest.approx(15 / 19 + 6 / 7)
    # Up is the input in low with 1/5 in b and 1/10 in c.
    assert found.overridden == pytest.approx(0.8 + 0.9)
    # C = -1, gamma = 1/2: the penalties, and 7 after two moves.
    assert found.discounted_return == pytest.approx(-15 / 19 - 6 / 7 / 2 + 7 / 4)
    # Who adapts with certainty is in high in c with 15/19.
    follows = evaluate(NoAdaptation(MODEL), SimulatedPartner(1.0, LOW))
    assert follows.disagreement == pytest.approx(15 / 19 + 4 / 19 * 6 / 7 + 15 / 19 * 1 / 7)


def test_an_endless_course_ends_at_the_limit() -> None:
    robot = MutualAdaptation(MODEL, always(UP, UP, 0, UP), MatchRule(2.0))
    found = evaluate(robot, SimulatedPartner(0.5), max_steps=11)
    assert found.steps == pytest.approx(11.0)
    assert found.unresolved == pytest.approx(1.0)
    assert found.goal_probability.tolist() == [0.0, 0.0]
    # The middle of 5 and 7, and either may be wrong by 1.
    assert (found.reward, found.reward_error) == (pytest.approx(6.0), pytest.approx(1.0))


def test_the_evaluation_leaves_the_robot_usable() -> None:
    robot = MutualAdaptation(MODEL, always(UP, UP, UP, UP))
    before = robot.decide(B, UP)
    evaluate(robot, SimulatedPartner(0.5))
    robot.reset()
    after = robot.decide(B, UP)
    np.testing.assert_array_equal(before.belief, after.belief)
    assert replace(before, belief=0, forecast=0) == replace(after, belief=0, forecast=0)
