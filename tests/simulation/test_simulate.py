"""Simulated episodes depend on the seed alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from coadapt import Episode, SimulatedPartner, simulate
from coadapt.formalism import Model
from coadapt.robots import NEVER_MATCH, MutualAdaptation, NoAdaptation
from coadapt.simulation import Person
from tests.robots.worlds import DOWN, HIGH, LOW, MODEL, UP, B, always, towards_the_likelier

ROBOT = MutualAdaptation(MODEL, towards_the_likelier(), NEVER_MATCH)
PARTNER = SimulatedPartner(0.5)


def course(episodes: list[Episode]) -> list[tuple[object, ...]]:
    return [(e.states, e.inputs, e.actions, e.modes, e.goal, e.disagreement) for e in episodes]


def test_a_seed_repeats_the_episodes() -> None:
    first = simulate(ROBOT, PARTNER, 50, np.random.default_rng(3))
    again = simulate(ROBOT, PARTNER, 50, np.random.default_rng(3))
    other = simulate(ROBOT, PARTNER, 50, np.random.default_rng(4))
    assert course(first) == course(again)
    assert course(first) != course(other)
    assert len(set(map(str, course(first)))) > 5  # and they differ among themselves


def test_the_number_of_processes_changes_nothing() -> None:
    alone = simulate(ROBOT, PARTNER, 21, np.random.default_rng(3), processes=1)
    spread = simulate(ROBOT, PARTNER, 21, np.random.default_rng(3), processes=2)
    assert course(alone) == course(spread)
    for one, other in zip(alone, spread, strict=True):
        for a, b in zip(one.decisions, other.decisions, strict=True):
            np.testing.assert_array_equal(a.belief, b.belief)


def test_further_episodes_do_not_change_the_first_ones() -> None:
    few = simulate(ROBOT, PARTNER, 5, np.random.default_rng(3))
    many = simulate(ROBOT, PARTNER, 20, np.random.default_rng(3))
    assert course(few) == course(many)[:5]


def test_episodes_are_those_of_the_partner() -> None:
    for episode in simulate(ROBOT, SimulatedPartner(0.0, HIGH), 30, np.random.default_rng(0)):
        assert set(episode.modes) == {HIGH}
        assert episode.goal is not None
        assert episode.states[0] == B
        assert None not in episode.inputs


def test_an_endless_episode_is_given_up() -> None:
    # Down in c leads back to b, up in b to c: for ever.
    robot = MutualAdaptation(MODEL, always(UP, UP, DOWN, UP), NEVER_MATCH)
    (episode,) = simulate(robot, PARTNER, 1, np.random.default_rng(0), max_steps=7)
    assert (episode.steps, episode.goal, episode.reward) == (7, None, 0.0)


def test_no_episodes() -> None:
    assert simulate(ROBOT, PARTNER, 0, np.random.default_rng(0)) == []
    assert simulate(ROBOT, PARTNER, 0, np.random.default_rng(0), processes=2) == []


@dataclass(frozen=True)
class Script:
    """Somebody who gives these inputs by turns, and counts the turns in their mode."""

    inputs: tuple[int | None, ...]

    def begin(
        self, model: Model, state: int, before: Person | None, rng: np.random.Generator
    ) -> Person:
        return Person(LOW)

    def act(self, model: Model, state: int, person: Person, rng: np.random.Generator) -> int | None:
        return self.inputs[person.mode]

    def react(
        self,
        model: Model,
        window: int,
        person: Person,
        action: int,
        outcome: int,
        rng: np.random.Generator,
    ) -> Person:
        return Person((person.mode + 1) % len(self.inputs))


def test_any_partner_will_do() -> None:
    (episode,) = simulate(NoAdaptation(MODEL), Script((None, DOWN)), 1, np.random.default_rng(0))
    assert (episode.inputs, episode.modes, episode.actions) == ((None, DOWN), (0, 1), (UP, UP))


def test_bad_numbers_are_refused() -> None:
    with pytest.raises(ValueError, match="episodes must be at least 0"):
        simulate(ROBOT, PARTNER, -1, np.random.default_rng(0))
    with pytest.raises(ValueError, match="processes must be at least 1"):
        simulate(ROBOT, PARTNER, 1, np.random.default_rng(0), processes=0)
