"""``coadapt study``: a protocol, a server for participants, the data."""

from __future__ import annotations

import click

from coadapt.cli.lazy import LazyGroup

COMMANDS = {
    "export": "Write the data as tables with a codebook.",
    "new": "Begin a study: write its protocol.",
    "pilot": "Try a study with simulated participants.",
    "replay": "Compute every belief and decision again, and compare.",
    "serve": "Serve a study to its participants.",
    "status": "Count the sessions by what became of them.",
}
"""Every command with its one-line summary; ``coadapt.cli.study.NAME`` holds it as ``command``."""


@click.group(
    name="study",
    cls=LazyGroup,
    package="coadapt.cli.study",
    summaries=COMMANDS,
    invoke_without_command=True,
)
@click.pass_context
def command(ctx: click.Context) -> None:
    """Studies that people take part in.

    A study is a directory with its protocol, `study.toml`, its policies and its database.
    """
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())
