"""Simulated people do what the adaptation model says."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from coadapt import SharedAutonomy, SimulatedPartner
from coadapt.human import mode_transition
from coadapt.simulation.draw import draw
from coadapt.simulation.partners import Person, acting
from tests.formalism.strategies import models
from tests.momdp.strategies import random_rows
from tests.robots.worlds import DOWN, HIGH, LOW, MODEL, UP, B, C

DRAWS = 2000


def expect_frequencies(found: list[int], distribution: Any) -> None:
    """Within 5 standard errors in every place; exactly where the probability is 0 or 1."""
    chance = np.asarray(distribution)
    share = np.bincount(found, minlength=len(chance)) / len(found)
    error = np.sqrt(chance * (1 - chance) / len(found))
    assert np.all(np.abs(share - chance) <= 5 * error + 1e-12), (share, chance)


class Scripted:
    """A source of the given uniform numbers."""

    def __init__(self, *numbers: float) -> None:
        self.numbers = list(numbers)

    def random(self) -> float:
        return self.numbers.pop(0)


@pytest.mark.parametrize(
    ("number", "expected"),
    [(0.0, 1), (0.24, 1), (0.26, 2), (0.99, 2), (np.nextafter(1.0, 0.0), 2)],
)
def test_draws_by_one_number(number: float, expected: int) -> None:
    # Never the first or the last, which have probability 0, not even for the largest number.
    source: Any = Scripted(number)
    assert draw(np.array([0.0, 0.25, 0.75, 0.0]), source) == expected
    # Rounding leaves 1 - 1e-16 here; what is left over goes to the last possible index.
    source = Scripted(np.nextafter(1.0, 0.0))
    assert draw(np.array([0.1] * 10 + [0.0]), source) == 9


@given(st.integers(1, 5), st.integers(0, 2**32))
@settings(max_examples=10)
def test_draws_have_the_distribution(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    chance = random_rows(rng, (count,), 0.4)
    expect_frequencies([draw(chance, rng) for _ in range(DRAWS)], chance)


@given(models(memory=3), st.floats(0, 1), st.booleans(), st.integers(0, 2**32))
@settings(max_examples=10)
def test_inputs_and_modes_have_the_distributions_of_the_model(
    model: SharedAutonomy, alpha: float, by_goal: bool, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    world, modes = model.world, len(model.world.goals)
    towards = rng.random(modes) if by_goal else np.full(modes, alpha)
    partner = SimulatedPartner(towards.tolist() if by_goal else alpha)
    np.testing.assert_array_equal(partner.rates(modes), towards)
    window, action = int(rng.integers(len(model.windows))), int(rng.integers(world.actions))
    state = int(model.windows.state[window])
    mode = int(rng.integers(modes))
    assert model.mode_prior is not None
    person = acting(partner, model)
    start = model.world.start
    first = [person.begin(model, start, None, rng).mode for _ in range(DRAWS)]
    expect_frequencies(first, model.mode_prior)
    now = Person(mode, window=window)
    inputs = [person.act(model, state, now, rng) for _ in range(DRAWS)]
    expect_frequencies(inputs, model.modal_policies[mode, state])
    # Eq. 3-4, tested by itself in tests/human/test_adaptation.py.
    moves = mode_transition(towards, model.perceived[window, action])[mode]
    after = [person.react(model, window, now, action, 0, rng) for _ in range(DRAWS)]
    expect_frequencies([p.mode for p in after], moves)
    assert {p.window for p in after} == {model.windows.next[window, action, 0]}


def test_the_first_mode_may_be_given() -> None:
    rng = np.random.default_rng(0)
    for mode in (LOW, HIGH):
        partner = SimulatedPartner(0.5, mode)
        np.testing.assert_array_equal(partner.mode_distribution(MODEL), np.eye(2)[mode])
        person = acting(partner, MODEL)
        assert {person.begin(MODEL, B, None, rng).mode for _ in range(20)} == {mode}
    np.testing.assert_allclose(SimulatedPartner(0.5).mode_distribution(MODEL), [0.5, 0.5])


def modes_after(alpha: float, state: int, action: int, draws: int) -> list[int]:
    """The modes of somebody who was in mode low, after ``action``."""
    person, rng = acting(SimulatedPartner(alpha), MODEL), np.random.default_rng(0)
    now = Person(LOW, window=state)  # with a memory of one step windows are states
    return [person.react(MODEL, state, now, action, 0, rng).mode for _ in range(draws)]


def test_the_stubborn_stay_and_the_adaptable_follow() -> None:
    assert set(modes_after(0.0, B, UP, 50)) == {LOW}
    # Up in c is seen as high with 6/7, whatever the mode was.
    expect_frequencies(modes_after(1.0, C, UP, DRAWS), [1 / 7, 6 / 7])
    expect_frequencies(modes_after(1.0, C, DOWN, DRAWS), [9 / 13, 4 / 13])


@pytest.mark.parametrize("alpha", [-0.1, 1.1, float("nan"), (), (0.5, 1.1)])
def test_bad_adaptability_is_refused(alpha: Any) -> None:
    with pytest.raises(ValueError, match="adaptability"):
        SimulatedPartner(alpha)


def test_adaptability_for_another_number_of_goals() -> None:
    with pytest.raises(ValueError, match="given for 3 goals, expected 2"):
        acting(SimulatedPartner((0.1, 0.2, 0.3)), MODEL)


@pytest.mark.parametrize("mode", [-1, 2])
def test_unknown_modes_are_refused(mode: int) -> None:
    with pytest.raises(ValueError, match=f"mode {mode} is not one of 0 to 1"):
        acting(SimulatedPartner(0.5, mode), MODEL)
