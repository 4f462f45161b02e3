"""The terminal program with tasks other than table clearing."""

from __future__ import annotations

from pathlib import Path

import pytest
from textual.pilot import Pilot

from coadapt.human import Inputs
from coadapt.human.inputs import EIGHT_DIRECTIONS
from coadapt.play.app import PlayApp
from coadapt.play.keys import keys, numbered
from coadapt.robots.task_setup import TaskSetup
from coadapt.simulation.log_reader import open_log
from coadapt.tasks import Task, load_task
from tests.play.test_play import drawing, play, text


def setup(name: str) -> TaskSetup:
    task = load_task(name)
    assert isinstance(task, Task)
    return TaskSetup(task=task, robot="no_adaptation")


def inputs(name: str) -> Inputs:
    return setup(name).model().interface


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("table_clearing", "← ↑ →"),
        ("grasp_selection", "← ↑ → ↓"),
        ("wheelchair", "← ↑ → ↓  2 ↗  4 ↖  6 ↙  8 ↘"),
        ("stacking_order", "1 fragile  2 wait  3 heavy"),
    ],
)
def test_every_input_has_a_key(name: str, expected: str) -> None:
    assert keys(inputs(name)) == expected


def test_numbers_are_the_inputs_in_their_order() -> None:
    joystick = inputs("wheelchair")
    assert [numbered(joystick, n) for n in range(1, 9)] == list(EIGHT_DIRECTIONS)
    assert numbered(joystick, 9) is None


def test_a_joystick_and_obstacles(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"

    async def script(app: PlayApp, pilot: Pilot[int]) -> None:
        assert "press ← ↑ → ↓  2 ↗" in text(app, "moves")
        assert "wide is worth 11" in text(app, "why")
        lines = [line.split() for line in drawing(app) if line.strip()]
        assert lines[0] == list("▒▒1▒▒▒▒▒▒▒▒22▒▒")
        assert lines[2] == list("····▒▒▒·▒▒▒····")
        await pilot.press("4", "down", "9", "space")
        assert "trial 1, step 3" in text(app, "heading")  # there is no ninth input

    play(path, script, setup("wheelchair"))
    with open_log(path) as log:
        rows = list(log.rows(tuple(EIGHT_DIRECTIONS)))
        assert log.setup == setup("wheelchair")
    assert [row.human_input for row in rows] == ["forward left", "back", None]


def test_a_graph(tmp_path: Path) -> None:
    async def script(app: PlayApp, pilot: Pilot[int]) -> None:
        await pilot.press(*"11111")
        assert "The fragile on heavy goal, worth 11, after 5 steps." in text(app, "why")
        assert next(line.split() for line in drawing(app) if line.strip())[0] == "1"

    play(tmp_path / "log.csv", script, setup("stacking_order"))
