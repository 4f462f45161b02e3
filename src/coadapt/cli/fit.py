"""``coadapt fit``: adaptability from logs."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from coadapt.cli.options import numbers
from coadapt.cli.outputs import require_writable
from coadapt.cli.progress import progress_line
from coadapt.errors import InputError, printable

if TYPE_CHECKING:
    from coadapt.analysis.adaptability import PersonModel
    from coadapt.analysis.adaptability.logs import Logs

FIGURES = (".png", ".svg", ".pdf")


@click.command(name="fit")
@click.argument("logs", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="LOG...")
@click.option("--each-trial", is_flag=True, help="Take every trial for another participant.")
@click.option(
    "--between-trials",
    type=click.Choice(("keep", "anew")),
    default="keep",
    show_default=True,
    help="Whether people keep their mode from trial to trial or choose it anew.",
)
@click.option(
    "--first-mode", metavar="GOAL", help="The goal all wanted at first.  [the model's prior]"
)
@click.option("--memory", type=click.IntRange(1), help="Steps they remember.  [as in the log]")
@click.option(
    "--lapse",
    type=click.FloatRange(0, 1, max_open=True),
    default=0.0,
    show_default=True,
    metavar="P",
    help="Probability of an input at random.",
)
@click.option(
    "--prior",
    type=click.Choice(("uniform", "population")),
    default="uniform",
    show_default=True,
    help="What is known of a participant before they begin.",
)
@click.option(
    "--values",
    type=numbers,
    default="0,0.25,0.5,0.75,1",
    show_default=True,
    metavar="ALPHA,...",
    help="Values of alpha for the weights of the population.",
)
@click.option(
    "--level",
    type=click.FloatRange(0, 1, min_open=True, max_open=True),
    default=0.95,
    show_default=True,
    help="Of all intervals.",
)
@click.option(
    "--modes",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Save a CSV file of the probability of each mode at every step.",
)
@click.option(
    "--figure",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Draw what was found: .png, .svg or .pdf.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of tables.")
def command(
    *,
    logs: tuple[Path, ...],
    each_trial: bool,
    between_trials: str,
    first_mode: str | None,
    memory: int | None,
    lapse: float,
    prior: Literal["uniform", "population"],
    values: tuple[float, ...],
    level: float,
    modes: Path | None,
    figure: Path | None,
    as_json: bool,
) -> None:
    """Adaptability of people and populations, from logs.

    LOG is a log with decisions, written by `coadapt play`, `simulate --log` or a study. Several
    files are several participants; within a file the column "participant" tells them apart. A
    folder that `coadapt study export` wrote stands for the logs in it.

    For each participant: the posterior of alpha with a credible interval. For the population: mean
    and standard deviation of a beta distribution by maximum likelihood with confidence intervals,
    and weights of a few values by EM. Then how other models of people fit the same inputs.
    """
    for path in (modes, figure):
        if path is not None:
            require_writable(path, *logs)
    if figure is not None and figure.suffix not in FIGURES:
        raise InputError(f"--figure must end in {', '.join(FIGURES)}, not {figure.name}")
    with progress_line(not as_json) as tell:
        tell("Reading")
        from coadapt.analysis.adaptability.fit import fit_adaptability
        from coadapt.analysis.adaptability.logs import logs_in, read_logs
        from coadapt.cli.fit_output import lines, record, write_modes

        read = read_logs(logs_in(logs), each_trial=each_trial)
        person = _person(read, between_trials == "keep", first_mode, memory, lapse)
        _require_values(values)
        tell(f"Fitting {len(read.recordings):,} participants")
        try:
            found = fit_adaptability(
                person, read.recordings, prior=prior, values=values, level=level
            )
        except ValueError as error:
            raise InputError(f"the logs cannot be fitted: {error}") from error
        if modes is not None:
            write_modes(modes, found)
        if figure is not None:
            from coadapt.report.figures import style
            from coadapt.report.figures.adaptability import adaptability

            with style.settings():
                figure.write_bytes(style.render(adaptability(found), figure.suffix[1:]))
    if as_json:
        click.echo(json.dumps(record(found)))
        return
    click.echo("\n".join(printable(line) for line in lines(found)))
    for path, what in ((modes, "Modes"), (figure, "Figure")):
        if path is not None:
            click.echo(f"{what} saved to {printable(str(path))}")


def _person(
    read: Logs, mode_lasts: bool, first_mode: str | None, memory: int | None, lapse: float
) -> PersonModel:
    from dataclasses import replace

    from coadapt.analysis.adaptability import PersonModel

    model = read.model
    if memory is not None and memory != model.memory:
        try:
            model = replace(model, memory=memory)
        except ValueError as error:
            raise InputError(f"--memory cannot be used: {error}") from error
    if first_mode is not None and first_mode not in model.mode_names:
        names = ", ".join(model.mode_names)
        raise InputError(f"--first-mode must be one of {names}, not {first_mode!r}")
    first = None if first_mode is None else model.mode_names.index(first_mode)
    return PersonModel(model, mode_lasts=mode_lasts, first_mode=first, lapse=lapse)


def _require_values(values: tuple[float, ...]) -> None:
    inside = all(0 <= value <= 1 for value in values)
    if not inside or any(a >= b for a, b in pairwise(values)):
        shown = ",".join(f"{value:g}" for value in values)
        raise InputError(f"--values must increase and lie from 0 to 1, not {shown}")
