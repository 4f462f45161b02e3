"""Every task goes through a problem file and stays the same problem."""

from __future__ import annotations

from pathlib import Path

import pytest

import coadapt as ca
from coadapt.tasks import load_task, task_names, task_problem

GAP = 2e-2


@pytest.mark.parametrize("name", task_names())
def test_a_task_written_and_read_has_the_same_value(name: str, tmp_path: Path) -> None:
    problem = task_problem(load_task(name))
    ca.write_pomdpx(problem, tmp_path / "task.pomdpx")
    # Where the first input is seen before the first action, the file has a step in front of it.
    again = ca.read_pomdp(tmp_path / "task.pomdpx")
    found = ca.SARSOP(gap=GAP).solve(problem)
    written = ca.SARSOP(gap=GAP * again.discount).solve(again)
    before = again.discount if len(again.roots) < len(problem.roots) else 1.0
    assert found.status is ca.Status.GAP
    assert written.status is ca.Status.GAP
    # Both pairs of bounds hold the same value.
    assert before * found.lower <= written.upper + 1e-9
    assert written.lower <= before * found.upper + 1e-9
    assert written.upper - written.lower <= GAP
