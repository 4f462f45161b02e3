"""The page on solving problems shows what happens."""

from __future__ import annotations

import json
import re
from pathlib import Path
from textwrap import dedent

import pytest

import coadapt as ca
from coadapt.cli import main
from coadapt.momdp.exact import exact_value
from coadapt.momdp.sarsop import compile_kernels

PAGE = (Path(__file__).parents[1] / "docs" / "how-to" / "solve-a-problem.md").read_text("utf-8")
NUMBER = re.compile(r"-?\d[\d,]*(\.\d+)?(e-?\d+)?")


@pytest.fixture(autouse=True)
def problem(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("machine.pomdp").write_text(dedent(PAGE.split("   ```\n")[1]))
    compile_kernels()  # or a first run would say so


def shape(text: str) -> str:
    """``text`` with every number replaced: times and the course of a search change."""
    return NUMBER.sub("#", text)


def test_the_sessions_show_what_happens(capsys: pytest.CaptureFixture[str]) -> None:
    sessions = re.findall(r"^( *)```console\n(.*?)^ *```$", PAGE, re.DOTALL | re.MULTILINE)
    assert len(sessions) == 3
    for _, session in sessions:
        command, _, shown = dedent(session).partition("\n")
        code = main(command.removeprefix("$ coadapt ").split())
        out, err = capsys.readouterr()
        assert shape(out + err) == shape(shown)
        assert code == (2 if err else 0)


def test_the_bounds_shown_hold() -> None:
    exact = exact_value(ca.read_pomdp("machine.pomdp"), 1e-4)
    shown = re.search(r"value +(\S+) to (\S+)", PAGE)
    assert shown is not None
    # Six digits are shown.
    assert float(shown[1]) <= exact.upper[0] + 5e-4
    assert float(shown[2]) >= exact.lower[0] - 5e-4


def test_the_objects_have_the_names_that_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    tables = PAGE.split("With `--json`")[1].split("| name | meaning |")[1:]
    commands = (["solve", "machine.pomdp"], ["evaluate", "machine.pomdp", "machine.policyx"])
    for arguments, table in zip(commands, tables, strict=True):
        rows = [line for line in table.split("\n\n")[0].splitlines() if line.startswith("| `")]
        listed = {name for row in rows for name in re.findall(r"`(\w+)`", row.split("|")[1])}
        assert main([*arguments, "--json"]) == 0
        assert set(json.loads(capsys.readouterr().out)) == listed


def test_the_python_runs(capsys: pytest.CaptureFixture[str]) -> None:
    code = PAGE.split("```python\n")[1].split("```")[0]
    exec(compile(code, "solve-a-problem.md", "exec"), {})
    bounds, mean, action = capsys.readouterr().out.splitlines()
    assert bounds.startswith("gap ")
    assert action == "repair"
    lower, upper = (float(word) for word in bounds.split()[1:])
    assert 0 <= upper - lower <= 1e-3
    simulated, error = (float(word) for word in mean.split())
    assert lower - 4 * error <= simulated <= upper + 4 * error
    assert len(ca.read_policy("machine.policyx").vectors) > 0
