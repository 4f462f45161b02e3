"""``coadapt study new``: begin a study."""

from __future__ import annotations

from pathlib import Path

import click

from coadapt.errors import FileError, printable


@click.command(name="new")
@click.argument("directory", type=click.Path(path_type=Path))
def command(directory: Path) -> int:
    """Begin a study: write its protocol.

    Makes DIRECTORY, if there is none, with a `study.toml` in it: the study of the paper (Sec. 6),
    to be changed. A `study.toml` that is there is never replaced.
    """
    from coadapt.study.protocol.reader import FILE, template

    path = directory / FILE
    if directory.exists() and not directory.is_dir():
        raise FileError(directory, None, "found a file, expected a directory or nothing")
    directory.mkdir(parents=True, exist_ok=True)
    try:
        with path.open("xb") as stream:
            stream.write(template())
    except FileExistsError:
        raise FileError(path, None, "found a protocol already, expected none") from None
    shown = printable(str(directory))
    click.echo(f"Wrote {printable(str(path))}. Next:")
    click.echo("  1. Put in your consent text, your contact and whatever else differs.")
    click.echo(f"  2. coadapt study serve {shown}")
    return 0
