"""Replay: the same inputs through the same robot are the same decisions, to the bit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from coadapt.errors import FileError
from coadapt.robots import Robot
from coadapt.robots.setup import ROBOT_NAMES, RobotSetup
from coadapt.simulation import Trial
from coadapt.simulation.log import DecisionCells, LogRow
from coadapt.simulation.log_reader import open_log
from coadapt.simulation.log_writer import whole_log
from coadapt.simulation.replay import Comparison, replay

NAMES = ("left", "forward", "right")


@pytest.fixture(scope="module")
def robots() -> dict[str, Robot]:
    return {name: setup(name).build() for name in ROBOT_NAMES}


def setup(name: str) -> RobotSetup:
    return RobotSetup(robot=name, columns=7, rows=3)  # pyright: ignore


def rows(*trials: str) -> list[LogRow]:
    """Trials written as l, f, r and - for no input; the first row is on line 2."""
    names = dict(zip("lfr", NAMES, strict=True))
    steps = [(n, c) for n, trial in enumerate(trials, start=1) for c in trial]
    return [LogRow(i + 2, float(i), names.get(c), n) for i, (n, c) in enumerate(steps)]


@pytest.mark.parametrize("name", ROBOT_NAMES)
@settings(deadline=None, max_examples=20)
@given(trials=st.lists(st.text("lfr-", min_size=1, max_size=12), min_size=1, max_size=3))
def test_replay_is_what_trials_do(robots: dict[str, Robot], name: str, trials: list[str]) -> None:
    robot = robots[name]
    replayed = list(replay(robot, rows(*trials), "log.csv", skip_rest=True))
    for found, inputs in zip(replayed, trials, strict=True):
        trial = Trial(robot)
        for c in inputs:
            if not trial.done:
                trial.step(None if c == "-" else "lfr".index(c))
        expected = trial.episode()
        assert found.episode.actions == expected.actions
        assert found.episode.inputs == expected.inputs
        assert found.episode.final_state == expected.final_state
        assert found.unused == len(inputs) - expected.steps
        for a, b in zip(found.episode.decisions, expected.decisions, strict=True):
            assert a.belief.tobytes() == b.belief.tobytes()
            assert a.agreement.hex() == b.agreement.hex()


@pytest.mark.parametrize("name", ROBOT_NAMES)
def test_a_saved_replay_replays_identically(
    robots: dict[str, Robot], name: str, tmp_path: Path
) -> None:
    first, second = tmp_path / "first.csv", tmp_path / "second.csv"
    save(robots[name], name, list(replay(robots[name], rows("ll-f", "rrr"), "")), first)
    with open_log(first) as log:
        assert log.setup == setup(name)
        again = setup(name).build()  # planned anew
        comparison = Comparison(again)
        replayed = []
        for trial in replay(again, log.rows(NAMES), first):
            comparison.add(trial)
            replayed.append(trial)
    save(again, name, replayed, second)
    assert (comparison.steps, comparison.different, comparison.first) == (7, 0, None)
    assert second.read_bytes() == first.read_bytes()


def save(robot: Robot, name: str, trials: list, path: Path) -> None:  # pyright: ignore
    with whole_log(path, robot, setup(name)) as log:
        for trial in trials:
            for row, decision in zip(trial.rows, trial.episode.decisions, strict=True):
                log.write(row.time, trial.number, decision)


def test_an_input_after_the_goal_names_its_line(robots: dict[str, Robot]) -> None:
    # On 7 x 3 cells the right goal is 3 + 2 moves away, so the fixed robot is there after five.
    robot = robots["no_adaptation"]
    with pytest.raises(FileError, match=r"^log\.csv:7: found an input after .* right in trial 1"):
        list(replay(robot, rows("llllll"), "log.csv"))
    with pytest.raises(FileError, match=r"^log\.csv:9: .* in trial 2, expected trial 3"):
        list(replay(robot, rows("ll", "llllll"), "log.csv"))
    (trial,) = replay(robot, rows("lllllll"), "log.csv", skip_rest=True)
    assert (trial.episode.steps, trial.unused, trial.episode.goal) == (5, 2, 1)


def test_a_trial_may_end_before_the_goal(robots: dict[str, Robot]) -> None:
    first, second = replay(robots["no_adaptation"], rows("ff", "l"), "log.csv")
    assert (first.episode.goal, first.episode.steps) == (None, 2)
    assert (second.number, second.episode.steps) == (2, 1)


@pytest.mark.parametrize(
    ("column", "value"),
    [("action", "forward"), ("matched", True), ("agreement", 0.25), ("state", "the moon")],
)
def test_the_first_difference_is_found(
    robots: dict[str, Robot], column: str, value: str | bool | float
) -> None:
    robot = robots["no_adaptation"]
    cells = DecisionCells(robot)
    recorded = recording(robot, "lllll")
    changed = recorded[3]
    was = changed.recorded[column]
    recorded[3] = replace(changed, recorded={**changed.recorded, column: value})
    recorded[4] = replace(recorded[4], recorded={})  # nothing to compare
    comparison = Comparison(robot)
    for trial in replay(robot, recorded, "log.csv"):
        comparison.add(trial)
    assert (comparison.steps, comparison.different) == (4, 1)
    first = comparison.first
    assert first is not None
    assert (first.trial, first.step, first.line) == (1, 4, 5)
    assert (first.column, first.recorded, first.replayed) == (column, value, was)
    assert column in cells.columns


def test_the_last_bit_counts(robots: dict[str, Robot]) -> None:
    robot = robots["mutual_adaptation"]
    recorded = recording(robot, "lf")
    name = "belief[alpha=0.25 left]"
    belief = recorded[1].recorded[name]
    assert isinstance(belief, float)
    off = belief * (1 + 2**-52)
    recorded[1] = replace(recorded[1], recorded={**recorded[1].recorded, name: off})
    comparison = Comparison(robot)
    for trial in replay(robot, recorded, "log.csv"):
        comparison.add(trial)
    assert comparison.first is not None
    assert comparison.first.column == name


def test_beliefs_of_another_robot_are_not_compared(robots: dict[str, Robot]) -> None:
    recorded = recording(robots["mutual_adaptation"], "l")
    beliefs = {c: v for c, v in recorded[0].recorded.items() if "0.25" in c}
    comparison = Comparison(robots["one_way_adaptation"])
    for trial in replay(robots["one_way_adaptation"], [replace(recorded[0], recorded=beliefs)], ""):
        comparison.add(trial)
    assert (comparison.steps, comparison.different) == (0, 0)


def recording(robot: Robot, inputs: str) -> list[LogRow]:
    cells = DecisionCells(robot)
    (trial,) = replay(robot, rows(inputs), "")
    return [
        replace(row, recorded=cells.values(decision))
        for row, decision in zip(trial.rows, trial.episode.decisions, strict=True)
    ]
