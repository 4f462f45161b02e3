"""The page on collaboration shows what happens."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import coadapt as ca
from coadapt.formalism.collaboration import OBSERVED
from coadapt.formalism.shared_autonomy import PAPER_ADAPTABILITY
from coadapt.robots import Collaborator
from tests.simulation.test_collaboration import after_tasks

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "explanation" / "collaboration.md").read_text("utf-8")


def table(heading: str) -> list[list[str]]:
    """The cells below the line that begins with ``heading``."""
    _, _, below = PAGE.partition(f"\n| {heading}")
    rows = below.split("\n\n")[0].splitlines()[2:]
    return [[cell.strip(" *`") for cell in row.strip("| ").split("|")] for row in rows]


def collaborator(task: str, adaptability: tuple[float, ...] = PAPER_ADAPTABILITY) -> Collaborator:
    world = ca.worlds.table_carrying() if task == "table" else ca.worlds.hallway()
    model = ca.Collaboration(world, adaptability=adaptability)
    return Collaborator(model, ca.SARSOP(gap=1e-3).solve(model.to_momdp()).policy)


def test_the_example_runs(capsys: pytest.CaptureFixture[str]) -> None:
    (example,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(example, "collaboration.md", "exec"), {})
    first, _, last = capsys.readouterr().out.splitlines()
    assert (first, last) == ("0.0 [1. 0.]", "1.0 [0. 1.]")
    lines = len((ROOT / "examples" / "handover.py").read_text("utf-8").splitlines())
    assert f"has {lines} lines" in PAGE


def test_the_numbers_of_states() -> None:
    rows = table("`observed` | table carrying")
    assert [cells[0].split("`")[0] for cells in rows] == list(OBSERVED)
    for observed, (_, *counts) in zip(OBSERVED, rows, strict=True):
        for count, world in zip(
            counts, (ca.worlds.table_carrying(), ca.worlds.hallway()), strict=True
        ):
            problem = ca.Collaboration(world, observed=observed).to_momdp()
            assert problem.shape[0] == int(count)


def test_what_the_robot_does() -> None:
    robots = [collaborator("table"), collaborator("hallway")]
    for alpha, *shown in table("α | table: better goal"):
        partner = ca.SimulatedPartner(float(alpha), mode=0)
        found = [ca.evaluate(robot, partner) for robot in robots]
        numbers = [x for e in found for x in (e.goal_probability[1], e.steps)]
        # Evaluation is exact up to 0.001.
        assert numbers == pytest.approx([float(x) for x in shown], abs=0.01)


def test_robots_that_think_they_know_the_person() -> None:
    robots = [collaborator("table", (0.0,)), collaborator("table", (1.0,))]
    for alpha, *shown in table("α | taken for stubborn"):
        partner = ca.SimulatedPartner(float(alpha), mode=0)
        found = [ca.evaluate(robot, partner, max_steps=200) for robot in robots]
        numbers = [x for e in found for x in e.goal_probability[::-1]]
        assert numbers == pytest.approx([float(x) for x in shown], abs=0.002)


def test_how_long_the_robot_insists() -> None:
    # docs/tasks: three steps with a table, and in the hallway it lets people pass in the fifth.
    for task, steps in (("table", 3), ("hallway", 4)):
        robot, stubborn = collaborator(task), ca.SimulatedPartner(0.0, mode=0)
        (episode,) = ca.simulate(robot, stubborn, 1, np.random.default_rng(0))
        assert episode.actions.index(0) == steps


def test_a_short_sighted_robot_does_not_insist() -> None:
    model = ca.Collaboration(ca.worlds.table_carrying(), discount=0.9)
    robot = Collaborator(model, ca.SARSOP(gap=1e-3).solve(model.to_momdp()).policy)
    found = ca.evaluate(robot, ca.SimulatedPartner(1.0, mode=0))
    assert found.goal_probability == pytest.approx([1.0, 0.0])


def test_estimates() -> None:
    robot, rng = collaborator("table"), np.random.default_rng(0)
    *ends, (_, *mixed) = table("people | who adapted")
    for tasks, (_, *shown) in enumerate(ends, start=1):
        found = [after_tasks(robot, alpha, rng, tasks) for alpha in (1.0, 0.0)]
        assert [did for did, _ in found] == [True, False]
        assert [mean for _, mean in found] == pytest.approx([float(x) for x in shown], abs=1e-3)
    alphas = np.tile(robot.model.alpha.values, 200).tolist()
    people = [
        after_tasks(robot, alpha, np.random.default_rng([0, i]), 2)
        for i, alpha in enumerate(alphas)
    ]
    for group, cell in zip((True, False), mixed, strict=True):
        means = [mean for did, mean in people if did is group]
        mean, spread = re.findall(r"[\d.]+", cell)
        assert np.mean(means) == pytest.approx(float(mean), abs=0.01)
        assert np.std(means) == pytest.approx(float(spread), abs=0.01)
