"""Sweeps that run: the table, what is kept, what fails, workers that die."""

from __future__ import annotations

import csv
import json
import os
from concurrent.futures import BrokenExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from coadapt.errors import FileError
from coadapt.robots.setup import RobotSetup
from coadapt.simulation import SimulatedPartner, evaluate, simulate_batch
from coadapt.simulation.sweep import Cell, Grid, LocalWorkers, Sweep, lay_out, run_sweep
from coadapt.simulation.sweep.run import Outcome
from tests.simulation.sweep.inline import InlineWorkers

SMALL = {"columns": 5, "rows": 2, "gap": 0.01}


def small(*grids: Grid, **values: Any) -> tuple[Cell, ...]:
    given = {"episodes": 20, "exact": True, "tolerance": 0.01} | values
    return lay_out(Sweep(name="test", grid=grids, **given)).cells


CELLS = small(
    Grid(
        robot=("mutual_adaptation", "one_way_adaptation", "no_adaptation"),
        disagreement_cost=(-0.4, -0.2),
        partner=({"adaptability": [0, 1], "mode": "left"}, {"kind": "noisy"}),
        **SMALL,
    )
)


def run(cells: tuple[Cell, ...], directory: Path, workers: InlineWorkers | None = None) -> Outcome:
    hands = workers or InlineWorkers()
    return run_sweep(cells, directory, lambda: hands)


