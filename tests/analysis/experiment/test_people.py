"""Participants of experiments who differ in how they deviate from the model."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.analysis.adaptability.beta import alpha_grid
from coadapt.analysis.experiment.people import People, Rates
from coadapt.analysis.experiment.pool import Protocol, simulate_pool
from coadapt.human import Adaptability
from coadapt.robots import NEVER_MATCH, MutualAdaptation
from coadapt.simulation import simulate_batch
from coadapt.simulation.partners import DrawnPartner, Lapsing, Noisy
from tests.robots.worlds import LOW, MODEL, towards_the_likelier

ROBOT = MutualAdaptation(MODEL, towards_the_likelier(), NEVER_MATCH)
PROTOCOL = Protocol(2, first_mode=LOW)


@given(
    mean=st.floats(0, 1), part=st.floats(0, 1), count=st.integers(0, 50), seed=st.integers(0, 999)
)
def test_rates_stay_in_their_range(mean: float, part: float, count: int, seed: int) -> None:
    rates = Rates(mean, part * np.sqrt(mean * (1 - mean)))
    drawn = rates.draw(count, np.random.default_rng(seed))
    assert drawn.shape == (count,)
    assert np.all((drawn >= 0) & (drawn <= 1))
    if not rates.varies:
        assert np.all(drawn == mean)


@given(noise=st.floats(0, 1), lapses=st.floats(0, 1), steps=st.floats(1, 1e6))
def test_everybody_can_be_simulated(noise: float, lapses: float, steps: float) -> None:
    people = People(Rates(noise), Rates(lapses), steps)
    (person,) = people.draw(0.5, LOW, 1, np.random.default_rng(0))
    tables = person.tables(MODEL).checked(MODEL)
    # Whoever lapses has each kind twice; lapses fill their share of all steps from the first on.
    absent = tables.first_kind @ (tables.uses > 0)
    assert absent == pytest.approx(lapses, abs=2e-9)
    assert tables.first_kind @ tables.change == pytest.approx(tables.first_kind, abs=1e-9)


def test_rates_have_their_mean_and_deviation() -> None:
    count = 40_000
    drawn = Rates(0.1, 0.05).draw(count, np.random.default_rng(0))
    assert drawn.mean() == pytest.approx(0.1, abs=4 * 0.05 / np.sqrt(count))
    # The error of a standard deviation is about sd / √(2 n), a little more where tails are long.
    assert drawn.std() == pytest.approx(0.05, abs=6 * 0.05 / np.sqrt(2 * count))


@pytest.mark.parametrize("who", [None, People(), People(Rates(0.0), Rates(0.0), 7.0)])
def test_without_noise_people_are_those_who_follow_the_model(who: People | None) -> None:
    pool = simulate_pool(ROBOT, PROTOCOL, np.random.default_rng(3), who=who, points=4, people=30)
    rng = np.random.default_rng(3)
    for j, alpha in enumerate(alpha_grid(4).tolist()):
        plain = DrawnPartner(Adaptability.over((alpha,)), LOW)
        found = simulate_batch(ROBOT, plain, 30, rng, trials=2)
        np.testing.assert_array_equal(pool.performance[j], found.reward.mean(axis=1))
        np.testing.assert_array_equal(pool.optimal[j], found.goal == MODEL.world.optimal_goal)


def test_the_same_rates_for_all_are_the_partners_of_the_simulation() -> None:
    who = People(Rates(0.2), Rates(0.3), 2.0)
    pool = simulate_pool(ROBOT, PROTOCOL, np.random.default_rng(3), who=who, points=2, people=50)
    rng = np.random.default_rng(3)
    for j, alpha in enumerate((0.0, 1.0)):
        person = Noisy(Lapsing(DrawnPartner(Adaptability.over((alpha,)), LOW), 0.3, 2.0), 0.2)
        found = simulate_batch(ROBOT, person, 50, rng, trials=2)
        np.testing.assert_array_equal(pool.performance[j], found.reward.mean(axis=1))


def test_a_population_lies_between_its_parts() -> None:
    # With SD = √(mean (1 - mean)) a part of the people slips always and the others never.
    count = 3000
    protocol = Protocol(1, first_mode=LOW)

    def optimal(rates: Rates) -> float:
        pool = simulate_pool(
            ROBOT, protocol, np.random.default_rng(0), who=People(rates), points=2, people=count
        )
        return float(pool.optimal[0].mean())

    never, always, mixed = optimal(Rates(0.0)), optimal(Rates(1.0)), optimal(Rates(0.4, 0.24**0.5))
    assert abs(never - always) > 0.3
    # Five share a rate: a share of 3000 / 5 people has an error of at most 1 / √600 / 2.
    assert mixed == pytest.approx(0.6 * never + 0.4 * always, abs=4 * 0.5 / np.sqrt(count / 5))


def test_bad_rates_are_refused() -> None:
    with pytest.raises(ValueError, match="no population"):
        Rates(0.1, 0.4)
    with pytest.raises(ValueError, match="no population"):
        Rates(1.5)
    with pytest.raises(ValueError, match="a lapse lasts 1 step"):
        People(lapse_steps=0.5)
