"""``coadapt tasks`` and ``coadapt simulate``, and tasks in the other commands."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from coadapt.cli import main
from coadapt.robots.task_setup import TaskSetup
from coadapt.simulation.log_reader import open_log
from coadapt.tasks import load_task, task_names, task_problem

TASK = """
format = 1
name = "corridor"

[map]
drawing = "W..@.E"
moves = ["left", "right"]

[[goals]]
name = "West"
reward = 1

[[goals]]
name = "East"
reward = 2
"""


@pytest.fixture(autouse=True)
def directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("corridor.toml").write_text(TASK)
    return tmp_path


def output(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(arguments) == 0
    out, err = capsys.readouterr()
    assert err == ""
    return out


def test_the_list(capsys: pytest.CaptureFixture[str]) -> None:
    listed = json.loads(output(capsys, "tasks", "--json"))
    assert [entry["name"] for entry in listed] == list(task_names())
    counts = {
        e["name"]: (e["observable"], e["hidden"], e["actions"], e["observations"]) for e in listed
    }
    assert counts["table_clearing"] == (52, 10, 3, 3)  # Sec. 6.5
    assert counts["table_carrying"][:2] == (734, 5)
    assert counts["hallway"][:2] == (340, 5)
    lines = output(capsys, "tasks").splitlines()
    assert lines[0].split() == ["name", "observable", "hidden", "actions", "observations", "title"]
    assert [line.split()[0] for line in lines[1:]] == list(task_names())


@pytest.mark.parametrize("name", task_names())
def test_one_task(capsys: pytest.CaptureFixture[str], name: str) -> None:
    text = output(capsys, "tasks", name)
    assert text.startswith(f"{name}: {load_task(name).title}\n")
    x, y, a, o = task_problem(load_task(name)).shape
    last = f"{x:,} observable x {y:,} hidden states, {a:,} actions, {o:,} observations"
    assert text.splitlines()[-1] == last
    assert json.loads(output(capsys, "tasks", name, "--json"))["observable"] == x


def test_a_collaboration(capsys: pytest.CaptureFixture[str]) -> None:
    text = output(capsys, "tasks", "hallway")
    assert "  right: human east robot west, reward 11\n" in text
    assert "  memory                    3\n" in text
    assert "human west robot west or human east robot east" in text


def test_a_task_of_ones_own(capsys: pytest.CaptureFixture[str]) -> None:
    text = output(capsys, "tasks", "corridor.toml")
    assert "  W..@.E\n" in text
    assert "  W  West  reward 1\n" in text
    assert json.loads(output(capsys, "tasks", "corridor.toml", "--json"))["task"]["goals"]


def test_a_task_is_solved_evaluated_simulated_and_replayed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    main(["solve", "corridor.toml", "--out", "p.policyx"])
    main(["evaluate", "corridor.toml", "p.policyx", "--episodes", "10"])
    capsys.readouterr()
    arguments = ["simulate", "corridor.toml", "--partner", "0", "--mode", "West"]
    arguments += ["--episodes", "20", "--match-threshold", "0.8", "--log", "log.csv"]
    text = output(capsys, *arguments)
    assert text.startswith("corridor, mutual_adaptation, a person with alpha 0 and West as first")
    assert text.endswith("Log saved to log.csv\n")
    record = json.loads(output(capsys, *arguments, "--json"))
    assert record["episodes"] == 20
    assert sum(record["goals"].values()) + record["no_goal"] == pytest.approx(1.0)
    assert f"{record['reward']['mean']:8.3f}" in text
    assert json.loads(output(capsys, *arguments, "--json")) == record
    # The log has the task itself: the file may go.
    Path("corridor.toml").unlink()
    assert "Identical to the recorded decisions" in output(capsys, "replay", "log.csv")
    with open_log("log.csv") as log:
        assert isinstance(log.setup, TaskSetup)
        assert log.setup.match_threshold == 0.8
        assert log.setup.task.name == "corridor"
    assert Path("log.csv").read_text().startswith("# coadapt log, format 2\n")
    changed = output(capsys, "replay", "log.csv", "--disagreement-cost=-1", "--memory", "2")
    assert "changed: task.model" in changed


def test_what_chance_did_is_replayed(capsys: pytest.CaptureFixture[str]) -> None:
    # Two starts, and a robot that does another move in three of ten steps.
    drawing = '"""\nW...E\n.....\n.@.@.\n"""\nslip = 0.3'
    text = TASK.replace('"W..@.E"', drawing).replace('["left",', '["left", "forward",')
    Path("slippery.toml").write_text(text)
    arguments = ["simulate", "slippery.toml", "--episodes", "50", "--log", "log.csv", "--json"]
    arguments += ["--robot", "no_adaptation"]
    record = json.loads(output(capsys, *arguments))
    assert record["no_goal"] == 0
    replayed = json.loads(output(capsys, "replay", "log.csv", "--json"))
    assert replayed["comparison"]["different"] == 0
    assert replayed["comparison"]["steps"] == sum(len(t["steps"]) for t in replayed["trials"])
    ends = [trial["goal"] for trial in replayed["trials"]]
    assert len(ends) == 50
    assert ends.count("East") / 50 == pytest.approx(record["goals"]["East"], abs=1e-12)
    starts = {trial["steps"][0]["state"] for trial in replayed["trials"]}
    assert starts == {"column 1 row 0", "column 3 row 0"}


def test_a_log_of_format_1_is_read(capsys: pytest.CaptureFixture[str]) -> None:
    # As coadapt wrote it before there were tasks, shortened to what replay needs.
    head = '# coadapt log, format 1\n# written by coadapt 0.1.0\n# setup {"columns":7,"rows":3}\n'
    Path("old.csv").write_text(f"{head}time,input\n0,left\n1,left\n")
    assert "column 3 row 0" in output(capsys, "replay", "old.csv")
    Path("mine.csv").write_text("time,input\n0,left\n1,\n")
    text = output(capsys, "replay", "mine.csv", "--task", "corridor.toml", "--out", "o.csv")
    assert "P(West)" in text


def test_simulate_table_clearing(capsys: pytest.CaptureFixture[str]) -> None:
    small = ["--columns", "7", "--rows", "3", "--robot", "no_adaptation", "--episodes", "1"]
    record = json.loads(output(capsys, "simulate", *small, "--json", "--partner", "0,1"))
    # Three to the right and two forward.
    assert record["steps"] == {"mean": 5.0, "standard_error": None}
    assert record["goals"] == {"left": 0.0, "right": 1.0}
    assert record["partner"] == [0.0, 1.0]


def test_simulate_a_collaboration(capsys: pytest.CaptureFixture[str]) -> None:
    # People of alpha 1 come round at the second step, those of alpha 0 never do.
    steps = {"0": (5.0, "left"), "1": (2.0, "right")}
    for alpha, (count, goal) in steps.items():
        arguments = ["simulate", "hallway", "--partner", alpha, "--mode", "left"]
        text = output(capsys, *arguments, "--episodes", "5")
        assert text.startswith(f"hallway, collaborator, a person with alpha {alpha} and left as fi")
        record = json.loads(output(capsys, *arguments, "--episodes", "5", "--json"))
        assert record["goals"][goal] == 1.0
        assert record["steps"]["mean"] == count
    # Somebody who cares little for the future gives in sooner.
    arguments = ["simulate", "hallway", "--partner", "0", "--mode", "left", "--discount", "0.9"]
    record = json.loads(output(capsys, *arguments, "--episodes", "1", "--json"))
    assert record["steps"]["mean"] == 3.0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["tasks", "corridors"], "found no such task, expected a file or one of: grasp"),
        (["tasks", "no.toml"], "no.toml: found no readable file"),
        (["solve", "bad.toml"], "bad.toml:6: map.drawing has no @"),
        (["simulate", "bad.toml"], "bad.toml:6: map.drawing has no @"),
        (["play", "bad.toml"], "bad.toml:6: map.drawing has no @"),
        (["play", "hallway"], "hallway: found a task in which the person moves the world too"),
        (
            ["simulate", "hallway", "--log", "l.csv"],
            "--log is not for hallway, in which the",
        ),
        (
            ["simulate", "hallway", "--robot", "no_adaptation"],
            "--robot is not for hallway, in",
        ),
        (["simulate", "hallway", "--memory", "0"], "--memory cannot be used: memory must be 1 to"),
        (["simulate", "hallway", "--adaptability", "2"], "--adaptability cannot be used: adapt"),
        (["simulate", "hallway", "--gap", "0"], "--gap must be a number above 0, not 0.0"),
        (["simulate", "hallway", "--mode", "up"], "--mode must be one of left, right, not 'up'"),
        (["simulate", "--mode", "up"], "--mode must be one of left, right, not 'up'"),
        (["simulate", "--partner", "2"], "--partner must lie from 0 to 1, not 2.0"),
        (["simulate", "--partner", "0,1,1"], "--partner must be one number or 2, not 3"),
        (["simulate", "--episodes", "0"], "--episodes"),
        (["simulate", "--log", "."], "found something else than a file"),
        (["simulate", "corridor.toml", "--columns", "5"], "--columns is for table clearing alone"),
        (["simulate", "corridor.toml", "--memory", "0"], "--memory must be from 1 to 100, not 0"),
        (["simulate", "corridor.toml", "--memory", "60"], "--memory must be so short that"),
        (["simulate", "corridor.toml", "--step-cost", "0.1"], "--step-cost cannot be used"),
        (["simulate", "corridor.toml", "--adaptability", "1,0"], "--adaptability must be incr"),
        (["simulate", "corridor.toml", "--gap", "0"], "--gap must be a number above 0"),
    ],
)
def test_an_error_is_one_line(
    capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    Path("bad.toml").write_text(TASK.replace("@", "."))
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("coadapt: error: ")
    assert err.count("\n") == 1
    assert words in err
