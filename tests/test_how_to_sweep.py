"""The pages on sweeps show what happens."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from coadapt.cli import main
from coadapt.simulation.sweep import read_sweep
from coadapt.simulation.sweep.grid import Grid, Sweep
from coadapt.simulation.sweep.measure import MEASURES
from coadapt.simulation.sweep.table import PARAMETERS, RUN
from tests.simulation.sweep.inline import InlineWorkers

DOCS = Path(__file__).parents[1] / "docs"
PAGE = (DOCS / "how-to" / "run-a-sweep.md").read_text("utf-8")
REFERENCE = (DOCS / "reference" / "sweep-format.md").read_text("utf-8")


@pytest.fixture(autouse=True)
def directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("people.toml").write_text(PAGE.split("```toml\n")[1].split("```")[0])


def test_the_sessions_show_what_happens(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("coadapt.simulation.sweep.LocalWorkers", lambda jobs: InlineWorkers())
    sessions = re.findall(
        r"^```console\n\$ coadapt (.*?)\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE
    )
    assert len(sessions) == 2
    for command, shown in sessions:
        assert main(command.split()) == 0
        assert capsys.readouterr().out == shown


def test_the_program_runs_with_processes_of_its_own() -> None:
    Path("program.py").write_text(PAGE.split("```python\n")[1].split("```")[0])
    done = subprocess.run(
        [sys.executable, "program.py"], capture_output=True, text=True, check=True
    )
    rewards = [float(part) for part in done.stdout.strip(" []\n").split(",")]
    assert len(rewards) == 6
    assert all(10 <= reward <= 11 for reward in rewards)


def test_the_shipped_maps() -> None:
    (number,) = re.findall(r"of ([\d,]+) cells of the paper's task", PAGE)
    shipped = DOCS.parent / "src" / "coadapt" / "simulation" / "sweep" / "maps.toml"
    assert len(read_sweep(shipped).cells) == int(number.replace(",", ""))


def test_the_reference_names_everything() -> None:
    names = {*Sweep.__struct_fields__, *Grid.__struct_fields__} - {"grid"}
    names |= {name for name, _ in (*PARAMETERS, *RUN)}
    for name in names:
        assert f"`{name}`" in REFERENCE, name
    for measure in MEASURES:
        columns = ", ".join(f"`{column}`" for column in measure.columns)
        assert f"| {columns} | {measure.meaning} |" in REFERENCE
