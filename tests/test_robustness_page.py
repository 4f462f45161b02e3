"""The page on robustness shows what happens, and so does the one on simulated people."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from coadapt.cli import main
from coadapt.simulation.partners import KINDS as PARTNERS

DOCS = Path(__file__).parents[1] / "docs"
PAGE = (DOCS / "explanation" / "robustness.md").read_text("utf-8")
ROW = re.compile(r"^\| (\w+) \| (.+) \|$", re.MULTILINE)

KINDS = ("follower", "yielding", "contrarian")
"""Some of the rows; planning for all of them takes longer than a test may."""

RUNS = 1000
"""Fewer than on the page, whose numbers then have to lie within four standard errors."""


def test_the_table_is_what_is_measured(capsys: pytest.CaptureFixture[str]) -> None:
    (line,) = re.findall(r"^\$ coadapt (robustness .*)$", PAGE, re.MULTILINE)
    shown = {name: cells.split(" | ") for name, cells in ROW.findall(PAGE) if name != "person"}
    assert [*shown] == [*PARTNERS]
    command = line.replace("--runs 10000", f"--runs {RUNS}").split()
    some = [part for kind in KINDS for part in ("--partner-kind", kind)]
    assert main([*command, *some, "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert [row["partner"] for row in rows] == list(KINDS)
    columns = ("return_lost", "reward", "reward_knowing", "reward_lost")
    columns += ("disagreement", "disagreement_knowing", "disagreement_added")
    for row in rows:
        for column, cell in zip(columns, shown[row["partner"]], strict=True):
            if cell == "-":
                assert column not in row
                continue
            mean, error = row[column]["mean"], row[column]["standard_error"]
            # Where all runs ended alike, as many more may not: rule of three, four times over.
            near = 4.2 * error + 12 / RUNS
            assert float(cell.split(" ")[0]) == pytest.approx(mean, abs=near), (row, column)


def test_the_code_runs() -> None:
    page = (DOCS / "how-to" / "simulate-people.md").read_text("utf-8")
    names: dict[str, object] = {}
    for code in re.findall(r"^```python\n(.*?)^```$", page, re.DOTALL | re.MULTILINE):
        exec(code, names)
    share = names["share"]
    assert isinstance(share, float) and 0 < share < 1


def test_commands_run(capsys: pytest.CaptureFixture[str]) -> None:
    page = (DOCS / "how-to" / "simulate-people.md").read_text("utf-8")
    commands = re.findall(r"^\$ coadapt (.*)$", page, re.MULTILINE)
    assert len(commands) >= 2
    for command in commands:
        assert main(command.split()) == 0
        assert capsys.readouterr().out
