"""The terminal program, driven without a terminal."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from threading import Event
from time import sleep

import pytest
from textual.pilot import Pilot
from textual.widgets import Static

from coadapt.errors import FileError, InputError
from coadapt.play.app import INTERRUPTED, PlayApp
from coadapt.play.bars import BarsView, bar
from coadapt.play.help import HelpScreen
from coadapt.play.session import Session
from coadapt.play.table import TableView
from coadapt.robots.setup import Progress, RobotSetup
from coadapt.simulation.log_reader import open_log
from coadapt.simulation.log_writer import LiveLog
from coadapt.simulation.replay import Comparison, replay

FIXED = RobotSetup(robot="no_adaptation", columns=7, rows=3)
MUTUAL = RobotSetup(columns=7, rows=3)
INPUTS = ("left", "forward", "right")

Script = Callable[[PlayApp, Pilot[int]], Awaitable[None]]


def play(
    path: Path, script: Script, setup: RobotSetup = FIXED, size: tuple[int, int] = (80, 24)
) -> PlayApp:
    """Run the program through ``script`` once the robot is built; the log is then closed."""

    def begin(tell: Progress) -> Session:
        robot = setup.build(tell)
        return Session(robot, LiveLog(path, robot, setup))

    app = PlayApp(begin, "a robot")

    async def run() -> None:
        async with app.run_test(size=size) as pilot:
            while app.session is None:
                await pilot.pause(0.01)
            await pilot.pause()
            await script(app, pilot)

    try:
        asyncio.run(run())
    finally:
        if app.session is not None:
            app.session.close()
    return app


def text(app: PlayApp, name: str) -> str:
    return str(app.query_one(f"#{name}", Static).render())


def drawing(app: PlayApp) -> list[str]:
    return app.query_one(TableView).render().plain.split("\n")


def test_keys_are_inputs_and_steps_are_saved(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"

    async def script(app: PlayApp, pilot: Pilot[int]) -> None:
        await pilot.press("left", "up", "right", "space", "down", "x")
        assert "trial 1, step 4" in text(app, "heading")
        await pilot.press("n", "n", "up")
        assert "trial 2, step 1" in text(app, "heading")
        with open_log(path) as log:  # while the program runs
            rows = list(log.rows(INPUTS))
        names = ["left", "forward", "right", None, "forward"]
        assert [row.human_input for row in rows] == names
        assert [row.trial for row in rows] == [1, 1, 1, 1, 2]
        await pilot.press("q")

    assert play(path, script).return_value == 0


def test_the_log_replays_to_the_bit(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"

    async def script(app: PlayApp, pilot: Pilot[int]) -> None:
        await pilot.press("left", "left", "up", "space", "right", "n", "right", "right")

    play(path, script, MUTUAL)
    with open_log(path) as log:
        assert log.setup == MUTUAL
        robot = log.setup.build()
        comparison = Comparison(robot)
        for trial in replay(robot, log.rows(INPUTS), path):
            comparison.add(trial)
    assert (comparison.steps, comparison.different) == (7, 0)


def test_what_the_person_sees(tmp_path: Path) -> None:
    async def script(app: PlayApp, pilot: Pilot[int]) -> None:
        before = "\n".join(drawing(app))
        assert "left 10" in before
        assert "right 11" in before
        assert before.count("●") == 1
        assert before.count("█") == 2
        assert "start" in before
        assert list(app.query_one(BarsView).groups[0].values) == [0.5, 0.5]  # the prior
        await pilot.press("left")
        assert text(app, "moves").splitlines() == [
            "You       ←  left",
            "Robot     ↑  forward   (not what you ask)",
        ]
        after = "\n".join(drawing(app))
        assert after.count("↑") == 1
        assert text(app, "why").startswith("The robot goes forward although you ask for left")
        view = app.query_one(BarsView)
        assert "left " in view.render().plain
        assert "0.25 " in view.render().plain
        assert app.session is not None
        assert app.session.last is not None
        goals, alphas = view.groups
        assert list(goals.values) == app.session.last.mode_belief.tolist()
        assert list(alphas.values) == app.session.last.adaptability_belief.tolist()
        assert goals.values[0] > 0.9  # after "left"
        await pilot.press("space")
        assert "–  nothing" in text(app, "moves")

    play(tmp_path / "log.csv", script, MUTUAL)


def test_the_goal_ends_the_trial(tmp_path: Path) -> None:
    async def script(app: PlayApp, pilot: Pilot[int]) -> None:
        await pilot.press(*["left"] * 8)  # five moves are enough for the fixed robot
        assert "trial 1, step 5" in text(app, "heading")
        assert text(app, "why").startswith("The right bottle, worth 11, after 5 steps.")
        await pilot.press("n")
        assert "trial 2, step 0" in text(app, "heading")

    play(tmp_path / "log.csv", script)


def test_help_opens_and_closes(tmp_path: Path) -> None:
    async def script(app: PlayApp, pilot: Pilot[int]) -> None:
        await pilot.press("question_mark")
        assert isinstance(app.screen, HelpScreen)
        await pilot.press("left")  # closes the page and is no input
        assert not isinstance(app.screen, HelpScreen)
        assert "step 0" in text(app, "heading")
        await pilot.press("left")
        assert "step 1" in text(app, "heading")

    play(tmp_path / "log.csv", script)


def test_control_c_ends_like_an_interrupt(tmp_path: Path) -> None:
    async def script(app: PlayApp, pilot: Pilot[int]) -> None:
        await pilot.press("ctrl+c")

    app = play(tmp_path / "log.csv", script)
    assert app.return_value == INTERRUPTED
    assert not (tmp_path / "log.csv").exists()  # no step, no log


@pytest.mark.parametrize("size", [(200, 60), (100, 30), (80, 24), (60, 20), (40, 12), (20, 6)])
@pytest.mark.parametrize("setup", [FIXED, RobotSetup(robot="no_adaptation", columns=61, rows=40)])
def test_every_size_shows_the_robot(
    tmp_path: Path, size: tuple[int, int], setup: RobotSetup
) -> None:
    async def script(app: PlayApp, pilot: Pilot[int]) -> None:
        await pilot.press("left", "left")
        lines = drawing(app)
        view = app.query_one(TableView).size
        assert sum(line.count("●") for line in lines) == 1
        assert len(lines) <= max(view.height, 3)
        assert max(len(line.rstrip()) for line in lines) <= max(view.width, 2)

    play(tmp_path / "log.csv", script, setup, size)


def test_panels_rearrange_with_the_window(tmp_path: Path) -> None:
    async def script(app: PlayApp, pilot: Pilot[int]) -> None:
        def panels() -> list[str]:
            return [str(panel.id) for panel in app.query_one("#body").children]

        wide = ["table-panel", "belief-panel", "why-panel"]
        assert panels() == wide
        assert text(app, "heading") == "coadapt play │ a robot │ trial 1, step 0"
        await pilot.resize_terminal(50, 20)
        await pilot.pause()
        assert panels() == ["table-panel", "why-panel", "belief-panel"]
        assert text(app, "heading") == "a robot │ trial 1, step 0"
        await pilot.resize_terminal(100, 30)
        await pilot.pause()
        assert panels() == wide
        assert text(app, "heading") == "coadapt play │ a robot │ trial 1, step 0"

    play(tmp_path / "log.csv", script)


def test_the_window_may_change_behind_the_help_page(tmp_path: Path) -> None:
    async def script(app: PlayApp, pilot: Pilot[int]) -> None:
        await pilot.press("question_mark")
        await pilot.resize_terminal(50, 20)
        await pilot.pause()
        await pilot.press("x", "left")
        assert "step 1" in str(app.screen.query_one("#heading", Static).render())

    play(tmp_path / "log.csv", script)


def test_help_while_the_robot_is_prepared(tmp_path: Path) -> None:
    is_open = Event()

    def begin(tell: Progress) -> Session:
        is_open.wait()
        tell("Going on")
        robot = FIXED.build(tell)
        return Session(robot, LiveLog(tmp_path / "log.csv", robot, FIXED))

    app = PlayApp(begin, "a robot")

    async def run() -> None:
        async with app.run_test() as pilot:
            await pilot.press("question_mark")
            is_open.set()
            while app.session is None:
                await pilot.pause(0.3)  # longer than between two looks at the clock
            await pilot.press("x", "left")
            assert "step 1" in text(app, "heading")

    asyncio.run(run())
    assert app.session is not None
    app.session.close()


def test_an_error_in_the_preparation_ends_the_program(tmp_path: Path) -> None:
    def begin(tell: Progress) -> Session:
        tell("Thinking")
        raise InputError("no robot")

    app = PlayApp(begin, "a robot")

    async def run() -> None:
        async with app.run_test() as pilot:
            while app.failure is None:
                await pilot.pause(0.01)

    asyncio.run(run())
    assert isinstance(app.failure, InputError)


def test_quitting_does_not_wait_for_the_preparation() -> None:
    stages: list[str] = []

    def begin(tell: Progress) -> Session:
        while True:
            tell("Thinking")
            stages.append("told")
            sleep(0.01)

    app = PlayApp(begin, "a robot")

    async def run() -> None:
        async with app.run_test() as pilot:
            while not stages:
                await pilot.pause(0.01)
            await pilot.press("left", "n", "q")

    asyncio.run(run())
    assert app.session is None
    assert app.return_value == 0


def test_a_step_that_cannot_be_saved_ends_the_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise FileError("log.csv", None, "cannot be written (No space left on device)")

    async def script(app: PlayApp, pilot: Pilot[int]) -> None:
        monkeypatch.setattr(LiveLog, "write", fail)
        await pilot.press("left")

    assert isinstance(play(tmp_path / "log.csv", script).failure, FileError)


def test_time_is_that_of_the_clock(tmp_path: Path) -> None:
    ticks = iter([100.0, 100.5, 101.23456])
    robot, path = FIXED.build(), tmp_path / "log.csv"
    session = Session(robot, LiveLog(path, robot, FIXED), clock=lambda: next(ticks))
    session.step(0)
    session.step(None)
    session.close()
    with open_log(path) as log:
        assert [row.time for row in log.rows(INPUTS)] == [0.5, 1.235]
    assert session.saved_steps == 2


def test_bar() -> None:
    assert bar(0, 4) == "    "
    assert bar(1, 4) == "████"
    assert bar(0.5, 4) == "██  "
    assert bar(0.53125, 4) == "██▏ "  # 4 x 8 eighths, 17 of them
