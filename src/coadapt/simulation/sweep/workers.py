"""Where cells are worked on: processes of this machine, or a Dask cluster.

Both are executors of the standard library's interface, with the little that it leaves open.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from typing import Any, Protocol

from coadapt.errors import InputError

AHEAD = 2
"""Jobs in hand for each process, so that none waits for the next."""


class Workers(Protocol):
    """Executes functions somewhere else."""

    def submit(self, function: Callable[..., Any], *arguments: object) -> Future[Any]:
        """Have ``function`` called. Raises `BrokenExecutor` where that cannot be."""
        ...

    def capacity(self) -> int:
        """How many jobs to have in hand at a time."""
        ...

    def lost(self, error: BaseException) -> bool:
        """Whether ``error`` of a job means that its executor is gone, with all its jobs."""
        ...

    def renew(self) -> None:
        """Begin anew with another executor."""
        ...

    def close(self, *, now: bool = False) -> None:
        """End; with ``now`` without waiting for what is being worked on."""
        ...


class LocalWorkers:
    """Processes of this machine, started afresh.

    They end with this process, however it ends. A process that dies takes the jobs of all with
    it, see `renew`.

    Args:
        jobs: number of processes, at least 1.
    """

    def __init__(self, jobs: int) -> None:
        self.jobs = jobs
        self._others = set(active_children())
        self._pool = self._new()

    def _new(self) -> Executor:
        return ProcessPoolExecutor(self.jobs, get_context("spawn"), initializer=_begin_worker)

    def submit(self, function: Callable[..., Any], *arguments: object) -> Future[Any]:
        """See `Workers.submit`."""
        return self._pool.submit(function, *arguments)

    def capacity(self) -> int:
        """See `Workers.capacity`."""
        return AHEAD * self.jobs

    def lost(self, error: BaseException) -> bool:
        """See `Workers.lost`."""
        return isinstance(error, BrokenExecutor)

    def renew(self) -> None:
        """A fresh pool."""
        self.close(now=True)
        self._pool = self._new()

    def close(self, *, now: bool = False) -> None:
        """See `Workers.close`."""
        self._pool.shutdown(wait=not now, cancel_futures=True)
        if now:
            for process in self._processes():
                process.terminate()
            for process in self._processes():
                process.join()

    def _processes(self) -> list[BaseProcess]:
        return [process for process in active_children() if process not in self._others]


def _begin_worker() -> None:
    """Leave interrupts to the parent, and end when it is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    assert parent is not None
    sentinel = parent.sentinel

    def follow() -> None:
        wait([sentinel])
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


class DaskWorkers:
    """An existing Dask cluster.

    Dask itself gives the jobs of a worker that died to others, and gives up a job that kills
    several.

    Args:
        address: of the scheduler, for example ``tcp://host:8786``.

    Raises:
        InputError: if Dask is not installed, or there is no scheduler.
    """

    PATIENCE = 30
    """Seconds to wait for the scheduler."""

    def __init__(self, address: str) -> None:
        try:
            from distributed import Client  # noqa: PLC0415
        except ImportError as error:
            raise InputError(
                "a Dask cluster needs the package distributed: pip install 'coadapt[dask]'"
            ) from error
        try:
            self._client: Any = Client(address, timeout=self.PATIENCE, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            raise InputError(f"found no Dask scheduler at {address} ({error})") from error
        self._pool: Any = self._client.get_executor(pure=False)

    def submit(self, function: Callable[..., Any], *arguments: object) -> Future[Any]:
        """See `Workers.submit`."""
        return self._pool.submit(function, *arguments)

    def capacity(self) -> int:
        """See `Workers.capacity`; follows the cluster as it grows."""
        return max(8, AHEAD * sum(self._client.ncores().values()))

    def lost(self, error: BaseException) -> bool:
        """See `Workers.lost`."""
        return False

    def renew(self) -> None:
        """Dask needs no renewal."""

    def close(self, *, now: bool = False) -> None:
        """See `Workers.close`; the cluster goes on."""
        self._pool.shutdown(wait=not now)
        self._client.close()
