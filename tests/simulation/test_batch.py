"""Compiled episodes are those of the loop, to the bit."""

from __future__ import annotations

from dataclasses import fields
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from coadapt import Batch, SharedAutonomy, SimulatedPartner, evaluate, simulate, simulate_batch
from coadapt.formalism import Collaboration, Model
from coadapt.human import Adaptability
from coadapt.robots import NEVER_MATCH, Decider, MutualAdaptation
from coadapt.simulation.batch import batch_of
from coadapt.simulation.draw import Streams
from coadapt.simulation.partners import (
    ActingPartner,
    Contrarian,
    DescribedPartner,
    DrawnPartner,
    Lapsing,
    Noisy,
    OwnMemory,
    Wandering,
    Yielding,
    acting,
)
from coadapt.simulation.schedule import Schedule
from coadapt.simulation.simulate import courses
from coadapt.tasks.registry import load_task, task_names
from coadapt.worlds import hallway
from coadapt.worlds.world import NO_GOAL
from tests.formalism.joint_strategies import collaborations
from tests.formalism.strategies import models
from tests.robots.worlds import LOW, MODEL, towards_the_likelier
from tests.simulation.strategies import robots_for

SEED = 4


def require_equal(a: Batch, b: Batch) -> None:
    """To the bit, in every field."""
    for field in fields(Batch):
        one, other = getattr(a, field.name), getattr(b, field.name)
        np.testing.assert_array_equal(one, other, err_msg=field.name)
        assert one is None or one.dtype == other.dtype, field.name


def both(robot: Decider, partner: DescribedPartner, n: int, **schedule: int) -> tuple[Batch, Batch]:
    """The compiled episodes and those of the loop, for the same seed."""
    compiled = simulate_batch(
        robot, partner, n, np.random.default_rng(SEED), beliefs=True, **schedule
    )
    streams = Streams.of(np.random.default_rng(SEED))
    found = courses(robot, partner, streams, range(n), Schedule(**schedule))
    return compiled, batch_of(robot, found, schedule.get("trials", 1), beliefs=True)


@cache
def task(name: str) -> Model:
    return load_task(name).build()


def everybody(model: Model) -> list[DescribedPartner]:
    """One partner of each kind that the model allows."""
    modes = len(model.world.goals)
    plain = SimulatedPartner(0.6)
    alpha = Adaptability.over((0.2, 0.5, 1.0)).drifting(0.4)
    found: list[DescribedPartner] = [
        plain,
        SimulatedPartner(np.linspace(0.2, 1, modes).tolist(), modes - 1),
        Wandering(Contrarian(plain), 0.2),
        DrawnPartner(alpha, 0),
        Yielding(0.9, 3, mode=0),
    ]
    if isinstance(model, SharedAutonomy) or model.hidden_modes:
        # Where modes are seen nobody can act in none.
        found.append(Lapsing(DrawnPartner(alpha), 0.3, 2.0))
    if isinstance(model, SharedAutonomy):
        found.append(Noisy(Lapsing(plain, 0.2), 0.3))
        found.append(OwnMemory(plain, 2))
    return found


@pytest.mark.parametrize("name", task_names())
def test_every_task_robot_and_partner(name: str) -> None:
    model = task(name)
    for robot in robots_for(model, np.random.default_rng(0)):
        for partner in everybody(model):
            require_equal(*both(robot, partner, 6, trials=2, max_steps=15))


@given(models(memory=2, general=True), st.integers(0, 2**32))
@settings(max_examples=25)
def test_every_model(model: SharedAutonomy, seed: int) -> None:
    # Uncertain moves, several starts, goal regions, silence, inputs that ask for nothing, ...
    rng = np.random.default_rng(seed)
    for robot in robots_for(model, rng):
        partner = everybody(model)[int(rng.integers(8))]
        require_equal(*both(robot, partner, 5, trials=2, max_steps=12))


@given(collaborations(), st.integers(0, 2**32))
@settings(max_examples=20)
def test_every_collaboration(model: Collaboration, seed: int) -> None:
    rng = np.random.default_rng(seed)
    for robot in robots_for(model, rng):
        partner = everybody(model)[int(rng.integers(5))]
        require_equal(*both(robot, partner, 5, trials=2, max_steps=12))


@pytest.mark.parametrize("carry_belief", [False, True])
@pytest.mark.parametrize("keep_mode", [False, True])
@pytest.mark.parametrize("alpha", [(0.0, 0.5), Adaptability.over((0.1, 0.9)).drifting(0.2)])
def test_trials_in_a_row_where_modes_are_hidden(
    carry_belief: bool, keep_mode: bool, alpha: Adaptability
) -> None:
    model = Collaboration(hallway(), memory=2, hidden_modes=True, adaptability=alpha)
    (robot,) = robots_for(model, np.random.default_rng(0))
    partner = Noisy(SimulatedPartner(0.5), 0.2)
    schedule = {"trials": 3, "carry_belief": carry_belief, "keep_mode": keep_mode, "max_steps": 9}
    require_equal(*both(robot, partner, 12, **schedule))


def test_an_action_of_no_mode_is_refused() -> None:
    model = task("hallway")
    assert isinstance(model, Collaboration)
    (robot,) = robots_for(model, np.random.default_rng(0))
    partner = Noisy(SimulatedPartner(0.5), 1.0)
    acts = model.input_likelihood[model.world.start]
    impossible = bool((acts.sum(axis=1) == 0).any())
    for run in (simulate_batch, simulate):
        if impossible:
            with pytest.raises(ValueError, match="belongs to no mode"):
                run(robot, partner, 50, np.random.default_rng(0))


