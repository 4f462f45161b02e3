"""People who break the model: each by the definition of what they do."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from coadapt import Collaboration, SharedAutonomy, SimulatedPartner, simulate, simulate_batch
from coadapt.human import Adaptability, Inputs
from coadapt.human.modal import maximum_entropy_policy
from coadapt.robots import NEVER_MATCH, MutualAdaptation, NoAdaptation
from coadapt.simulation import DrawnPartner, PartnerTables
from coadapt.simulation.partners import (
    KINDS,
    Contrarian,
    Lapsing,
    Noisy,
    OwnMemory,
    PartnerError,
    Person,
    Tempered,
    Wandering,
    Yielding,
    acting,
    drifting,
    partner_from,
    tiring,
)
from coadapt.simulation.partners.tables import inputs_of
from coadapt.worlds import table_carrying, table_clearing
from tests.robots.worlds import HIGH, LOW, MODEL, UP, C, towards_the_likelier
from tests.simulation.test_partner import DRAWS, expect_frequencies

PLAIN = SimulatedPartner(0.5, LOW)
GRID = SharedAutonomy(table_clearing(7, 3))


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def test_slips_go_to_the_other_inputs() -> None:
    # Down from c with 9 of 10 (tests/robots/worlds.py), and 1 of 5 slips to the only other input.
    person = acting(Noisy(PLAIN, 0.2), MODEL)
    found = [person.act(MODEL, C, Person(LOW), source) or 0 for source in [rng()] * DRAWS]
    expect_frequencies(found, [0.9 * 0.8 + 0.1 * 0.2, 0.9 * 0.2 + 0.1 * 0.8])


def test_slips_are_those_that_inputs_can_tell_of() -> None:
    # The same as an interface with slips, and silence stays as it is.
    names, directions = GRID.world.action_names, GRID.world.directions
    silent = replace(GRID, inputs=Inputs.actions(names, directions, silence=0.2))
    slips = replace(GRID, inputs=Inputs.actions(names, directions, slip=0.3, silence=0.2))
    np.testing.assert_allclose(
        Noisy(PLAIN, 0.3).tables(silent).inputs[0], inputs_of(slips), atol=1e-12
    )


def kinds_over_time(partner: DrawnPartner | Lapsing | Yielding, steps: int) -> np.ndarray[Any, Any]:
    """``[steps, DRAWS]`` the kind of many people, step by step."""
    person, source = acting(partner, MODEL), rng()
    found = np.empty((steps, DRAWS), dtype=np.int64)
    for i in range(DRAWS):
        now = person.begin(MODEL, C, None, source)
        for t in range(steps):
            found[t, i] = now.kind
            now = person.react(MODEL, C, now._replace(window=C), UP, 0, source)
    return found


@pytest.mark.parametrize("length", [None, 4.0])
def test_lapses_take_their_share_and_last_as_long(length: float | None) -> None:
    lapsed = kinds_over_time(Lapsing(PLAIN, 0.3, length), 12)
    for step in lapsed:
        expect_frequencies(step.tolist(), [0.7, 0.3])
    # A lapse goes on with 1 - 1 / length; with no length it is as likely as ever.
    goes_on = lapsed[1:][lapsed[:-1] == 1]
    share = 0.3 if length is None else 1 - 1 / length
    assert goes_on.mean() == pytest.approx(share, abs=5 * np.sqrt(0.25 / len(goes_on)))


def test_in_a_lapse_nothing_matters() -> None:
    person, source = acting(Lapsing(SimulatedPartner(1.0, LOW), 0.5), MODEL), rng()
    lapsed = Person(LOW, kind=1, window=C)
    inputs = [person.act(MODEL, C, lapsed, source) or 0 for _ in range(DRAWS)]
    expect_frequencies(inputs, [0.5, 0.5])
    assert {person.react(MODEL, C, lapsed, UP, 0, source).mode for _ in range(99)} == {LOW}


def test_the_stubborn_yield_when_their_time_has_come() -> None:
    partner = Yielding(1.0, 3, mode=LOW)
    assert kinds_over_time(partner, 6)[:, 0].tolist() == [0, 1, 2, 3, 3, 3]
    # In d's neighbour c, up is seen as high with 6 of 7: they follow only from the fourth step on.
    person, source = acting(partner, MODEL), rng()
    for kind, share in ((0, 0.0), (2, 0.0), (3, 6 / 7)):
        now = Person(LOW, kind, C)
        after = [person.react(MODEL, C, now, UP, 0, source).mode for _ in range(DRAWS)]
        expect_frequencies(after, [1 - share, share])


def test_steps_are_counted_through_all_trials() -> None:
    batch = simulate_batch(
        MutualAdaptation(MODEL, towards_the_likelier(), NEVER_MATCH),
        Yielding(1.0, 3, mode=LOW),
        50,
        rng(),
        trials=3,
    )
    before = np.cumsum(batch.steps, axis=1) - batch.steps
    np.testing.assert_array_equal(batch.first_kind, np.minimum(before, 3))


def test_drift_begins_where_it_is_told() -> None:
    for partner, sign in ((drifting(0.35, 0.5), 0), (tiring(0.35, 0.5), -1)):
        values = partner.adaptability.values
        assert values[np.argmax(partner.adaptability.prior)] == 0.35
        kinds = kinds_over_time(partner, 5)
        change = np.diff(values[kinds], axis=0)
        assert np.all(change <= 0) if sign else change.max() > 0
        moved = np.mean(np.diff(kinds, axis=0) != 0)
        assert moved == pytest.approx(0.5, abs=0.03)


def test_own_reasons_and_contrariness() -> None:
    source = rng()
    # Up in c is seen as high with 6/7. A contrarian of alpha 1 then wants low, and high after low.
    person = acting(Contrarian(SimulatedPartner(1.0)), MODEL)
    after = [person.react(MODEL, C, Person(LOW, 0, C), UP, 0, source).mode for _ in range(DRAWS)]
    expect_frequencies(after, [6 / 7, 1 / 7])
    # Who never adapts changes with the rate of their own reasons alone.
    person = acting(Wandering(SimulatedPartner(0.0), 0.2), MODEL)
    after = [person.react(MODEL, C, Person(HIGH, 0, C), UP, 0, source).mode for _ in range(DRAWS)]
    expect_frequencies(after, [0.2, 0.8])


def test_another_temperature_is_another_step_cost() -> None:
    world = GRID.world
    found = Tempered(PLAIN, 2.0).tables(GRID).inputs[0]
    for goal in (0, 1):
        other = world.goals[1 - goal].states
        policy = maximum_entropy_policy(world.moves, world.goals[goal].at, 1.5, other)
        np.testing.assert_allclose(found[:, goal, :-1], policy, atol=1e-12)
    assert not found[..., -1].any()


@pytest.mark.parametrize(("own", "assumed"), [(1, 3), (3, 1), (2, 2)])
def test_own_memory_is_that_of_a_model_with_this_memory(own: int, assumed: int) -> None:
    # The robot is deaf, so what people do depends on their own memory alone.
    right = replace(GRID, memory=own)
    robots = NoAdaptation(replace(GRID, memory=assumed)), NoAdaptation(right)
    partners = OwnMemory(SimulatedPartner(0.5), own), SimulatedPartner(0.5)
    a, b = (
        simulate_batch(robot, partner, 200, rng())
        for robot, partner in zip(robots, partners, strict=True)
    )
    for name in ("goal", "disagreement", "last_mode", "overridden", "switched"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
    assert 0 < a.switched.mean() < 1


def test_a_population_is_drawn_from_its_prior() -> None:
    partner = DrawnPartner(Adaptability.over((0.0, 0.5, 1.0), (0.2, 0.5, 0.3)))
    batch = simulate_batch(NoAdaptation(MODEL), partner, DRAWS, rng(), trials=2)
    expect_frequencies(batch.first_kind[:, 0].tolist(), [0.2, 0.5, 0.3])
    np.testing.assert_array_equal(batch.first_kind[:, 0], batch.last_kind[:, 1])


@pytest.mark.parametrize("name", KINDS)
def test_every_kind_has_a_name(name: str) -> None:
    description = {"kind": name, "adaptability": 0.7, "mode": "left", **KINDS[name].numbers}
    partner = partner_from(description, GRID.mode_names)
    (episode,) = simulate(NoAdaptation(GRID), partner, 1, rng())
    assert episode.modes[0] == 0


def test_descriptions_are_what_they_say() -> None:
    assert partner_from({}) == SimulatedPartner(0.5)
    assert partner_from({"adaptability": [0.1, 1], "mode": 1}) == SimulatedPartner((0.1, 1.0), 1)
    inner = {"kind": "contrarian", "adaptability": 1, "mode": "high"}
    nested = partner_from({"kind": "noisy", "rate": 0.2, "of": inner}, ("low", "high"))
    assert nested == Noisy(Contrarian(SimulatedPartner(1.0, HIGH)), 0.2)
    assert partner_from({"kind": "yielding", "steps": 2}) == Yielding(0.5, 2)


@pytest.mark.parametrize(
    ("description", "message"),
    [
        ({"kind": "noise"}, "kind must be one of follower, memory"),
        ({"kind": 1}, "kind must be one of"),
        ({"kind": "noisy", "rate": "much"}, "rate must be a number, not 'much'"),
        (
            {"kind": "noisy", "rate": 2.0},
            "noisy cannot be used: rate of slips must lie in",
        ),
        ({"kind": "memory", "memory": 1.5}, "memory must be a whole number, not 1.5"),
        ({"kind": "noisy", "speed": 2}, "speed is not one of adaptability, mode, rate"),
        ({"adaptability": "all"}, "adaptability must be a number or a list"),
        ({"adaptability": 1.5}, "follower cannot be used: adaptability must lie"),
        ({"kind": "yielding", "adaptability": [0, 1]}, "adaptability must be one number"),
        ({"mode": "up"}, "mode must be one of low, high, not 'up'"),
        ({"kind": "yielding", "of": {}}, "of is for a table, around which yielding cannot"),
        ({"kind": "noisy", "of": {}, "mode": "low"}, "mode is not one of rate, of"),
        ({"kind": "lapsing", "rate": 0.9, "length": 1}, "cannot fill 0.9 of all steps"),
        ({"kind": "tempered", "temperature": 0}, "temperature must be above 0, not 0"),
    ],
)
def test_bad_descriptions_are_refused(description: dict[str, Any], message: str) -> None:
    with pytest.raises(PartnerError, match=message):
        partner_from(description, ("low", "high"))


def test_what_does_not_go_with_the_model_is_refused() -> None:
    with pytest.raises(ValueError, match="its policies are given"):
        Tempered(PLAIN, 2.0).tables(MODEL)
    with pytest.raises(ValueError, match=r"step cost 0\.3 is too small"):
        Tempered(PLAIN, 10.0).tables(GRID)
    with pytest.raises(ValueError, match="no temperature"):
        Tempered(PLAIN, 2.0).tables(Collaboration(table_carrying()))


def test_broken_tables_are_refused() -> None:
    good = PLAIN.tables(MODEL)

    class Broken:
        """Somebody whose tables are not right."""

        def __init__(self, tables: PartnerTables) -> None:
            self.wrong = tables

        def tables(self, model: SharedAutonomy) -> PartnerTables:
            return self.wrong

    for field, value, message in (
        ("wander", np.eye(3), "wander of the partner has shape"),
        ("first_mode", np.array([0.5, 0.6]), "first_mode of the partner must be non-negative"),
        ("rate", np.array([[0.5, 1.5]]), "rate of the partner must lie"),
        ("uses", np.array([1]), "uses of the partner must be indices below 1"),
        ("next", np.zeros((1, 2, 3), dtype=np.int64), "next of the partner must be indices"),
    ):
        partner = Broken(good._replace(**{field: value}))
        robot = NoAdaptation(MODEL)
        for run in (simulate, simulate_batch):
            with pytest.raises(ValueError, match=message):
                run(robot, partner, 1, rng())
