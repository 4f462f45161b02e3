"""``coadapt study export``: the data as tables."""

from __future__ import annotations

import time
from pathlib import Path

import click

from coadapt.cli.progress import progress_line
from coadapt.cli.study.data import database_option, stored_data
from coadapt.errors import printable


@click.command(name="export")
@click.argument("directory", type=click.Path(path_type=Path))
@click.option(
    "--out",
    required=True,
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="A new folder, or an older export, which is replaced.",
)
@click.option(
    "--private",
    is_flag=True,
    help="Also what those did who declined or withdrew; else only that they did.",
)
@click.option(
    "--identities",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Also write a CSV file that says who each pseudonym is, by the parameters of their link. "
    "Keep it apart from the export.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@database_option
def command(
    *,
    directory: Path,
    out: Path,
    private: bool,
    identities: Path | None,
    as_json: bool,
    database: str | None,
) -> int:
    """Export the data of the study in DIRECTORY as tables.

    Writes participants, trials, steps, answers and events as CSV and Parquet files with a codebook,
    in the layout of Psych-DS. Nothing in it names a person. The study may be running.
    """
    import msgspec

    from coadapt.study.export import export
    from coadapt.study.export.identities import write_identities

    with stored_data(directory, database) as (stored, _), progress_line() as tell:
        manifest = export(stored, out, time.time(), private=private, progress=tell)
        if identities is not None:
            write_identities(stored, identities)
    if as_json:
        click.echo(msgspec.json.encode(manifest).decode())
        return 0
    counts = manifest.counts
    click.echo(f"Wrote {printable(str(out))}: {counts.sessions:,} sessions.")
    for name, count in counts.standing.items():
        click.echo(f"  {count:>7,} {name}")
    if counts.deleted:
        click.echo(f"  {counts.deleted:>7,} deleted, of which nothing is left")
    if counts.simulated:
        click.echo(f"  {counts.simulated:>7,} of them simulated")
    click.echo(f"To be analysed: {counts.included:,}. Read {printable(str(out / 'README.md'))}.")
    return 0
