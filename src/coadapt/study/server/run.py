"""A study's server: put together, and run until it is told to stop."""

from __future__ import annotations

import gc
import logging
import socket
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from ipaddress import ip_address
from pathlib import Path

import numpy as np
import uvicorn
from starlette.types import ASGIApp

from coadapt.errors import FileError, InputError
from coadapt.robots.setup import Progress
from coadapt.study.protocol import read_study
from coadapt.study.protocol.reader import study_task
from coadapt.study.robots import load_robots, model_of
from coadapt.study.server.admin import Desk, admin_routes
from coadapt.study.server.app import Site, study_app
from coadapt.study.server.line import DirectWebSocket
from coadapt.study.server.messages import LONGEST_MESSAGE
from coadapt.study.server.pages import Pages
from coadapt.study.server.service import Service
from coadapt.study.server.unchanged import keep_protocol
from coadapt.study.session import Stage
from coadapt.study.store import Durability, Store
from coadapt.study.trial import Attempt

GRACE = 10
"""Seconds that requests under way have when the server stops."""

PINGS = 20.0
"""Seconds between signs of life of a websocket, and to wait for the answer."""

SWITCH = 0.0005
"""Seconds after which a thread makes room for another that waits for the interpreter."""

GARBAGE = (20_000, 50, 100)
"""Objects that are more than at the last look for garbage, and how many looks at the youngest come
between looks at older ones. Little of what comes and goes here is left for them to find."""

BACKLOG = 2048
"""Connections that wait to be accepted."""


@dataclass(frozen=True)
class Address:
    """Where the server listens.

    Attributes:
        host, port: of this machine; any free port if 0.
        certificate, key: PEM files for TLS, both or none.
        public: how participants reach it, for example through a proxy; as ``host`` and ``port``
            say if "".
        proxies: addresses from which forwarded addresses of clients are believed.
    """

    host: str = "127.0.0.1"
    port: int = 8000
    certificate: Path | None = None
    key: Path | None = None
    public: str = ""
    proxies: str = "127.0.0.1"

    def link(self, port: int) -> str:
        """The beginning of all links, once the ``port`` is known."""
        scheme = "https" if self.certificate else "http"
        host = f"[{self.host}]" if ":" in self.host else self.host
        return self.public.rstrip("/") or f"{scheme}://{host}:{port}"

    @property
    def is_secure(self) -> bool:
        """Whether browsers reach it over TLS."""
        return self.link(0).startswith("https://")

    @property
    def is_secure_context(self) -> bool:
        """Whether browsers offer gamepads to its pages: over TLS, or on the same machine."""
        host = self.link(0).partition("://")[2].partition("/")[0]
        name = host[1:].partition("]")[0] if host.startswith("[") else host.partition(":")[0]
        try:
            local = ip_address(name).is_loopback
        except ValueError:
            local = name == "localhost" or name.endswith(".localhost")
        return self.is_secure or local


def load_service(
    directory: Path,
    url: str | None = None,
    durability: Durability = "power",
    *,
    accept_changes: bool = False,
    progress: Progress | None = None,
) -> Service:
    """The study in ``directory``, its policies planned and its database open.

    Raises:
        InputError: if protocol, policies or database cannot be used.
        KeyboardInterrupt: if planning was interrupted.
    """
    study = read_study(directory)
    store = Store(url or Store.url_in(directory), durability)
    try:
        task = study_task(study, directory)
        keep_protocol(store, study, task, directory, accept=accept_changes)
        robots = load_robots(study, directory, progress)
        if progress is not None:
            progress("Preparing the robots")
        for robot in robots.values():  # the first decision takes long: it is compiled, or loaded
            rng = np.random.default_rng(0)
            Attempt(robot, Stage("trial"), 1, None, rng, study.clock.most_steps).step(None)
    except BaseException:
        store.close()
        raise
    return Service(study, robots, store, directory)


def make_app(service: Service, *, secure: bool) -> ASGIApp:
    """The web application of a study."""
    pages = Pages(service.study, model_of(service.robots))
    site = Site(service, pages, secure=secure)
    return study_app(site, admin_routes(Desk(service, site.connections), secure=secure))


def bind(address: Address) -> socket.socket:
    """A socket that listens at ``address``.

    Raises:
        InputError: if it cannot.
    """
    family = socket.AF_INET6 if ":" in address.host else socket.AF_INET
    try:
        return socket.create_server(
            (address.host, address.port), family=family, backlog=BACKLOG, reuse_port=False
        )
    except OSError as error:
        where = f"{address.host} port {address.port}"
        raise InputError(f"cannot listen at {where}: {error.strerror or error}") from error


def run(
    app: ASGIApp, address: Address, listening: socket.socket, started: Callable[[], None]
) -> None:
    """Serve ``app`` until the process is told to end (SIGINT or SIGTERM).

    Args:
        app: the application.
        address: where it is.
        listening: the socket of `bind`.
        started: called once requests are taken.

    Raises:
        InputError: if certificate and key cannot be used.
    """
    _require_files(address)
    logging.getLogger("coadapt.study").setLevel(logging.INFO)
    config = uvicorn.Config(
        app,
        lifespan="on",
        log_level="warning",
        access_log=False,  # its lines would hold the participants' keys and network addresses
        server_header=False,
        proxy_headers=True,
        forwarded_allow_ips=address.proxies,
        ssl_certfile=address.certificate,
        ssl_keyfile=address.key,
        timeout_graceful_shutdown=GRACE,
        ws=DirectWebSocket,
        ws_max_size=2 * LONGEST_MESSAGE,
        ws_ping_interval=PINGS,
        ws_ping_timeout=PINGS,
        ws_per_message_deflate=False,
    )
    try:
        config.load()
    except OSError as error:  # ssl.SSLError is one
        raise InputError(f"certificate and key cannot be used: {error}") from error
    # What would make participants wait: the writing thread for the interpreter, 5 ms each time it
    # comes back from the database; and everybody for a look at all objects that are there now.
    sys.setswitchinterval(SWITCH)
    gc.collect()
    gc.freeze()
    gc.set_threshold(*GARBAGE)
    with suppress(KeyboardInterrupt):  # raised again by uvicorn once all is closed
        _Server(config, started).run([listening])


class _Server(uvicorn.Server):
    """Says when it has started."""

    def __init__(self, config: uvicorn.Config, started: Callable[[], None]) -> None:
        super().__init__(config)
        self._say_started = started

    async def startup(self, sockets: Sequence[socket.socket] | None = None) -> None:
        await super().startup(None if sockets is None else list(sockets))
        if self.started:
            self._say_started()


def _require_files(address: Address) -> None:
    for path in (address.certificate, address.key):
        if path is not None and not path.is_file():
            raise FileError(path, None, "found no file, expected one in PEM format")
