"""``coadapt sweep``: a grid of parameters, conditions and simulated people."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from coadapt.errors import InputError, printable

if TYPE_CHECKING:
    from coadapt.simulation.sweep import Layout, Outcome, Workers
    from coadapt.simulation.sweep.run import Progress

FAILED = 1
"""Exit code if cells failed."""

SHOWN = 5
"""Failures that are printed."""

EVERY = 0.05
"""Where there is no terminal progress is told after as large a part of the cells."""


@click.command(name="sweep")
@click.argument(
    "sweep", required=False, type=click.Path(path_type=Path, dir_okay=False), metavar="[FILE]"
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    default=Path("sweep"),
    metavar="DIR",
    help="Where finished cells and results are. Cells finished there are not run again.  [sweep]",
)
@click.option(
    "--maps",
    is_flag=True,
    help="Run the sweep that maps the paper's task, and draw its figures; takes no FILE.",
)
@click.option(
    "--jobs", type=click.IntRange(1, 1024), metavar="N", help="Processes.  [as many as cores]"
)
@click.option("--dask", metavar="ADDRESS", help="Run on the Dask cluster with this scheduler.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")
@click.option("--quiet", is_flag=True, help="Do not say how far it is.")
def command(
    *,
    sweep: Path | None,
    out: Path,
    maps: bool,
    jobs: int | None,
    dask: str | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Run a grid of simulations, on this machine or a cluster.

    FILE describes the sweep in TOML. A cell is finished once and for all: a sweep that was
    interrupted, even killed, goes on where it ended when it is started again, and DIR may be
    shared by several sweeps and processes. DIR gets results.parquet and results.csv, with every
    parameter and seed, in the order of the grid, and the figures that the sweep asks for.

    With --maps the sweep is one that comes with the package: over the penalty C and the gap between
    the rewards, where does the robot guide, probe and comply, and what does it cost?

    The exit code is 1 if a cell failed; the others are finished all the same.
    """
    from coadapt.report.maps.draw import draw, figures_of
    from coadapt.simulation.sweep import DaskWorkers, LocalWorkers, run_sweep
    from coadapt.simulation.sweep.table_files import CSV, PARQUET

    if jobs is not None and dask is not None:
        raise InputError("--jobs is for this machine: leave it out with --dask")
    layout = _layout(sweep, maps=maps)
    figures = figures_of(layout, None if sweep is None else sweep.parent)

    def workers() -> Workers:
        return LocalWorkers(jobs or os.cpu_count() or 1) if dask is None else DaskWorkers(dask)

    with _progress(len(layout.cells), on=not quiet) as tell:
        try:
            found = run_sweep(layout.cells, out, workers, tell)
        except KeyboardInterrupt:
            click.echo("Interrupted. The same command goes on where it ended.", err=True)
            raise
    drawn = [str(path) for path in draw(figures, found.table, out)] if figures.any else []
    record = {
        "sweep": layout.sweep.name,
        "cells": found.cells,
        "kept": found.kept,
        "run": found.cells - found.kept - len(found.failed),
        "failed": [{"cell": key, "error": error} for key, error in found.failed.items()],
        "results": [str(out / PARQUET), str(out / CSV)],
        "figures": drawn,
    }
    if as_json:
        click.echo(json.dumps(record))
    else:
        _say(layout.sweep.name, found, out)
        if drawn:
            click.echo(printable(f"Figures in {', '.join(drawn)}"))
    return FAILED if found.failed else 0


def _layout(sweep: Path | None, *, maps: bool) -> Layout:
    """The sweep of a file, or the one that maps the paper's task."""
    from coadapt.simulation.sweep import parse_sweep, read_sweep

    if (sweep is None) != maps:
        raise InputError("give either a FILE that describes a sweep, or --maps")
    if sweep is not None:
        return read_sweep(sweep)
    from importlib.resources import files

    shipped = files("coadapt.simulation.sweep").joinpath("maps.toml")
    return parse_sweep(shipped.read_bytes(), shipped.name)


def _say(name: str, found: Outcome, out: Path) -> None:
    from coadapt.simulation.sweep.table_files import CSV, PARQUET

    new = found.cells - found.kept - len(found.failed)
    click.echo(printable(f"{name}: {found.cells:,} cells, {new:,} run, {found.kept:,} kept"))
    for key, error in list(found.failed.items())[:SHOWN]:
        click.echo(printable(f"  failed: {key[:12]}: {error}"))
    if len(found.failed) > SHOWN:
        click.echo(f"  and {len(found.failed) - SHOWN:,} more; see {out / 'failed'}")
    click.echo(printable(f"Results in {out / PARQUET} and {out / CSV}"))


@contextmanager
def _progress(cells: int, *, on: bool) -> Generator[Progress]:
    """Call the result with what is done with; shows it and the time left on standard error."""
    if not on:
        yield lambda done, failed: None
        return
    if not sys.stderr.isatty():
        last = 0

        def line(done: int, failed: int) -> None:
            nonlocal last
            if done == cells or done - last >= EVERY * cells:
                last = done
                click.echo(f"{done:,} of {cells:,} cells{_failures(failed)}", err=True)

        yield line
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("cells", total=cells, start=False)
        begun = False

        def show(done: int, failed: int) -> None:
            nonlocal begun
            # What was finished before says nothing of the time that is left.
            if not begun:
                bar.reset(task, completed=done)
            begun = True
            bar.update(task, completed=done, description=f"cells{_failures(failed)}")

        yield show


def _failures(failed: int) -> str:
    return f", {failed:,} failed" if failed else ""
