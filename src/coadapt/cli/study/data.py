"""What commands that read a study's data have in common."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from coadapt.cli.study.serve import require_extra
from coadapt.errors import FileError, InputError

if TYPE_CHECKING:
    from coadapt.study.record import Stored
    from coadapt.study.store import Store

Function = TypeVar("Function", bound=Callable[..., Any])


def database_option(function: Function) -> Function:
    """Add the option that names another database than that of the directory."""
    return click.option(
        "--database",
        metavar="URL",
        envvar="COADAPT_DATABASE",
        help="PostgreSQL, postgresql://USER:PASSWORD@HOST/NAME, or the variable COADAPT_DATABASE.  "
        "[SQLite, study.db in DIRECTORY]",
    )(function)


@contextmanager
def stored_data(directory: Path, url: str | None) -> Generator[tuple[Stored, Store]]:
    """The study in ``directory`` and its database, which must be there.

    Raises:
        InputError: if one of them is missing or cannot be used.
    """
    require_extra()

    from coadapt.study.protocol import read_study
    from coadapt.study.record import Stored
    from coadapt.study.session import NotNow
    from coadapt.study.store import Store, StoreError
    from coadapt.study.store.store import FILE

    study = read_study(directory)
    if url is None and not (directory / FILE).is_file():
        raise FileError(
            directory / FILE, None, "found no data, expected those of a study that was served"
        )
    store = Store(url or Store.url_in(directory))
    try:
        yield Stored.of(directory, study, store), store
    except StoreError as error:
        raise InputError(f"the data cannot be read: {error}") from error
    except NotNow as error:
        raise InputError(
            f"the data do not fit study.toml ({error}); was it changed? `coadapt study replay` "
            "says which sessions"
        ) from error
    finally:
        store.close()
