"""The page on writing a task is enough to write, solve and play one."""

from __future__ import annotations

import json
import re
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from coadapt.cli import main
from coadapt.play.session import Session
from coadapt.robots.task_setup import TaskSetup
from coadapt.simulation.log_writer import LiveLog
from coadapt.tasks import Task, parse_task, read_task
from coadapt.tasks.goal import TaskGoal
from coadapt.tasks.graph import TaskGraph
from coadapt.tasks.map import TaskMap
from coadapt.tasks.person import ActionInputs, JoystickInputs, SwitchInputs, TaskAdaptability
from coadapt.tasks.task import TaskModel

DOCS = Path(__file__).parents[1] / "docs"
PAGE = (DOCS / "how-to" / "write-a-task.md").read_text("utf-8")


def blocks(kind: str) -> list[str]:
    """The blocks of one kind, in order."""
    fences = re.findall(r"^( *)```(\w*)\n(.*?)^\1```$", PAGE, re.DOTALL | re.MULTILINE)
    return [dedent(text) for _, label, text in fences if label == kind]


@pytest.fixture(autouse=True)
def task(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("parcel.toml").write_text(blocks("toml")[0])


def test_the_task_is_short() -> None:
    assert len(blocks("toml")[0].splitlines()) <= 40


def test_the_sessions_show_what_happens(capsys: pytest.CaptureFixture[str]) -> None:
    look, simulate, play, solve = blocks("console")
    command, _, shown = look.partition("\n")
    assert command == "$ coadapt tasks parcel.toml"
    assert main(["tasks", "parcel.toml"]) == 0
    assert capsys.readouterr().out == shown
    assert simulate == '$ coadapt simulate parcel.toml --mode "left desk" --partner 0\n'
    arguments = ["simulate", "parcel.toml", "--mode", "left desk", "--episodes", "100", "--json"]
    shares: list[float] = []
    for alpha in ("0", "1"):
        assert main([*arguments, "--partner", alpha]) == 0
        shares.append(json.loads(capsys.readouterr().out)["goals"]["left desk"])
    assert shares[0] > 0.5 > shares[1]
    assert solve.startswith("$ coadapt ")
    assert main(solve.split()[2:]) == 0
    assert Path("parcel.policyx").exists()
    assert play == "$ coadapt play parcel.toml\n"


def test_it_is_played() -> None:
    setup = TaskSetup(task=read_task("parcel.toml"), gap=1e-2)
    robot = setup.build()
    session = Session(robot, LiveLog("log.csv", robot, setup))
    names = robot.model.interface.names
    while session.goal is None and len(session.decisions) < 50:
        session.step(names.index("left"))
    session.close()
    assert session.goal is not None
    assert session.saved_steps == len(session.decisions)


def test_the_python_runs() -> None:
    names: dict[str, Any] = {}
    exec(compile("".join(blocks("python")), "write-a-task.md", "exec"), names)
    assert names["robot"].act(names["model"].world.start, 0) in range(3)


def test_the_graph_is_a_task() -> None:
    head = 'format = 1\nname = "cup"\n[[goals]]\nname = "held"\nreward = 1\n'
    head += '[[goals]]\nname = "dropped"\nreward = 0\n'
    world = parse_task(f"{head}{blocks('toml')[1]}".encode(), "cup.toml").world()
    assert world.states == 4
    assert not world.is_deterministic


def test_the_reference_lists_every_key() -> None:
    page = (DOCS / "reference" / "task-format.md").read_text("utf-8")
    parts = (Task, TaskMap, TaskGraph, TaskGoal, TaskAdaptability, TaskModel)
    inputs = (ActionInputs, JoystickInputs, SwitchInputs)
    for part in (*parts, *inputs):
        for name in part.__struct_fields__:
            assert re.search(rf"[`\[]{name}[`\]]", page), name
