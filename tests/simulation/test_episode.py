"""Trials and their records."""

from __future__ import annotations

import math

import numpy as np
import pytest

from coadapt import Episode, Trial
from coadapt.robots import NEVER_MATCH, NO_INPUT, MutualAdaptation, NoAdaptation
from coadapt.simulation import UNKNOWN_MODE, Trials
from tests.robots.worlds import DOWN, HIGH, LOW, MODEL, UP, A, B, C, D, always, towards_the_likelier


def robot() -> MutualAdaptation:
    return MutualAdaptation(MODEL, towards_the_likelier(), NEVER_MATCH)


def test_a_trial_from_start_to_goal() -> None:
    trial = Trial(robot())
    assert (trial.state, trial.steps, trial.done) == (B, 0, False)
    first = trial.step(UP, HIGH)
    assert (first.state, first.human_input, first.action) == (B, UP, UP)
    assert (trial.state, trial.steps, trial.done) == (C, 1, False)
    # Down in c speaks for low, but not enough after up in b: 0.2 * 0.9 against 0.75 * 0.4.
    second = trial.step(DOWN, HIGH)
    assert second.action == UP
    assert (trial.state, trial.steps, trial.done) == (D, 2, True)
    episode = trial.episode()
    assert (episode.robot, episode.world) == ("mutual_adaptation", "row")
    assert (episode.states, episode.inputs, episode.actions) == ((B, C, D), (UP, DOWN), (UP, UP))
    assert (episode.modes, episode.steps) == ((HIGH, HIGH), 2)
    assert (episode.final_state, episode.goal, episode.reward) == (D, 1, 7.0)
    assert episode.overridden == 1
    # Up is seen as low with 0.2 / 0.95 in b and 0.1 / 0.7 in c; the person is in high.
    assert episode.disagreement == pytest.approx(4 / 19 + 1 / 7)
    with pytest.raises(ValueError, match="the task has ended"):
        trial.step(UP)


def test_a_trial_is_what_its_robot_decides() -> None:
    # Up whatever the person does, so that what they see is not what they asked for.
    robots = [MutualAdaptation(MODEL, always(UP, UP, UP, UP), NEVER_MATCH) for _ in range(2)]
    alone, trial = robots[0], Trial(robots[1])
    for human_input in (DOWN, UP):
        expected = alone.decide(trial.state, human_input)
        found = trial.step(human_input)
        np.testing.assert_array_equal(found.belief, expected.belief)
        np.testing.assert_array_equal(found.forecast, expected.forecast)
        assert (found.action, found.agreement) == (expected.action, expected.agreement)
        assert np.abs(found.belief - found.forecast).max() > 0.05


def test_without_a_goal_there_is_no_reward() -> None:
    trial = Trial(robot())
    empty = trial.episode()
    assert (empty.steps, empty.states, empty.goal, empty.reward) == (0, (B,), None, 0.0)
    assert empty.disagreement == 0.0
    trial.step(UP, LOW)
    half = trial.episode()
    assert (half.steps, half.states, half.goal, half.reward) == (1, (B, C), None, 0.0)


def test_where_a_mode_is_unknown_so_is_the_disagreement() -> None:
    trial = Trial(robot())
    trial.step(UP, HIGH)
    assert trial.episode().disagreement == pytest.approx(4 / 19)
    trial.step(None)
    episode = trial.episode()
    assert episode.modes == (HIGH, UNKNOWN_MODE)
    assert math.isnan(episode.disagreement)
    assert episode.inputs == (UP, None)
    assert episode.overridden == 0  # no input, nothing to override


def test_a_trial_may_begin_with_another_belief() -> None:
    carried = np.array([[0.0, 0.0], [1.0, 0.0]])
    trial = Trial(robot(), carried)
    first = trial.step(None)
    np.testing.assert_array_equal(first.belief, carried)
    assert (first.action, trial.state) == (DOWN, A)


def test_bad_inputs_are_refused_and_leave_no_trace() -> None:
    trial = Trial(robot())
    with pytest.raises(ValueError, match="input 2 is not one of 0 to 1"):
        trial.step(2)
    assert (trial.state, trial.steps, trial.episode().steps) == (B, 0, 0)


def test_trials_side_by_side_do_not_mix() -> None:
    scripts = [[UP, DOWN], [DOWN], [None, UP, UP]]
    expected: list[Episode] = []
    for script in scripts:
        trial = Trial(robot())
        for human_input in script:
            if not trial.done:
                trial.step(human_input, LOW)
        expected.append(trial.episode())
    trials = Trials(robot(), 3)
    for t in range(3):
        running = trials.running
        inputs = [scripts[i][t] for i in running.tolist()]
        numbers = np.array([NO_INPUT if i is None else i for i in inputs], dtype=np.int64)
        trials.step(running, numbers, np.full(len(running), LOW))
    assert len(trials.running) == 0
    for i, episode in enumerate(expected):
        found = trials.episode(i)
        assert (found.states, found.inputs, found.actions) == (
            episode.states,
            episode.inputs,
            episode.actions,
        )
        assert (found.goal, found.reward, found.modes) == (
            episode.goal,
            episode.reward,
            episode.modes,
        )
        assert found.disagreement == pytest.approx(episode.disagreement)
        for one, other in zip(found.decisions, episode.decisions, strict=True):
            np.testing.assert_array_equal(one.belief, other.belief)


def test_a_robot_that_ignores_people_overrides_them() -> None:
    trial = Trial(NoAdaptation(MODEL))
    while not trial.done:
        trial.step(DOWN, LOW)
    episode = trial.episode()
    assert (episode.actions, episode.overridden, episode.goal) == ((UP, UP), 2, 1)
    assert episode.disagreement == pytest.approx(15 / 19 + 6 / 7)
