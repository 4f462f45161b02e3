"""A server of the pilot's own, in a process of its own, until the pilot is over."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

from coadapt.errors import InputError
from coadapt.study.store import Durability

STOPS_WITHIN = 30.0
"""Seconds."""


@contextmanager
def own_server(
    directory: Path, database: str | None, durability: Durability, *, fast: bool
) -> Generator[str]:
    """The address of a server of the study in ``directory``, at a free port of this machine.

    Args:
        directory: of the study.
        database: URL of its database; that of the directory if None.
        durability: what stored data survive.
        fast: whether the robot moves at every input, whatever clock the protocol has.

    Raises:
        InputError: if the study cannot be served.
    """
    context = get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(
        target=_serve, args=(directory, database, durability, fast, there), daemon=True
    )
    process.start()
    there.close()
    try:
        try:
            said: str | InputError = here.recv()
        except EOFError:
            said = InputError("the server ended before it began")
        if isinstance(said, InputError):
            raise said
        yield said
    finally:
        process.terminate()
        process.join(STOPS_WITHIN)
        if process.is_alive():
            process.kill()


def _serve(
    directory: Path, database: str | None, durability: Durability, fast: bool, there: Connection
) -> None:
    import msgspec  # noqa: PLC0415

    from coadapt.study.server.run import Address, bind, load_service, make_app, run  # noqa: PLC0415

    address = Address(port=0)
    try:
        with bind(address) as listening:
            service = load_service(directory, database, durability)
            study = service.study
            if fast:
                clock = msgspec.structs.replace(study.clock, turns="wait")
                service.study = msgspec.structs.replace(study, clock=clock)
            link = address.link(listening.getsockname()[1])
            try:
                app = make_app(service, secure=False)
                run(app, address, listening, lambda: there.send(link))
            finally:
                service.store.close()
    except InputError as error:
        there.send(InputError(str(error)))
    except KeyboardInterrupt:
        pass
