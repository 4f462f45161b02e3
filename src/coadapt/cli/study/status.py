"""``coadapt study status``: how far a study has come."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from coadapt.cli.study.data import database_option, stored_data
from coadapt.errors import printable


@click.command(name="status")
@click.argument("directory", type=click.Path(path_type=Path))
@click.option(
    "--unblinded",
    is_flag=True,
    help="Also the conditions. Whoever decides about going on or excluding should not know them.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@database_option
def command(*, directory: Path, unblinded: bool, as_json: bool, database: str | None) -> int:
    """Count the sessions of the study in DIRECTORY by what became of them.

    The study may be running.
    """
    import msgspec

    from coadapt.study.census import census

    with stored_data(directory, database) as (stored, store):
        found = census(
            stored.study,
            stored.records(),
            time.time(),
            deleted=len(stored.deleted),
            unblinded=unblinded,
        )
        is_open = store.setting("status") or "open"
    if as_json:
        click.echo(msgspec.json.encode({"status": is_open, **msgspec.to_builtins(found)}).decode())
        return 0
    click.echo(f"{printable(stored.study.title)}: {is_open}, {found.sessions:,} sessions")
    _table("By standing", found.standings)
    _table("Under way, by stage", found.stages)
    _table("By device", found.devices)
    for name, counts in (found.conditions or {}).items():
        _table(f"Condition {name}", counts)
    if found.simulated:
        click.echo(f"{found.simulated:,} of them are simulated.")
    if found.deleted:
        click.echo(f"{found.deleted:,} more were deleted.")
    return 0


def _table(heading: str, counts: Mapping[Any, int]) -> None:
    if counts:
        click.echo(heading)
        for name, count in counts.items():
            click.echo(f"  {count:>7,} {name}")
