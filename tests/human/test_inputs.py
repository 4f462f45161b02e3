"""Inputs: what each says about the wish behind it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.human import Inputs
from coadapt.human.history import NO_ACTION
from coadapt.human.inputs import EIGHT_DIRECTIONS
from coadapt.worlds import FIVE_WAYS, THREE_WAYS
from tests.momdp.strategies import random_rows

THREE = np.array(list(THREE_WAYS.values()), dtype=np.float64)
FIVE = np.array(list(FIVE_WAYS.values()), dtype=np.float64)
SILENCES = st.one_of(st.just(0.0), st.floats(0.0, 0.9))


@st.composite
def interfaces(draw: st.DrawFn) -> Inputs:
    """Each kind, for the five actions of a grid."""
    kind = draw(st.sampled_from(("actions", "joystick", "switch")))
    silence = draw(SILENCES)
    if kind == "actions":
        return Inputs.actions(tuple(FIVE_WAYS), FIVE, draw(st.floats(0, 1)), silence)
    if kind == "joystick":
        return Inputs.joystick(FIVE, draw(st.floats(0, 500)), silence)
    pressed = draw(st.sets(st.integers(0, 4), min_size=1, max_size=4))
    return Inputs.switch(5, pressed, draw(st.floats(0, 0.5)), silence)


@given(interfaces(), st.integers(0, 2**32))
def test_observations_are_a_distribution(inputs: Inputs, seed: int) -> None:
    policies = random_rows(np.random.default_rng(seed), (2, 3, 5), 0.3)
    observed = inputs.observed(policies)
    assert observed.shape == (2, 3, len(inputs.observation_names))
    assert np.all(observed >= 0)
    np.testing.assert_allclose(observed.sum(axis=2), 1.0, atol=1e-12)
    if inputs.silence > 0:
        # No input is as likely whatever the mode.
        np.testing.assert_array_equal(observed[:, :, -1], inputs.silence)


def test_the_robots_own_actions_say_what_is_wanted() -> None:
    inputs = Inputs.actions(tuple(THREE_WAYS), THREE)
    policies = random_rows(np.random.default_rng(0), (2, 4, 3), 0.3)
    np.testing.assert_array_equal(inputs.observed(policies), policies)
    assert inputs.asked(np.array([2, -1, 0])).tolist() == [2, NO_ACTION, 0]
    slipping = Inputs.actions(tuple(THREE_WAYS), THREE, slip=0.3)
    np.testing.assert_allclose(slipping.likelihood[0], [0.7, 0.15, 0.15])


def test_a_joystick_points_near_what_is_wanted() -> None:
    inputs = Inputs.joystick(THREE, concentration=4.0)
    place = {name: i for i, name in enumerate(inputs.names)}
    wanted = dict(zip(THREE_WAYS, inputs.likelihood, strict=True))
    # exp(4 cos(n 45 degrees)) over its sum, and alike to both sides.
    weights = np.exp(4 * np.cos(np.arange(8) * np.pi / 4))
    assert wanted["left"][place["left"]] == pytest.approx(weights[0] / weights.sum())
    assert wanted["left"][place["forward left"]] == pytest.approx(weights[1] / weights.sum())
    assert wanted["left"][place["back left"]] == pytest.approx(weights[1] / weights.sum())
    asks = {name: int(inputs.asks[i]) for name, i in place.items()}
    left, forward, right = range(3)
    assert asks["left"] == asks["back left"] == left
    assert asks["right"] == asks["back right"] == right
    assert asks["forward"] == forward
    assert asks["back"] == NO_ACTION
    # Without aim, and for a wish that points nowhere, all directions are alike.
    np.testing.assert_allclose(Inputs.joystick(THREE, 0.0).likelihood, 1 / 8)
    np.testing.assert_allclose(Inputs.joystick(FIVE).likelihood[4], 1 / 8)
    assert list(EIGHT_DIRECTIONS) == list(inputs.names)


def test_a_switch_is_pressed_for_some_actions() -> None:
    inputs = Inputs.switch(3, [1], error=0.1)
    np.testing.assert_allclose(inputs.likelihood, [[0.1, 0.9], [0.9, 0.1], [0.1, 0.9]])
    assert inputs.asks.tolist() == [1, NO_ACTION]
    assert Inputs.switch(2, [0]).asks.tolist() == [0, 1]


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        (dict(names=("a", "a")), "must differ"),
        (dict(names=("a", "none")), "must differ"),
        (dict(likelihood=np.array([[0.5, 0.4], [1.0, 0.0]])), "likelihood of inputs must be"),
        (dict(asks=np.array([0])), "one action asked for"),
        (dict(asks=np.array([0, 2])), "must ask for actions 0 to 1"),
        (dict(silence=1.0), "silence must lie in"),
    ],
)
def test_bad_inputs_are_refused(parts: dict[str, Any], message: str) -> None:
    good = Inputs(("a", "b"), np.eye(2), np.array([0, 1]), np.zeros((2, 2)))
    with pytest.raises(ValueError, match=message):
        replace(good, **parts)


@pytest.mark.parametrize("pressed", [[], [0, 1, 2], [3], [-1]])
def test_a_switch_for_nothing_or_everything_is_refused(pressed: list[int]) -> None:
    with pytest.raises(ValueError, match="pressed for some of the actions 0 to 2"):
        Inputs.switch(3, pressed)


def test_other_numbers_out_of_range_are_refused() -> None:
    with pytest.raises(ValueError, match="slip must lie in"):
        Inputs.actions(("a",), np.zeros((1, 2)), slip=1.1)
    with pytest.raises(ValueError, match="concentration must lie in"):
        Inputs.joystick(THREE, -1.0)
    with pytest.raises(ValueError, match="error must lie in"):
        Inputs.switch(3, [0], error=0.6)
