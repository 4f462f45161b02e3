"""``coadapt study replay``: every belief and decision once more."""

from __future__ import annotations

from pathlib import Path

import click

from coadapt.cli.progress import progress_line
from coadapt.cli.study.data import database_option, stored_data

DIFFERS = 1
"""Exit code where something is stored otherwise than it is computed."""

SHOWN = 20
"""Differences printed one by one."""


@click.command(name="replay")
@click.argument("directory", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@database_option
def command(*, directory: Path, as_json: bool, database: str | None) -> int:
    """Compute every belief, decision and allocation of the study in DIRECTORY again.

    They follow from what participants did and when. Any difference from what is stored is
    reported, to the last bit; the exit code is 1 then.
    """
    import msgspec

    from coadapt.study.replay import replay
    from coadapt.study.robots import load_robots

    with stored_data(directory, database) as (stored, _), progress_line() as tell:
        robots = load_robots(stored.study, directory, tell)
        found = replay(stored, robots, tell)
    if as_json:
        click.echo(msgspec.json.encode(found).decode())
    else:
        click.echo(
            f"Replayed {found.sessions:,} sessions: {found.events:,} events, "
            f"{found.attempts:,} attempts, {found.steps:,} steps, "
            f"{found.allocations:,} allocations."
        )
        if found.unchecked:
            click.echo(
                f"{found.unchecked:,} allocations cannot be checked: sessions were deleted since."
            )
        for difference in found.differences[:SHOWN]:
            click.echo(f"{difference.participant}, {difference.where}: {difference.what} differs")
            click.echo(f"  stored   {difference.stored}")
            click.echo(f"  computed {difference.computed}")
        more = len(found.differences) - SHOWN
        click.echo(
            f"{len(found.differences):,} differences"
            + (f", of which {SHOWN} are shown; --json gives all." if more > 0 else ".")
        )
    return DIFFERS if found.differences else 0