def tables(directory: Path) -> bytes:
    return b"".join((directory / f"results.{kind}").read_bytes() for kind in ("parquet", "csv"))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sweep, run at once."""
    directory = tmp_path_factory.mktemp("whole")
    outcome = run(CELLS, directory)
    assert (outcome.cells, outcome.kept, outcome.failed) == (len(CELLS), 0, {})
    return directory


def test_the_numbers_are_those_of_the_functions_behind_them(whole: Path) -> None:
    rows = pq.read_table(whole / "results.parquet").to_pylist()
    assert [row["cell"] for row in rows] == [cell.key for cell in CELLS]
    cell, row = CELLS[0], rows[0]
    robot = RobotSetup(columns=5, rows=2, gap=0.01, disagreement_cost=-0.4).build()
    person = SimulatedPartner(0.0, 0)
    exact = evaluate(robot, person, tolerance=0.01)
    assert row["exact_reward"] == exact.reward
    assert row["exact_optimal"] == exact.goal_probability[1]
    batch = simulate_batch(robot, person, 20, cell.rng())
    assert row["reward"] == batch.reward.mean()
    assert row["steps"] == batch.steps.mean()
    assert row["steps_se"] == pytest.approx(batch.steps.std(ddof=1) / np.sqrt(20))


def test_every_parameter_is_a_column(whole: Path) -> None:
    row = pq.read_table(whole / "results.parquet").to_pylist()[0]
    setup = RobotSetup(columns=5, rows=2, gap=0.01, disagreement_cost=-0.4)
    for name in RobotSetup.__struct_fields__:
        value = getattr(setup, name)
        found = tuple(json.loads(row[name])) if name == "adaptability" else row[name]
        assert found == value
    assert (row["task"], row["reward_gap"], row["seed"]) == ("table_clearing", 1.0, 0)
    assert (row["partner_kind"], row["partner_mode"]) == ("follower", "left")
    assert (row["episodes"], row["exact"], row["error"], row["trial"]) == (20, True, None, 1)


def test_exact_values_are_for_people_who_follow_the_model(whole: Path) -> None:
    for row in pq.read_table(whole / "results.parquet").to_pylist():
        follows = row["partner_kind"] == "follower"
        assert (row["exact_reward"] is not None) == follows
        assert (row["exact_insisting"] is not None) == (row["partner_adaptability"] == 0)
        assert row["reward"] is not None


def test_csv_and_parquet_hold_the_same(whole: Path) -> None:
    table = pq.read_table(whole / "results.parquet")
    with (whole / "results.csv").open(newline="") as file:
        lines = list(csv.reader(file))
    assert lines[0] == table.column_names
    for line, row in zip(lines[1:], table.to_pylist(), strict=True):
        assert line == ["" if value is None else str(value) for value in row.values()]


def test_in_pieces_and_in_another_order_the_table_is_the_same(whole: Path, tmp_path: Path) -> None:
    run(CELLS[::-1][:5], tmp_path)
    run(CELLS[3:9], tmp_path)
    workers = InlineWorkers()
    outcome = run(CELLS, tmp_path, workers)
    assert outcome.kept == len({c.key for c in (*CELLS[::-1][:5], *CELLS[3:9])})
    done = [arguments[0].key for name, arguments in workers.jobs if name == "run"]
    assert len(done) == len(set(done)) == len(CELLS) - outcome.kept
    assert tables(tmp_path) == tables(whole)


def test_nothing_is_run_again(whole: Path) -> None:
    before = tables(whole)

    def refuse() -> InlineWorkers:
        raise AssertionError("no worker is needed")

    outcome = run_sweep(CELLS, whole, refuse)
    assert outcome.kept == len(CELLS)
    assert tables(whole) == before


def test_one_plan_for_all_cells_that_share_it(tmp_path: Path) -> None:
    workers = InlineWorkers()
    run(CELLS, tmp_path, workers)
    plans = [arguments[0].plan_key for name, arguments in workers.jobs if name == "plan"]
    assert sorted(plans) == sorted({cell.plan_key for cell in CELLS})


def test_a_failed_cell_is_noted_and_tried_again(tmp_path: Path) -> None:
    # A memory of 2 fits; 40 steps have more windows than are allowed, which the model finds out.
    cells = small(Grid(memory=(2, 40), partner={"adaptability": 1}, columns=7, rows=3))
    outcome = run(cells, tmp_path)
    assert list(outcome.failed) == [cells[1].key]
    (message,) = outcome.failed.values()
    assert "memory must be so short that there are at most 100,000 windows" in message
    (noted,) = (tmp_path / "failed").iterdir()
    assert json.loads(noted.read_bytes())["message"] == message
    rows = pq.read_table(tmp_path / "results.parquet").to_pylist()
    assert [row["error"] for row in rows] == [None, message]
    assert rows[1]["reward"] is None
    again = run(cells, tmp_path)
    assert (again.kept, list(again.failed)) == (1, [cells[1].key])


def test_a_worker_killed_once_costs_nothing(whole: Path, tmp_path: Path) -> None:
    left = [1]

    def kills(name: str, arguments: tuple[Any, ...]) -> bool:
        return (
            name == "run" and arguments[0].key == CELLS[4].key and bool(left) and bool(left.pop())
        )

    workers = InlineWorkers(kills)
    outcome = run(CELLS, tmp_path, workers)
    assert (outcome.failed, workers.renewed) == ({}, 1)
    assert tables(tmp_path) == tables(whole)


@pytest.mark.parametrize("what", ["run", "plan"])
def test_what_kills_its_workers_fails_alone(what: str, tmp_path: Path) -> None:
    killer = CELLS[3]

    def kills(name: str, arguments: tuple[Any, ...]) -> bool:
        cell = arguments[0]
        return (
            name == what
            and cell.plan_key == killer.plan_key
            and (what == "plan" or cell.key == killer.key)
        )

    outcome = run(CELLS, tmp_path, InlineWorkers(kills))
    same_plan = [cell.key for cell in CELLS if cell.plan_key == killer.plan_key]
    assert list(outcome.failed) == ([killer.key] if what == "run" else same_plan)
    assert all("ended its worker process 2 times" in m for m in outcome.failed.values())


def test_an_error_of_ours_closes_the_workers(tmp_path: Path) -> None:
    workers = InlineWorkers()

    def refuse(done: int, failed: int) -> None:
        if done > 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_sweep(CELLS, tmp_path, lambda: workers, refuse)
    assert workers.closed is True
    assert run(CELLS, tmp_path).kept >= 2


def test_damaged_files_are_named(tmp_path: Path) -> None:
    cells = CELLS[:2]
    run(cells, tmp_path)
    first, second = (tmp_path / "cells" / f"{cell.key}.json" for cell in cells)
    kept = first.read_bytes()
    first.write_bytes(kept[: len(kept) // 2])
    with pytest.raises(FileError, match=r"found a damaged file .*remove it to run the cell again"):
        run(cells, tmp_path)
    first.write_bytes(second.read_bytes())
    with pytest.raises(FileError, match="found another cell than its name says"):
        run(cells, tmp_path)
    first.write_bytes(kept)
    assert run(cells, tmp_path).kept == 2


def test_trials_have_rows_of_their_own(tmp_path: Path) -> None:
    cells = small(Grid(partner={"adaptability": 0.5, "mode": "left"}, **SMALL), trials=3)
    table = run(cells, tmp_path).table
    assert table.columns["trial"] == [1, 2, 3]
    assert table.columns["exact_reward"][1:] == [None, None]
    assert None not in table.columns["reward"]


def test_processes_that_die_are_replaced() -> None:
    workers = LocalWorkers(1)
    try:
        error = workers.submit(os._exit, 1).exception()
        assert isinstance(error, BrokenExecutor)
        assert workers.lost(error)
        workers.renew()
        assert workers.submit(abs, -3).result() == 3
    finally:
        workers.close(now=True)
