"""``coadapt reproduce``: the published task solved again, in one report."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import click

from coadapt.errors import InputError

if TYPE_CHECKING:
    from coadapt.report.reproduce import Reproduction

PATIENCE = 4.0
"""Seconds after which a first stage that still runs is explained: later runs take less than one."""

COMPILING = "On the first run the planner's kernels are compiled; that takes up to a minute, once."


@click.command(name="reproduce")
@click.option(
    "--task",
    metavar="TASK",
    help="Report another task instead: one of `coadapt tasks`, or a TOML file.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    default=Path("reproduction"),
    metavar="DIR",
    help="Where to write the report. What else lies there is left alone.  [reproduction]",
)
@click.option("--json", "as_json", is_flag=True, help="Print all numbers as one JSON object.")
@click.option("--runs", type=int, default=1000, help="Simulated runs per adaptability.  [1000]")
@click.option("--seed", type=int, default=0, help="Seed of the simulations.  [0]")
@click.option(
    "--gap",
    type=float,
    default=None,
    help="Planning stops when its bounds are this close.  [0.001; 0.01 with --task]",
)
@click.option("--quiet", is_flag=True, help="Do not say what is being done.")
def command(
    out: Path,
    task: str | None,
    as_json: bool,
    runs: int,
    seed: int,
    gap: float | None,
    quiet: bool,
) -> None:
    """Write the report of the published results, or of a task.

    The paper's table-clearing task is solved, evaluated exactly and by simulation, and compared
    with the other two conditions. DIR gets report.html, which needs nothing else, the figures as
    SVG and PNG, and every number as CSV and JSON.

    With --task the report shows, for any task, what the robots do on its map with simulated people
    of different adaptability, how well, and what they believe on the way.

    If an option cannot be used or DIR cannot be written the exit code is 2.
    """
    start = perf_counter()
    write = _report_paper if task is None else partial(_report_task, task)
    with _stages(quiet) as tell:
        numbers, summary = write(out, runs, seed, gap, tell)
    if as_json:
        click.echo(numbers, nl=False)
        return
    from coadapt.report.write import PAGE

    click.echo(summary)
    click.echo(f"\nReport, made in {perf_counter() - start:.1f} s: {(out / PAGE).resolve()}")


def _report_paper(
    out: Path, runs: int, seed: int, gap: float | None, tell: Callable[[str], None]
) -> tuple[str, str]:
    """Write the report of the published results; its numbers as JSON, and a summary."""
    from coadapt.report.reproduce import Settings, reproduce
    from coadapt.report.tables import to_json
    from coadapt.report.write import make_files, require_writable, write_files

    try:
        settings = Settings(runs=runs, seed=seed) if gap is None else Settings(runs, seed, gap)
    except ValueError as error:
        raise InputError(f"--{error}") from error
    require_writable(out)
    found = reproduce(settings, tell)
    write_files(make_files(found, tell), out)
    return to_json(found), _summary(found)


def _report_task(
    task: str, out: Path, runs: int, seed: int, gap: float | None, tell: Callable[[str], None]
) -> tuple[str, str]:
    """Write the report of ``task``; its numbers as JSON, and a summary."""
    from coadapt.report.task.files import make_task_files, task_json, task_summary
    from coadapt.report.task.results import TaskSettings, task_results
    from coadapt.report.write import require_writable, write_files
    from coadapt.tasks import load_task

    loaded = load_task(task)
    try:
        settings = TaskSettings(runs, seed) if gap is None else TaskSettings(runs, seed, gap)
    except ValueError as error:
        raise InputError(f"--{error}") from error
    require_writable(out)
    found = task_results(task, loaded.title, loaded.about, loaded.build(), settings, tell)
    write_files(make_task_files(found, tell), out)
    return task_json(found), task_summary(found)


def _summary(found: Reproduction) -> str:
    """The main numbers as a table of plain text."""
    policy, rule = found.robot("mutual_policy"), found.robot("mutual_rule")
    drawn = [summary.reward for summary in policy.simulated]
    columns = [
        ("alpha", [f"{alpha:g}" for alpha in policy.alpha]),
        ("exact", [f"{e.reward:.3f}" for e in policy.exact]),
        (
            "simulated",
            [f"{r.mean:.3f} +- {r.standard_error:.3f}" for r in drawn],
        ),
        ("with match rule", [f"{e.reward:.3f}" for e in rule.exact]),
        *(
            (name, [f"{e.reward:.3f}" for e in found.robot(key).exact])
            for name, key in (("one-way", "one_way_rule"), ("no adaptation", "none"))
        ),
    ]
    widths = [max(len(name), *map(len, cells)) for name, cells in columns]
    rows = [[name for name, _ in columns], *zip(*(cells for _, cells in columns), strict=True)]
    held = sum(identity.holds for identity in found.identities)
    return "\n".join(
        [
            "Mean reward of the goal reached; users start towards the goal worth less.",
            "exact, simulated: the mutual-adaptation policy without the match rule",
            "",
            *(
                "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True))
                for row in rows
            ),
            "",
            f"Bounds of the task's value: {found.mutual.lower:.4f} to {found.mutual.upper:.4f}.",
            f"Identities that hold: {held} of {len(found.identities)}.",
        ]
    )


@contextmanager
def _stages(quiet: bool) -> Generator[Callable[[str], None]]:
    """Call the result at the beginning of each stage; says so on standard error.

    On a terminal a line that is redrawn, elsewhere a line for each stage.
    """
    if quiet:
        yield lambda _: None
        return
    with _printer() as say:
        timer = threading.Timer(0, lambda: None)
        first = True

        def tell(sentence: str) -> None:
            nonlocal timer, first
            timer.cancel()
            say(sentence)
            if sentence.startswith("Solving") and first:
                first = False
                timer = threading.Timer(PATIENCE, say, [f"{sentence}. {COMPILING}"])
                timer.daemon = True
                timer.start()

        try:
            yield tell
        finally:
            timer.cancel()


@contextmanager
def _printer() -> Generator[Callable[[str], None]]:
    if not sys.stderr.isatty():
        yield lambda sentence: click.echo(sentence, err=True)
        return
    from rich.console import Console
    from rich.text import Text

    console = Console(stderr=True)
    with console.status("") as status:
        yield lambda sentence: status.update(Text(sentence))