ROBOT = MutualAdaptation(MODEL, towards_the_likelier(), NEVER_MATCH)


def test_what_is_counted_is_what_happened() -> None:
    # Against the episodes themselves, by their own definitions.
    partner = SimulatedPartner(0.5)
    batch = simulate_batch(ROBOT, partner, 60, np.random.default_rng(1), trials=2)
    episodes = simulate(ROBOT, partner, 60, np.random.default_rng(1), trials=2)
    assert batch.goal.shape == (60, 2)
    assert (batch.people, batch.trials, batch.belief) == (60, 2, None)
    taken = np.zeros((4, 2, 1), dtype=np.int64)
    for e, i in zip(episodes, np.ndindex(60, 2), strict=True):
        assert batch.goal[i] == (NO_GOAL if e.goal is None else e.goal)
        assert (batch.reward[i], batch.steps[i]) == (e.reward, e.steps)
        assert (batch.disagreement[i], batch.overridden[i]) == (e.disagreement, e.overridden)
        assert batch.first_mode[i] == e.modes[0]
        assert batch.switched[i] == (len({*e.modes, int(batch.last_mode[i])}) > 1)
        for d in e.decisions:
            taken[d.state, d.action, 0] += 1
    np.testing.assert_array_equal(batch.taken, taken)
    # A person goes on in the mode in which they ended.
    np.testing.assert_array_equal(batch.first_mode[:, 1], batch.last_mode[:, 0])
    assert 0 < batch.switched.mean() < 1


@pytest.mark.parametrize("carry", [False, True])
def test_the_belief_is_carried_or_reset(carry: bool) -> None:
    # One step a trial: what the robot believes in the second one, by the model's own filter.
    batch = simulate_batch(
        ROBOT,
        SimulatedPartner(0.5),
        30,
        np.random.default_rng(2),
        trials=2,
        carry_belief=carry,
        max_steps=1,
        beliefs=True,
    )
    assert batch.belief is not None
    start = MODEL.world.start
    for first, second in batch.belief:
        planned = ROBOT.policy.action(start, first.ravel())
        before = MODEL.predict(first, start, planned) if carry else MODEL.prior
        possible = [MODEL.correct(before, start, human_input) for human_input in range(2)]
        assert any(np.allclose(second, belief, rtol=1e-12) for belief in possible)


def test_a_new_mode_takes_its_prior_along() -> None:
    # One step a trial: the belief at the second start is alpha's marginal times the mode prior.
    partner = SimulatedPartner(1.0, LOW)
    batch = simulate_batch(
        ROBOT,
        partner,
        30,
        np.random.default_rng(3),
        trials=2,
        keep_mode=False,
        max_steps=1,
        beliefs=True,
    )
    assert set(batch.first_mode.ravel().tolist()) == {LOW}
    assert batch.belief is not None
    first = batch.belief[:, 0].sum(axis=2)
    for belief, before in zip(batch.belief[:, 1], first, strict=True):
        start = np.outer(before, [0.5, 0.5])
        after = [
            start * MODEL.input_likelihood[MODEL.world.start, i] for i in range(2)
        ]  # one of two inputs
        assert any(np.allclose(belief, a / a.sum(), rtol=1e-12) for a in after)


@pytest.mark.parametrize("partner", [SimulatedPartner(0.0, LOW), SimulatedPartner(0.6)], ids=str)
def test_a_hundred_thousand_runs_agree_with_the_exact_numbers(partner: SimulatedPartner) -> None:
    n = 100_000
    exact = evaluate(ROBOT, partner, tolerance=1e-9)
    batch = simulate_batch(ROBOT, partner, n, np.random.default_rng(5))
    for name in ("reward", "steps", "disagreement", "overridden", "discounted_return"):
        values = getattr(batch, name)
        error = values.std(ddof=1) / np.sqrt(n)
        assert abs(values.mean() - getattr(exact, name)) <= 4 * error + 1e-6, name


def test_partners_of_ones_own_go_through_the_loop() -> None:
    class Own:
        """Somebody who is no table."""

        def __init__(self, person: ActingPartner) -> None:
            self.begin, self.act, self.react = person.begin, person.act, person.react

    person = acting(SimulatedPartner(0.5), MODEL)
    assert isinstance(person, ActingPartner)
    rng = np.random.default_rng
    require_equal(
        simulate_batch(ROBOT, Own(person), 20, rng(0)),
        simulate_batch(ROBOT, SimulatedPartner(0.5), 20, rng(0)),
    )


def test_nobody() -> None:
    batch = simulate_batch(ROBOT, SimulatedPartner(0.5), 0, np.random.default_rng(0), trials=2)
    assert batch.goal.shape == (0, 2)
    assert not batch.taken.any()


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"n": -1}, "episodes must be at least 0"),
        ({"trials": 0}, "trials must be at least 1"),
        ({"max_steps": 0}, "max_steps must be at least 1"),
    ],
)
def test_bad_numbers_are_refused(wrong: dict[str, int], message: str) -> None:
    arguments = {"n": 1, **wrong}
    with pytest.raises(ValueError, match=message):
        simulate_batch(ROBOT, SimulatedPartner(0.5), rng=np.random.default_rng(0), **arguments)
