"""``coadapt sweep``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from coadapt.cli import main
from coadapt.simulation.sweep import workers
from tests.simulation.sweep.inline import InlineWorkers

SWEEP = """
format = 1
name = "tiny"
episodes = 10
exact = true
tolerance = 0.01

[[grid]]
columns = 5
rows = 2
gap = 0.01
memory = [1, 40]
partner = { adaptability = 0, mode = "other" }
"""


@pytest.fixture(autouse=True)
def directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("coadapt.simulation.sweep.LocalWorkers", lambda jobs: InlineWorkers())
    Path("tiny.toml").write_text(SWEEP)
    return tmp_path


def test_a_sweep_with_a_failure(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", "tiny.toml", "--out", "found"]) == 1
    out, err = capsys.readouterr()
    assert out.startswith("tiny: 2 cells, 1 run, 0 kept\n  failed: ")
    assert "memory must be so short" in out
    assert "2 of 2 cells, 1 failed" in err
    assert main(["sweep", "tiny.toml", "--out", "found", "--json", "--quiet"]) == 1
    out, err = capsys.readouterr()
    record = json.loads(out)
    assert err == ""
    assert (record["cells"], record["kept"], record["run"]) == (2, 1, 0)
    assert [Path(path).is_file() for path in record["results"]] == [True, True]
    assert "memory must be so short" in record["failed"][0]["error"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give either a FILE that describes a sweep, or --maps"),
        (["tiny.toml", "--maps"], "give either a FILE that describes a sweep, or --maps"),
        (["none.toml"], "none.toml: found no readable file"),
        (["tiny.toml", "--jobs", "2", "--dask", "x"], "--jobs is for this machine"),
        (["tiny.toml", "--jobs", "0"], "'--jobs'"),
    ],
)
def test_what_cannot_be_used(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", *arguments]) == 2
    assert message in capsys.readouterr().err


def test_no_scheduler(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers.DaskWorkers, "PATIENCE", 0.5)
    assert main(["sweep", "tiny.toml", "--dask", "127.0.0.1:1", "--quiet"]) == 2
    assert "found no Dask scheduler at 127.0.0.1:1" in capsys.readouterr().err


def test_figures_that_do_not_fit_are_refused_before_anything_runs(
    capsys: pytest.CaptureFixture[str], directory: Path
) -> None:
    Path("tiny.toml").write_text(SWEEP + 'figure = "phases"\n')
    assert main(["sweep", "tiny.toml"]) == 2
    assert "the figure phases needs one value of memory, found several" in capsys.readouterr().err
    assert not (directory / "sweep").exists()
