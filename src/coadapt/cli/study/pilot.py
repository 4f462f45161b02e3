"""``coadapt study pilot``: a study with simulated participants."""

from __future__ import annotations

import asyncio
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import click

from coadapt.cli.options import number_option, numbers
from coadapt.cli.progress import progress_line
from coadapt.cli.study.data import database_option
from coadapt.cli.study.serve import require_extra
from coadapt.errors import InputError

if TYPE_CHECKING:
    from coadapt.study.pilot import Piloted
    from coadapt.study.store import Durability, Store

FAILED = 1
"""Exit code where a simulated participant could not take part as a real one should."""


@click.command(name="pilot")
@click.argument("directory", type=click.Path(path_type=Path))
@click.option(
    "-n",
    "n",
    type=click.IntRange(1, 100_000),
    default=10,
    show_default=True,
    help="How many participants come.",
)
@click.option(
    "--seed",
    type=click.IntRange(0),
    default=1,
    show_default=True,
    help="Of what they are like and do.",
)
@click.option(
    "--fast/--real-time",
    default=True,
    show_default=True,
    help="The robot moves at every input, or by the protocol's clock. Only for a server "
    "of the pilot's own.",
)
@click.option(
    "--at-once",
    type=click.IntRange(1, 1000),
    default=17,
    show_default=True,
    help="How many take part at the same time.",
)
@click.option(
    "--adaptability",
    type=numbers,
    default="0,0.25,0.5,0.75,1",
    show_default=True,
    help="Values of alpha, equally likely.",
)
@number_option("--noise", click.FloatRange(0, 1), 0.05, "Probability of an arbitrary input.")
@number_option("--leaves", click.FloatRange(0, 1), 0.06, "Probability of dropping out.")
@number_option(
    "--reloads",
    click.FloatRange(0, 1),
    0.04,
    "Probability of loading the page again while steering.",
)
@number_option(
    "--disconnects",
    click.FloatRange(0, 1),
    0.04,
    "Probability of losing the connection while steering.",
)
@click.option(
    "--url", default=None, metavar="URL", help="A server that is running.  [one of the pilot's own]"
)
@click.option(
    "--durability",
    type=click.Choice(["power", "process"]),
    default="process",
    show_default=True,
    help="Of data in SQLite, by the pilot's own server.",
)
@click.option("--force", is_flag=True, help="Also into a study that real people take part in.")
@click.option("--remove", is_flag=True, help="Remove all simulated sessions, and do nothing else.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@database_option
def command(
    *,
    directory: Path,
    n: int,
    seed: int,
    fast: bool,
    at_once: int,
    adaptability: tuple[float, ...],
    noise: float,
    leaves: float,
    reloads: float,
    disconnects: float,
    url: str | None,
    durability: Durability,
    force: bool,
    remove: bool,
    as_json: bool,
    database: str | None,
) -> int:
    """Try the study in DIRECTORY with simulated participants.

    They come through the same pages as real ones, steer, answer, and some drop out, load the page
    again or lose their connection. Their sessions are marked as simulated for good. The same seed
    gives the same inputs and answers, in a new study with --fast. Before real people come,
    --remove takes them away.
    """
    require_extra()
    from coadapt.study.pilot import Population, own_server, pilot
    from coadapt.study.protocol import read_study
    from coadapt.study.protocol.reader import study_task
    from coadapt.study.store import Store

    study = read_study(directory)
    model = study_task(study, directory).build()
    try:
        population = Population(adaptability, noise, leaves, reloads, disconnects)
    except ValueError as error:
        raise InputError(str(error)) from error
    store = Store(database or Store.url_in(directory))
    try:
        if remove:
            return _remove(store)
        if not force:
            _require_no_real_people(store)
    finally:
        store.close()
    with ExitStack() as stack:
        tell = stack.enter_context(progress_line())
        if url is None:
            tell("Starting the server; planning the first time")
            url = stack.enter_context(own_server(directory, database, durability, fast=fast))
        done = asyncio.run(
            pilot(study, model, url, n, seed, population, at_once=at_once, progress=tell)
        )
    return _report(done, as_json)


def _report(done: Piloted, as_json: bool) -> int:
    import msgspec

    failures = [f"participant {o.person.number}: {o.problem}" for o in done.failures]
    if as_json:
        found = {"participants": len(done.outcomes), "endings": done.endings, "failures": failures}
        click.echo(msgspec.json.encode(found).decode())
    else:
        click.echo(f"{len(done.outcomes):,} simulated participants came.")
        for ending, count in done.endings.items():
            click.echo(f"  {count:>7,} {ending}")
        for failure in failures:
            click.echo(failure, err=True)
    return FAILED if failures else 0


def _require_no_real_people(store: Store) -> None:
    from coadapt.study.record import SIMULATED

    real = len(store.rows()) - len(store.noted(SIMULATED))
    if real:
        raise InputError(
            f"found {real:,} sessions of real people in this study, expected none; pilot a copy of "
            "its directory, or give --force"
        )


def _remove(store: Store) -> int:
    from coadapt.study.record import SIMULATED

    simulated = store.noted(SIMULATED)
    with store.database.writing() as connection:
        store.remove_simulated(connection, simulated)
    click.echo(f"Removed {len(simulated):,} simulated sessions.")
    return 0
