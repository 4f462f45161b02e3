"""A robot that knows whom it meets, and what others lose beside it."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from coadapt import SARSOP, SharedAutonomy, SimulatedPartner, check_momdp, simulate_batch
from coadapt.cli import main
from coadapt.human import Adaptability, Inputs
from coadapt.robots import NEVER_MATCH, MatchRule, MutualAdaptation
from coadapt.simulation import DescribedPartner, DrawnPartner
from coadapt.simulation.knowing import KnowingRobot, KnownPerson
from coadapt.simulation.partners import (
    Contrarian,
    Lapsing,
    Noisy,
    OwnMemory,
    Wandering,
    Yielding,
    drifting,
)
from coadapt.simulation.robustness import robustness
from coadapt.worlds import table_clearing
from tests.robots.worlds import MODEL
from tests.simulation.strategies import random_policy

DRIFT = Adaptability.over((0.1, 0.6, 1.0), (0.5, 0.2, 0.3)).drifting(0.4)
GRID = SharedAutonomy(table_clearing(5, 2), discount=0.9)
SILENT = replace(GRID, inputs=Inputs.actions(GRID.world.action_names, np.zeros((3, 2)), 0.1, 0.2))


@pytest.mark.parametrize("model", [MODEL, GRID, SILENT], ids=["row", "grid", "silent"])
@pytest.mark.parametrize(
    ("partner", "alpha"),
    [(SimulatedPartner(0.6), Adaptability.over((0.6,))), (DrawnPartner(DRIFT), DRIFT)],
    ids=["one", "drift"],
)
def test_who_follows_the_model_is_known_as_it_says(
    model: SharedAutonomy, partner: DescribedPartner, alpha: Adaptability
) -> None:
    found = KnownPerson.of(model, partner).to_momdp()
    expected = replace(model, adaptability=alpha).to_momdp()
    np.testing.assert_array_equal(found.edge_start, expected.edge_start)
    np.testing.assert_array_equal(found.edge_next, expected.edge_next)
    for e in range(len(found.edge_next)):
        np.testing.assert_allclose(
            found.transition.matrix(int(found.edge_map[e])),
            expected.transition.matrix(int(expected.edge_map[e])),
            atol=1e-12,
        )
    np.testing.assert_allclose(found.observation, expected.observation, atol=1e-12)
    np.testing.assert_array_equal(found.reward, expected.reward)
    for a, b in zip(found.roots, expected.roots, strict=True):
        assert (a.x, a.label) == (b.x, b.label)
        np.testing.assert_allclose(a.belief, b.belief, atol=1e-12)


@pytest.mark.parametrize("model", [MODEL, GRID, SILENT], ids=["row", "grid", "silent"])
def test_it_decides_as_the_robot_of_that_model(model: SharedAutonomy) -> None:
    right = replace(model, adaptability=DRIFT)
    policy, rule = random_policy(right, np.random.default_rng(0)), MatchRule(0.6)
    robot = MutualAdaptation(right, policy, rule)
    knowing = KnowingRobot(KnownPerson.of(model, DrawnPartner(DRIFT)), policy, rule)
    rng = np.random.default_rng(1)
    going = np.flatnonzero(~model.world.ends)
    windows = rng.choice(going, 200)
    inputs = rng.integers(len(model.input_names), size=200)
    beliefs = rng.dirichlet(np.ones(6), size=200).reshape(200, 3, 2)
    a, b = (each.decide_many(windows, inputs, beliefs) for each in (robot, knowing))
    for name in ("action", "planned", "asked", "matched", "state"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
    for name in ("belief", "forecast", "agreement"):
        np.testing.assert_allclose(getattr(a, name), getattr(b, name), atol=1e-12)


PEOPLE: list[DescribedPartner] = [
    Contrarian(SimulatedPartner(0.7)),
    Lapsing(SimulatedPartner(0.5), 0.3, 2.0),
    Yielding(0.8, 2),
    Wandering(Noisy(SimulatedPartner(0.5), 0.2), 0.1),
    drifting(0.5, 0.3, points=3),
    OwnMemory(SimulatedPartner(0.5), 2),
]


@pytest.mark.parametrize(
    ("model", "partner"),
    [*((MODEL, person) for person in PEOPLE), *((SILENT, person) for person in PEOPLE[:2])],
    ids=lambda value: type(value).__name__,
)
def test_its_episodes_are_worth_what_was_planned(
    model: SharedAutonomy, partner: DescribedPartner
) -> None:
    # The planner's bounds come from the problem, the episodes from the person's tables.
    person = KnownPerson.of(model, partner)
    problem = person.to_momdp()
    check_momdp(problem)
    solution = SARSOP(gap=0.01).solve(problem)
    robot = KnowingRobot(person, solution.policy, NEVER_MATCH)
    n = 1000
    returns = simulate_batch(robot, partner, n, np.random.default_rng(0)).discounted_return
    error = returns.std(ddof=1) / np.sqrt(n)
    assert solution.lower - 4 * error <= returns.mean() <= solution.upper + 4 * error


def test_who_knows_loses_nothing() -> None:
    policy = SARSOP(gap=0.01).solve(GRID.to_momdp()).policy
    robot = MutualAdaptation(GRID, policy, NEVER_MATCH)
    partners = {"follower": SimulatedPartner(0.0), "memory": OwnMemory(SimulatedPartner(0.5), 2)}
    rows = robustness(robot, partners, runs=500, seed=0, gap=0.01, max_steps=100)
    assert [row.name for row in rows] == list(partners)
    follower, memory = rows
    assert follower.return_lost is not None
    assert follower.return_lost.mean >= -4 * follower.return_lost.standard_error - 0.01
    assert memory.return_lost is None
    assert follower.reward_lost.mean == follower.knowing.reward.mean - follower.assuming.reward.mean


def test_windows_of_no_memory_are_refused() -> None:
    partner = Noisy(OwnMemory(SimulatedPartner(0.5), 2), 0.1)
    with pytest.raises(ValueError, match="must be the last thing said"):
        KnownPerson.of(GRID, partner)


SMALL = ["robustness", "--columns", "5", "--rows", "2", "--discount", "0.9", "--gap", "0.05"]


def test_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = [*SMALL, "--runs", "50", "--mode", "left"]
    kinds = ["--partner-kind", "contrarian", "--partner-kind", "memory"]
    assert main([*arguments, *kinds]) == 0
    text = capsys.readouterr().out
    assert text.startswith("table_clearing, people with alpha 0.5, 50 runs each\nperson ")
    assert main([*arguments, *kinds, "--json"]) == 0
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert [row["partner"] for row in found["rows"]] == ["contrarian", "memory"]
    row = found["rows"][0]
    assert f"{row['reward']['mean']:.3f}" in text
    assert "return_lost" in row
    assert "return_lost" not in found["rows"][1]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([*SMALL, "--robot", "no_adaptation"], "is measured of mutual_adaptation, not of no_adap"),
        ([*SMALL, "--partner-kind", "odd"], "--partner-kind must be one of follower"),
        ([*SMALL, "--mode", "up"], "--mode must be one of left, right"),
        (["robustness", "hallway"], "robustness is measured of mutual_adaptation, not of collab"),
        (["simulate", "--partner-number", "rate=1"], "for one of: none, not 'rate=1'"),
        (["simulate", "--partner-kind", "noisy", "--partner-number", "rate=x"], "with a number"),
        (["simulate", "--partner-kind", "noisy", "--partner-number", "rate=3"], "noisy cannot be"),
        (["simulate", "--partner-kind", "tempered", "--partner-number", "temperature=9"], "small"),
    ],
)
def test_what_cannot_be_used_is_refused(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    assert message in capsys.readouterr().err


def test_partners_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["partners"]) == 0
    text = capsys.readouterr().out
    assert main(["partners", "--json"]) == 0
    for name, kind in json.loads(capsys.readouterr().out).items():
        assert f"{name} " in text or f"{name}\n" in text
        for number, default in kind["numbers"].items():
            assert f"{number}={default:g}" in text


def test_simulate_takes_any_kind(capsys: pytest.CaptureFixture[str]) -> None:
    small = ["simulate", "--columns", "5", "--rows", "2", "--robot", "no_adaptation"]
    arguments = [*small, "--partner-kind", "yielding", "--partner-number", "steps=2", "--json"]
    assert main([*arguments, "--episodes", "10"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["partner_kind"], found["partner_numbers"]) == ("yielding", ["steps=2"])
