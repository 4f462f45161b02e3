"""The sentence says what the robot did, whether it was asked for, and why."""

from __future__ import annotations

import numpy as np
import pytest

from coadapt.momdp import AlphaVectorPolicy
from coadapt.robots import MatchRule, MutualAdaptation, NoAdaptation, OneWayAdaptation, Robot
from coadapt.robots.explain import explain, percent
from coadapt.robots.setup import RobotSetup
from coadapt.simulation import Trial

LEFT, FORWARD, RIGHT = range(3)
SETUP = RobotSetup(columns=7, rows=3)


def robot(action: int, threshold: float = 0.9) -> MutualAdaptation:
    """A robot whose plan is always ``action``."""
    model = SETUP.model()
    states = model.world.states
    policy = AlphaVectorPolicy(
        start=np.arange(states + 1),
        vectors=np.zeros((states, model.prior.size)),
        actions=np.full(states, action),
    )
    return MutualAdaptation(model, policy, MatchRule(threshold))


def sentence(robot: Robot, *inputs: int | None) -> str:
    trial = Trial(robot)
    decisions = [trial.step(given) for given in inputs]
    text = explain(robot, decisions[-1])
    assert text.endswith(".")
    assert text.isprintable()
    assert "  " not in text
    return text


def test_against_the_input() -> None:
    text = sentence(robot(RIGHT), LEFT)
    assert text.startswith("The robot goes right although you ask for left: ")
    assert "heads for the right goal" in text
    assert "below the 90% from which it does what you ask" in text
    # With all alpha vectors 0 an action is worth what it costs now, C times the chance that the
    # person sees another mode than theirs: after "left" nearly certainly, so about -0.32.
    assert "worth -0.31" in text
    assert "(left -0.0" in text


def test_forward_keeps_the_goal_open() -> None:
    # From the middle of the first row both goals are equally far, so forward tells nothing.
    assert "keeps its goal open" in sentence(robot(FORWARD), LEFT)


def test_as_asked_without_the_match_rule() -> None:
    text = sentence(robot(FORWARD), FORWARD)
    assert text.startswith("The robot goes forward, as you ask and as it planned: this ")


def test_no_input() -> None:
    text = sentence(robot(RIGHT), None)
    assert text.startswith("The robot goes right, and you asked for nothing: this heads for")


def test_the_match_rule_changes_the_action() -> None:
    text = sentence(robot(LEFT), LEFT, LEFT, FORWARD)
    assert text.startswith("The robot goes forward, as you ask, instead of left, its plan: ")
    assert "sure that you both head for the same goal, and 90% is enough; forward is worth" in text


def test_the_match_rule_agrees_with_the_plan() -> None:
    text = sentence(robot(LEFT), LEFT)
    assert text.startswith("The robot goes left, as you ask and as it planned: it is 9")


def test_a_robot_that_never_drops_its_plan() -> None:
    text = sentence(robot(LEFT, threshold=2), LEFT, LEFT, FORWARD)
    assert text.endswith("it keeps to its plan however sure it is of your goal.")


def test_just_below_the_threshold() -> None:
    # Forward from the start tells nothing: the agreement is 1/2.
    text = sentence(robot(FORWARD, threshold=0.5 + 1e-9), LEFT)
    assert "it is 50% sure" in text
    assert "just below the 50%" in text


@pytest.mark.parametrize("given", [LEFT, FORWARD, RIGHT, None])
def test_no_adaptation(given: int | None) -> None:
    assert sentence(NoAdaptation(SETUP.model()), given) == (
        "The robot goes forward whatever you ask: it takes the shortest way to the right goal, "
        "worth 11."
    )


def test_one_way_adaptation() -> None:
    model = SETUP.model()
    states = model.world.states
    policy = AlphaVectorPolicy(
        start=np.arange(states + 1),
        vectors=np.zeros((states, 2)),
        actions=np.full(states, LEFT),
    )
    text = sentence(OneWayAdaptation(model, policy), LEFT)
    assert text.startswith("The robot goes left, as you ask and as it planned")


@pytest.mark.parametrize(
    ("probability", "text"),
    [(0, "0%"), (1e-9, "<1%"), (0.005, "0%"), (0.5, "50%"), (0.9949, "99%"), (0.996, ">99%"),
     (1, "100%")],
)  # fmt: skip
def test_percent(probability: float, text: str) -> None:
    assert percent(probability) == text
