"""``coadapt study serve``: serve a study to its participants."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from coadapt.cli.progress import progress_line
from coadapt.errors import InputError

if TYPE_CHECKING:
    from coadapt.study.store import Durability

INSECURE = """\
Warning: participants reach this address without TLS and from other machines, so that their browsers
offer no gamepads and anyone on the way can read along. Give --certificate and --key, or --url where
a proxy does it."""


@click.command(name="serve")
@click.argument("directory", type=click.Path(path_type=Path))
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen at.")
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=8000,
    show_default=True,
    help="Port to listen at; 0 for any free one.",
)
@click.option(
    "--database",
    metavar="URL",
    envvar="COADAPT_DATABASE",
    help="PostgreSQL, postgresql://USER:PASSWORD@HOST/NAME, or the variable COADAPT_DATABASE.  "
    "[SQLite, study.db in DIRECTORY]",
)
@click.option(
    "--durability",
    type=click.Choice(["power", "process"]),
    default="power",
    show_default=True,
    help="What data in SQLite survive: a loss of power, or the end of a process only (faster).",
)
@click.option("--certificate", type=click.Path(path_type=Path), help="Certificate for TLS, PEM.")
@click.option("--key", type=click.Path(path_type=Path), help="Its key, PEM.")
@click.option("--url", default="", metavar="URL", help="How participants reach this server.")
@click.option(
    "--proxies",
    default="127.0.0.1",
    show_default=True,
    help="Proxies that are believed about who asks, separated by commas.",
)
@click.option("--new-token", is_flag=True, help="Make a new admin link; the old one ends.")
@click.option("--accept-changes", is_flag=True, help="Serve though the protocol changed under way.")
def command(
    *,
    directory: Path,
    host: str,
    port: int,
    database: str | None,
    durability: Durability,
    certificate: Path | None,
    key: Path | None,
    url: str,
    proxies: str,
    new_token: bool,
    accept_changes: bool,
) -> int:
    """Serve a study to its participants.

    Plans the robots' policies, once, and serves the study in DIRECTORY until Ctrl-C. Prints the
    link for participants and, at the first time, the one for the researcher.
    """
    if (certificate is None) != (key is None):
        raise InputError("--certificate and --key go together")
    if url and not url.startswith(("http://", "https://")):
        raise InputError("--url must begin with http:// or https://")
    require_extra()

    from coadapt.study.server.run import Address, bind, load_service, make_app, run
    from coadapt.study.server.security import ADMIN_TOKEN, new_admin_token

    address = Address(host, port, certificate, key, url, proxies)
    listening = bind(address)
    with listening:
        with progress_line() as tell:
            service = load_service(
                directory, database, durability, accept_changes=accept_changes, progress=tell
            )
        try:
            app = make_app(service, secure=address.is_secure)
            link = address.link(listening.getsockname()[1])
            store = service.store
            fresh = new_token or store.setting(ADMIN_TOKEN) is None
            token = new_admin_token(store) if fresh else None

            def started() -> None:
                parameters = service.study.recruitment.parameters
                click.echo(f"Participants: {link}/")
                if parameters:
                    click.echo(f"  with a recruitment service: {example(link, parameters)}")
                if token is not None:
                    click.echo(f"Researcher:   {link}/admin?token={token}")
                    click.echo(
                        "  Keep this link. It is not shown again; --new-token makes another."
                    )
                else:
                    click.echo("Researcher:   the link shown at the first start, or --new-token")
                if not address.is_secure_context:
                    click.echo(INSECURE, err=True)
                click.echo("Ctrl-C ends the server. Everything is stored as it happens.")

            run(app, address, listening, started)
        finally:
            service.store.close()
    return 0


def example(link: str, parameters: tuple[str, ...]) -> str:
    """What to give a recruitment service that fills in ``{{%NAME%}}``."""
    return f"{link}/?" + "&".join(f"{name}={{{{%{name}%}}}}" for name in parameters)


def require_extra() -> None:
    """Raise InputError unless what a server needs is installed."""
    try:
        import sqlalchemy
        import starlette
        import uvicorn
    except ImportError as error:
        raise InputError(
            f"a study needs {error.name}, which is not installed: pip install 'coadapt[study]'"
        ) from error
    del sqlalchemy, starlette, uvicorn
