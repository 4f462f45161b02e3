"""A PostgreSQL server for a while: Debian's, with an empty database in a temporary directory."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import time
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from tempfile import mkdtemp

USER = "postgres"
"""The account that Debian's package makes: PostgreSQL refuses to run as root."""

PATIENCE = 30.0
"""Seconds for the server to start."""


def binary(name: str) -> Path:
    """A program of PostgreSQL, in the path or where Debian has it.

    Raises:
        FileNotFoundError: if it is not installed.
    """
    found = sorted(Path("/usr/lib/postgresql").glob(f"*/bin/{name}"), reverse=True)
    if found:
        return found[0]
    there = shutil.which(name)
    if there is None:
        raise FileNotFoundError(f"{name} of PostgreSQL is not installed")
    return Path(there)


def as_ordinary_user(command: list[str]) -> list[str]:
    """``command`` as somebody else, if this is root."""
    return ["runuser", "-u", USER, "--", *command] if os.geteuid() == 0 else command


def free_port() -> int:
    """A port of this machine that nobody uses now."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        return int(server.getsockname()[1])


@contextmanager
def postgres(*settings: str) -> Generator[str]:
    """The URL of a new database; the server ends with the block.

    Args:
        settings: of the server, for example ``"max_connections=200"``.
    """
    home = Path(mkdtemp(prefix="coadapt-postgres-"))
    if os.geteuid() == 0:
        shutil.chown(home, USER)
    data, port = home / "data", free_port()
    server: subprocess.Popen[bytes] | None = None
    try:
        make = [f"{binary('initdb')}", "-D", f"{data}", "-U", "coadapt", "-A", "trust", "--no-sync"]
        subprocess.run(
            as_ordinary_user([*make, "-E", "UTF8"]),
            check=True,
            stdout=subprocess.DEVNULL,
            cwd=home,
        )
        options = [f"port={port}", "listen_addresses=127.0.0.1", f"unix_socket_directories={home}"]
        command = [f"{binary('postgres')}", "-D", f"{data}"]
        for option in [*options, *settings]:
            command += ["-c", option]
        server = subprocess.Popen(
            as_ordinary_user(command),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            cwd=home,
        )
        _wait(server, port)
        yield f"postgresql://coadapt@127.0.0.1:{port}/postgres"
    finally:
        if server is not None:
            _stop(server, data)
        shutil.rmtree(home, ignore_errors=True)


def _wait(server: subprocess.Popen[bytes], port: int) -> None:
    end = time.monotonic() + PATIENCE
    ready = [f"{binary('pg_isready')}", "-q", "-h", "127.0.0.1", "-p", f"{port}", "-U", "coadapt"]
    while subprocess.run(ready, check=False).returncode != 0:
        if server.poll() is not None or time.monotonic() > end:
            raise RuntimeError("PostgreSQL did not start")
        time.sleep(0.05)


def _stop(server: subprocess.Popen[bytes], data: Path) -> None:
    stop = [f"{binary('pg_ctl')}", "-D", f"{data}", "-m", "immediate", "-w", "stop"]
    subprocess.run(as_ordinary_user(stop), check=False, stdout=subprocess.DEVNULL, cwd="/")
    server.wait(timeout=PATIENCE)
