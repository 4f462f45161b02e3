"""Real processes that are killed: `benchmarks/sweep_kill.py` on a small sweep."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.sweep_kill import Case, result
from coadapt.simulation.sweep import read_sweep, run_sweep
from tests.simulation.sweep.inline import InlineWorkers

SWEEP = """
format = 1
name = "small"
episodes = 500
exact = true
tolerance = 0.001

[[grid]]
columns = 7
rows = 3
disagreement_cost = { from = -0.6, to = -0.1, count = 8 }
reward_gap = [0.5, 1, 1.5]
partner = { adaptability = [0, 1], mode = "other" }
"""


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    path = tmp_path_factory.mktemp("sweep") / "sweep.toml"
    path.write_text(SWEEP)
    return Case(path, 48)


@pytest.fixture(scope="module")
def whole(case: Case, tmp_path_factory: pytest.TempPathFactory) -> object:
    """The digest of the table of a sweep that is left alone, in this process."""
    out = tmp_path_factory.mktemp("whole")
    run_sweep(read_sweep(case.path).cells, out, InlineWorkers)
    return result(out, 0.0)["sha256"]


def test_killed_twice_the_table_is_the_same(case: Case, whole: object, tmp_path: Path) -> None:
    found = case.killed_twice(tmp_path / "out", "--jobs", "1")
    assert (found["cells"], found["sha256"]) == (case.cells, whole)
    assert found["run more than once"] == found["survivors"] == 0
    first, second = found["left at each kill"]  # pyright: ignore
    assert 0 < second < first < case.cells


def test_on_a_cluster_that_loses_a_worker_the_table_is_the_same(
    case: Case, whole: object, tmp_path: Path
) -> None:
    found = case.on_dask(tmp_path, tmp_path / "out", 2)
    assert (found["cells"], found["sha256"]) == (case.cells, whole)
    assert found["run more than once"] == 0
    assert found["left at the kill"] > 0  # pyright: ignore
