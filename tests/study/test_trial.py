"""Attempts at trials and training sessions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from coadapt.formalism import SharedAutonomy
from coadapt.study.protocol import Study
from coadapt.study.protocol.reader import template
from coadapt.study.robots import load_robots
from coadapt.study.session import Stage, decode_event, encode_event
from coadapt.study.trial import Attempt, Practice, wanted_goal
from coadapt.toml import parse_toml
from coadapt.worlds import table_clearing

STUDY, _ = parse_toml(template(), "study.toml", Study, "a study")
LEFT, FORWARD, RIGHT = range(3)


@pytest.fixture(scope="module")
def directory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("study")


def attempt(directory: Path, condition: str, choice: int, **given: object) -> Attempt:
    robot = load_robots(STUDY, directory)[condition, choice]
    rng = np.random.default_rng(0)
    belief = given.get("belief")
    most = given.get("most_steps", 200)
    return Attempt(robot, Stage("trial", 1), 1, belief, rng, most)  # pyright: ignore


@pytest.mark.parametrize("choice", [LEFT, 1])
def test_the_goal_not_chosen_is_the_optimal_one(directory: Path, choice: int) -> None:
    # Sec. 6.3: "we set the robot policy, so that the other bottle was the optimal goal".
    model = attempt(directory, "mutual_adaptation", choice).robot.model
    assert model.world.optimal_goal == 1 - choice
    assert model.world.goals[1 - choice].reward == 11
    assert model.world.goals[choice].reward == 10
    deaf = attempt(directory, "no_adaptation", choice)
    while not deaf.done:
        deaf.step(LEFT if choice == 0 else RIGHT)
    assert deaf.finished().goal == 1 - choice


def test_one_way_follows(directory: Path) -> None:
    follower = attempt(directory, "one_way_adaptation", 0)
    likelihood = follower.robot.model.input_likelihood
    while not follower.done:
        follower.step(int(likelihood[follower.state, :, 0].argmax()))
    assert follower.finished().goal == 0
    assert follower.finished().wanted == 0


def test_steps_are_the_robots_own_decisions(directory: Path) -> None:
    under_way = attempt(directory, "mutual_adaptation", 0)
    robot = load_robots(STUDY, directory)["mutual_adaptation", 0]
    robot.reset()
    inputs = [LEFT, LEFT, None, RIGHT, RIGHT, FORWARD, RIGHT, RIGHT]
    for given in inputs:
        stepped = under_way.step(given)
        decision = robot.decide(stepped.state, given)
        assert stepped.action == decision.action
        assert stepped.belief == tuple(map(tuple, decision.belief.tolist()))
        assert decode_event(encode_event(stepped)) == stepped


def test_attempts_with_one_robot_do_not_disturb_each_other(directory: Path) -> None:
    alone = attempt(directory, "mutual_adaptation", 0)
    expected = [alone.step(LEFT) for _ in range(5)]
    robot = alone.robot
    rng = np.random.default_rng(0)
    a, b = (Attempt(robot, Stage("trial", 1), 1, None, rng, 200) for _ in range(2))
    found = []
    for _ in range(5):
        found.append(a.step(LEFT))
        b.step(RIGHT)
    assert found == expected


def test_a_carried_belief_is_where_the_next_trial_starts(directory: Path) -> None:
    first = attempt(directory, "mutual_adaptation", 0)
    while not first.done:
        first.step(LEFT)
    forecast = first.finished().forecast
    second = attempt(directory, "mutual_adaptation", 0, belief=forecast)
    assert second.began.belief == forecast
    assert second.step(LEFT).belief != attempt(directory, "mutual_adaptation", 0).step(LEFT).belief


def test_a_trial_ends_when_its_steps_run_out(directory: Path) -> None:
    short = attempt(directory, "mutual_adaptation", 0, most_steps=2)
    short.step(LEFT)
    assert not short.done
    short.step(LEFT)
    assert short.done
    assert short.finished().goal is None


def test_in_training_the_robot_does_what_is_asked() -> None:
    model = SharedAutonomy(table_clearing())
    session = Practice(model, Stage("practice", 1), 1, np.random.default_rng(0), 50)
    stayed = session.step(None)
    assert (stayed.action, stayed.reached) == (None, model.world.start)
    for given in (FORWARD, FORWARD, FORWARD):
        assert session.step(given).action == given
    while not session.done:
        session.step(RIGHT)
    assert session.finished().goal == 1
    with pytest.raises(ValueError, match="is done"):
        session.step(RIGHT)


def test_which_goal_an_input_is_for() -> None:
    model = SharedAutonomy(table_clearing())
    assert wanted_goal(model, model.world.start, LEFT) == 0
    assert wanted_goal(model, model.world.start, RIGHT) == 1
    # In the middle "forward" is on the way to both.
    assert wanted_goal(model, model.world.start, FORWARD) is None
    assert wanted_goal(model, model.world.start, None) is None
