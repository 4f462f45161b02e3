"""The command line: quick help, one line for every error, and `coadapt replay`."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from textwrap import dedent

import click
import pytest

import coadapt
from coadapt.cli import COMMANDS, main
from coadapt.cli.options import SETUP_OPTIONS
from coadapt.robots.setup import ROBOT_NAMES, RobotSetup
from coadapt.simulation.log_reader import open_log

PROGRAM = [sys.executable, "-c", "import sys; from coadapt.cli import main; sys.exit(main())"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(Path(coadapt.__file__).parents[1])}

DOCS = Path(__file__).parents[1] / "docs"
SMALL = ["--columns", "7", "--rows", "3"]
LOG = "time,input\n0,left\n0.5,\n1,forward\n1.5,left\n"
HELP = [["--help"], *([name, "--help"] for name in COMMANDS)]
HEAVY = ("numpy", "scipy", "numba", "matplotlib", "textual", "rich", "msgspec")


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*PROGRAM, *arguments], capture_output=True, text=True, env=ENVIRONMENT, check=False
    )


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = Path("log.csv")
    path.write_text(LOG)
    return path


@pytest.mark.parametrize("arguments", [[], *HELP])
def test_help_of_every_command(arguments: list[str]) -> None:
    result = run(*arguments)
    assert result.returncode == 0
    assert result.stdout.startswith("Usage: coadapt")


@pytest.mark.parametrize("arguments", HELP)
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    code = f"import sys; from coadapt.cli import main; main({arguments}); print(*sys.modules)"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=ENVIRONMENT, check=True
    )
    imported = result.stdout.splitlines()[-1].split()
    assert not [name for name in HEAVY if name in imported]


def test_the_solver_imports_no_oracle() -> None:
    # What exact solutions need took a fifth of the time of this import.
    code = "import sys; import coadapt.momdp.sarsop; print(*sys.modules)"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=ENVIRONMENT, check=True
    )
    imported = result.stdout.split()
    assert "coadapt.momdp.sarsop.solver" in imported
    assert not {"coadapt.momdp.exact", "scipy.spatial", "scipy.sparse.linalg"} & set(imported)


def test_help_lists_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    lines = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    for name, summary in COMMANDS.items():
        assert f"{name} {summary}" in lines


@pytest.mark.parametrize("name", COMMANDS)
def test_a_summary_is_the_first_line_of_the_help(name: str) -> None:
    group = coadapt.cli.program
    command = group.get_command(click.Context(group), name)
    assert command is not None
    assert command.name == name
    assert (command.help or "").splitlines()[0] == COMMANDS[name]


def test_the_help_shows_the_defaults_of_the_setup() -> None:
    assert {name: default for name, _, default, _ in SETUP_OPTIONS} == {
        name: getattr(RobotSetup(), name) for name in RobotSetup.__struct_fields__
    }


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"coadapt {coadapt.__version__}\n"


def test_lazy_names() -> None:
    for name in coadapt.__all__:
        assert getattr(coadapt, name) is not None
        assert name in dir(coadapt)
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = coadapt.nonsense


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["fly"], "'fly'"),
        (["--fly"], "--fly"),
        (["replay"], "LOG"),
        (["replay", "missing.csv"], "missing.csv: found no readable file"),
        (["replay", "."], ".: found a directory, expected a log"),
        (["replay", "a\nb\x1b[1m"], r"a\nb\x1b[1m"),
        (["replay", "log.csv", "--robot", "kind"], "mutual_adaptation"),
        (["replay", "log.csv", "--columns", "two"], "--columns"),
        (["replay", "log.csv", "--columns", "2"], "--columns must be at least 3, not 2"),
        (["replay", "log.csv", "--left-reward", "nan"], "--left-reward must be"),
        (["replay", "log.csv", "--adaptability", "0,x"], "'0,x' is not a list of numbers"),
        (["replay", "log.csv", "--adaptability", "1,0"], "--adaptability must be increasing"),
        (["replay", "log.csv", "--step-cost", "0.1"], "--step-cost cannot be used"),
        (["replay", "log.csv", "--gap", "0"], "--gap must be"),
        (["replay", "log.csv", "--out", "log.csv"], "found the log itself"),
        (["replay", "log.csv", "--out", "./link.csv"], "found the log itself"),
        (["replay", "log.csv", "--robot", "no_adaptation", "--out", "."], "not a file"),
        (["replay", "log.csv", "--robot", "no_adaptation", "--out", "no/o.csv"], "cannot be writt"),
        (["replay", "bad.csv"], "bad.csv:3: found input 'lfet', expected left, forward, right or"),
        (["replay", "long.csv", "--robot", "no_adaptation"], "long.csv:11: found an input after"),
        (["play"], "needs a terminal"),
        (["play", "--discount", "1"], "--discount must be at least 0 and below 1, not 1.0"),
    ],
)
def test_an_error_is_one_line_and_writes_nothing(
    log: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    Path("link.csv").symlink_to(log)
    Path("bad.csv").write_text("time,input\n0,left\n1,lfet\n")
    # The fixed robot needs 3 + 6 moves on the grid of 13 x 4 cells.
    Path("long.csv").write_text("time,input\n" + "0,left\n" * 10)
    before = sorted(Path().iterdir())
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("coadapt: error: ")
    assert err.count("\n") == 1
    assert words in err
    assert sorted(Path().iterdir()) == before


def test_replay_prints_and_saves(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["replay", str(log), *SMALL]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    lines = out.splitlines()
    assert lines[0] == "log.csv through mutual_adaptation"
    assert lines[2].startswith("Trial 1: ")
    assert lines[3].split()[:7] == ["step", "state", "input", "action", "planned", "match", "agree"]
    assert lines[4].split()[:6] == ["1", "column", "3", "row", "0", "left"]
    assert lines[5].split()[5] == "-"  # no input
    assert lines[-1] == "Saved to log.mutual_adaptation.csv"
    with open_log("log.mutual_adaptation.csv") as saved:
        rows = list(saved.rows(("left", "forward", "right")))
    assert saved.setup == RobotSetup(columns=7, rows=3)
    assert [row.time for row in rows] == [0, 0.5, 1, 1.5]
    assert [row.human_input for row in rows] == ["left", None, "forward", "left"]
    assert all(set(row.recorded) == set(saved.decision_columns) for row in rows)
    assert len(saved.decision_columns) == 5 + 5 * 2  # five values of alpha, two modes


@pytest.mark.parametrize("robot", ROBOT_NAMES)
def test_a_replay_of_a_replay_is_identical(
    log: Path, capsys: pytest.CaptureFixture[str], robot: str
) -> None:
    assert main(["replay", str(log), *SMALL, "--robot", robot, "--out", "a.csv"]) == 0
    assert main(["replay", "a.csv", "--out", "b.csv"]) == 0  # the setup is in the log
    assert "Identical to the recorded decisions, all 4 to the bit." in capsys.readouterr().out
    assert Path("a.csv").read_bytes() == Path("b.csv").read_bytes()


def test_a_changed_decision_is_reported(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main(["replay", str(log), "--robot", "no_adaptation", "--out", "a.csv"])
    saved = Path("a.csv").read_text()
    Path("a.csv").write_text(saved.replace("1.0,forward,1,column 6 row 2", "1.0,forward,1,moon"))
    capsys.readouterr()
    assert main(["replay", "a.csv", "--out", "b.csv"]) == 1
    expected = "in 1 of 4 steps; first in trial 1, step 3 (line 7): state was moon, is now column 6"
    assert expected in capsys.readouterr().out
    # With another setup a difference is no failure.
    assert main(["replay", "a.csv", "--out", "b.csv", "--discount", "0.5"]) == 0
    assert "changed: discount" in capsys.readouterr().out


def test_another_robot_may_be_at_the_goal_sooner(
    log: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log.write_text("time,input\n" + "0,left\n" * 7)
    assert main(["replay", str(log), "--robot", "no_adaptation", "--out", "a.csv"]) == 0
    capsys.readouterr()
    assert main(["replay", "a.csv", "--columns", "5", "--rows", "3", "--out", "b.csv"]) == 0
    assert "right goal (reward 11) after 4 steps; 3 inputs after it left out" in (
        capsys.readouterr().out
    )
    small = ["--robot", "no_adaptation", "--columns", "5", "--rows", "3", "--out", "c.csv"]
    assert main(["replay", str(log), *small]) == 2
    assert "(--skip-rest leaves such inputs out)" in capsys.readouterr().err
    assert main(["replay", str(log), *small, "--skip-rest"]) == 0


def test_json(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["replay", str(log), *SMALL, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["setup"]["columns"] == 7
    assert found["comparison"] is None
    (trial,) = found["trials"]
    assert [step["input"] for step in trial["steps"]] == ["left", None, "forward", "left"]
    assert sum(trial["steps"][0]["mode_belief"].values()) == pytest.approx(1)
    with open_log(found["saved"]) as saved:
        for step, row in zip(trial["steps"], saved.rows(("left", "forward", "right")), strict=True):
            for column, value in row.recorded.items():
                assert repr(step[column]) == repr(value)
    assert main(["replay", found["saved"], "--json", "--out", "b.csv"]) == 0
    comparison = json.loads(capsys.readouterr().out)["comparison"]
    assert comparison["same_setup"] is True
    assert (comparison["steps"], comparison["different"], comparison["first"]) == (4, 0, None)


def test_a_broken_pipe_is_quiet(log: Path) -> None:
    rows = (f"{n},left,{n // 5 + 1}\n" for n in range(4000))
    log.write_text("time,input,trial\n" + "".join(rows))
    # Where the tests run in the background the signal is ignored, and children inherit that.
    heeds = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    program = [*PROGRAM[:2], heeds + PROGRAM[2]]
    with subprocess.Popen(
        [*program, "replay", str(log), "--robot", "no_adaptation"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=ENVIRONMENT,
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() == 141
    assert Path("log.no_adaptation.csv").exists()  # saved before it was printed


def test_an_interrupt_is_quiet(log: Path) -> None:
    rows = (f"{n},left,{n // 5 + 1}\n" for n in range(200_000))
    log.write_text("time,input,trial\n" + "".join(rows))
    # Where the tests run in the background the signal is ignored, and children inherit that.
    heeds = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    program = [*PROGRAM[:2], heeds + PROGRAM[2]]
    with subprocess.Popen(
        [*program, "replay", str(log), "--robot", "no_adaptation"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=ENVIRONMENT,
    ) as process:
        assert process.stderr is not None
        time.sleep(2)
        process.send_signal(signal.SIGINT)
        assert process.stderr.read() == b""
        assert process.wait() == 130
    assert [path.name for path in Path().iterdir()] == ["log.csv"]


def test_the_how_to_shows_what_happens(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    how_to = DOCS / "how-to" / "replay-a-log.md"
    inputs, session = (
        dedent(how_to.read_text().split(f"   ```{kind}\n")[1].split("   ```")[0])
        for kind in ("csv", "console")
    )
    Path("inputs.csv").write_text(inputs)
    assert main(["replay", "inputs.csv"]) == 0
    command, *shown = session.splitlines()
    assert command == "$ coadapt replay inputs.csv"
    assert capsys.readouterr().out.splitlines() == shown
