"""The report of a task, for every task."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from coadapt.cli import main
from coadapt.report.task.files import make_task_files, task_json, task_summary
from coadapt.report.task.results import ALPHAS, TaskResults, TaskSettings, task_results
from coadapt.tasks import load_task, task_names

SETTINGS = TaskSettings(runs=20, gap=0.05)


def results_of(name: str) -> TaskResults:
    task = load_task(name)
    return task_results(name, task.title, task.about, task.build(), SETTINGS)


@pytest.mark.parametrize("name", task_names())
def test_a_report_of_every_task(name: str) -> None:
    found = results_of(name)
    files = make_task_files(found)
    assert set(files) == {
        "report.html",
        "results.json",
        *(f"figures/{p}.{k}" for p in ("behaviour", "outcomes", "beliefs") for k in ("svg", "png")),
    }
    page = files["report.html"].decode()
    assert page.count("<h1>") == 1
    assert page.count("<svg") == 3
    # It needs nothing else, and no identifier is used twice.
    assert not re.search(r'(src|href)="(?!#)', page)
    identifiers = re.findall(r'\bid="([^"]+)"', page)
    assert len(identifiers) == len(set(identifiers))
    for part, content in files.items():
        if part.endswith(".svg"):
            ElementTree.fromstring(content)
    numbers: dict[str, Any] = json.loads(files["results.json"])
    assert numbers["lower"] <= numbers["upper"]
    rewards = [goal["reward"] for goal in numbers["goals"]]
    for robot in numbers["robots"]:
        assert robot["alpha"] == list(ALPHAS)
        share = np.array(robot["goal_share"])
        assert np.all(share >= 0)
        np.testing.assert_array_less(share.sum(axis=1), 1 + 1e-9)
        np.testing.assert_allclose(robot["reward"], share @ np.array(rewards), atol=1e-9)
        assert all(0 <= value <= 1 for value in robot["estimate"])
    assert task_summary(found).count("\n") >= len(ALPHAS)


def test_flows_and_visits_are_those_of_the_episodes() -> None:
    found = results_of("table_clearing_small")
    world = found.model.world
    for shown in found.planned.by_alpha:
        # Every step leaves a state; what flows in and does not flow out ends there or began there.
        assert shown.visits.sum() == pytest.approx(shown.summary.steps.mean)
        assert sum(shown.flow.values()) == pytest.approx(shown.summary.steps.mean)
        into = np.zeros(world.states)
        for (_, there), often in shown.flow.items():
            into[there] += often
        into[world.start] += 1
        ended = np.zeros(world.states)
        for g, goal in enumerate(world.goals):
            ended[goal.states[0]] = shown.summary.goals[g]
        np.testing.assert_allclose(into, shown.visits + ended, atol=1e-9)


def test_the_same_seed_gives_the_same_numbers() -> None:
    assert task_json(results_of("hallway")) == task_json(results_of("hallway"))


def test_from_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "report"
    arguments = ["reproduce", "--task", "hallway", "--runs", "20", "--out", str(out), "--quiet"]
    assert main([*arguments, "--json"]) == 0
    numbers = json.loads(capsys.readouterr().out)
    assert numbers == json.loads((out / "results.json").read_text("utf-8"))
    assert (numbers["task"], numbers["observed"], numbers["hidden"]) == ("hallway", 340, 5)
    assert "coadapt reproduce --task hallway --runs 20 --seed 0" in (out / "report.html").read_text(
        "utf-8"
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--task", "nothing"), "nothing: found no such task"),
        (("--task", "hallway", "--runs", "1"), "--runs must be at least 2, not 1"),
        (("--task", "hallway", "--gap", "0"), "--gap must be a number above 0, not 0"),
        (("--task", "hallway", "--seed", "-1"), "--seed must be at least 0, not -1"),
    ],
)
def test_what_cannot_be_used_is_refused(
    arguments: tuple[str, ...], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["reproduce", *arguments, "--quiet"]) == 2
    assert message in capsys.readouterr().err
