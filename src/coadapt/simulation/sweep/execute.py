"""The cells that are not finished yet, through workers, into the store.

Cells with one plan make a group. For each group a worker plans once; the plan then goes to the
workers together with each of its cells. A bounded number of jobs is in hand at a time.

Where a worker process dies its pool is gone, and one cannot tell which of the jobs in hand killed
it. Each of those is suspect and runs again, alone. One that dies alone `STRIKES` times has failed.
"""

from __future__ import annotations

import os
import socket
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from dataclasses import dataclass, field
from typing import Any

from coadapt.errors import InputError
from coadapt.momdp.policy import AlphaVectorPolicy
from coadapt.simulation.sweep.cell import Cell
from coadapt.simulation.sweep.store import Store
from coadapt.simulation.sweep.work import Failure, Found, Plan, plan, run
from coadapt.simulation.sweep.workers import Workers

STRIKES = 2
"""Workers that a job may kill while it runs alone."""

Tell = Callable[[Cell, Failure | None], None]
"""Called for every cell that is done with, with what went wrong if something did."""


@dataclass
class _Job:
    """Something for a worker.

    Attributes:
        cells: those that fail if it does: a group for its plan, or a single one.
        policy: for the run of a single cell.
        is_plan: whether this is the plan of a group.
        strikes: workers it killed while it ran alone.
    """

    cells: list[Cell]
    is_plan: bool
    policy: AlphaVectorPolicy | None = None
    strikes: int = 0


@dataclass
class _State:
    """Jobs by what is to be done with them."""

    plans: Iterator[_Job]
    ready: deque[_Job] = field(default_factory=deque[_Job])
    suspects: deque[_Job] = field(default_factory=deque[_Job])
    running: dict[Future[Any], _Job] = field(default_factory=dict[Future[Any], _Job])


def execute(cells: Iterable[Cell], store: Store, workers: Workers, tell: Tell) -> None:
    """Find out about all ``cells`` that are not in the store.

    Args:
        cells: the cells to do, none twice.
        store: gets each result as soon as it is there.
        workers: do the work. They are left open.
        tell: told of each cell when it is done with.

    Raises:
        InputError: if a cluster is lost.
        FileError: if a result cannot be written.
    """
    groups: dict[str, list[Cell]] = {}
    for cell in cells:
        groups.setdefault(cell.plan_key, []).append(cell)
    _Execution(groups.values(), store, workers, tell).go()


class _Execution:
    def __init__(
        self, groups: Iterable[list[Cell]], store: Store, workers: Workers, tell: Tell
    ) -> None:
        self._store, self._workers, self._tell = store, workers, tell
        self._state = _State(plans=(_Job(group, is_plan=True) for group in groups))

    def go(self) -> None:
        """Until nothing is left."""
        state = self._state
        while True:
            gone, dead = self._fill(), list[_Job]()
            if not gone:
                if not state.running:
                    return
                finished, _ = wait(state.running, return_when=FIRST_COMPLETED)
                dead = [job for future in finished if (job := self._take(future)) is not None]
            if gone or dead:
                self._renew(dead)

    def _fill(self) -> bool:
        """Hand out jobs; whether the pool was found to be gone."""
        state = self._state
        if state.suspects:
            return not state.running and self._submit(state.suspects.popleft(), state.suspects)
        capacity = self._workers.capacity()
        while len(state.running) < capacity:
            job = self._next()
            if job is None:
                break
            if self._submit(job, state.ready):
                return True
        return False

    def _next(self) -> _Job | None:
        """The next job of which something is left to do: others may share the directory."""
        state = self._state
        while True:
            job = state.ready.popleft() if state.ready else next(state.plans, None)
            if job is None:
                return None
            left: list[Cell] = []
            for cell in job.cells:
                if self._store.has(cell):
                    self._tell(cell, None)
                else:
                    left.append(cell)
            job.cells = left
            if left:
                return job

    def _submit(self, job: _Job, source: deque[_Job]) -> bool:
        """Hand out ``job``; if the pool is gone it returns to its ``source``, and True is said."""
        first = job.cells[0]
        try:
            if job.is_plan:
                future = self._workers.submit(plan, first)
            else:
                future = self._workers.submit(run, first, job.policy)
        except BrokenExecutor:
            source.appendleft(job)
            return True
        self._state.running[future] = job
        return False

    def _take(self, future: Future[Any]) -> _Job | None:
        """Take in what a job came to; the job itself if its pool is gone."""
        job = self._state.running.pop(future)
        try:
            found: object = future.result()
        except CancelledError as error:
            raise InputError(
                "the workers are gone; run the same command again to go on where it ended"
            ) from error
        except Exception as error:
            if self._workers.lost(error):
                return job
            found = Failure(f"{type(error).__name__}: {' '.join(str(error).split())}")
        self._accept(job, found)
        return None

    def _accept(self, job: _Job, found: object) -> None:
        if isinstance(found, Failure):
            for cell in job.cells:
                self._store.add_failure(cell, found)
                self._note(cell, "failed", message=found.message)
                self._tell(cell, found)
        elif isinstance(found, Plan):
            self._note(job.cells[0], "plan", seconds=found.seconds)
            self._state.ready.extend(
                _Job([cell], is_plan=False, policy=found.policy) for cell in job.cells
            )
        else:
            assert isinstance(found, Found)
            (cell,) = job.cells
            self._store.add(cell, found.rows)
            self._note(cell, "cell", seconds=found.seconds)
            self._tell(cell, None)

    def _renew(self, dead: list[_Job]) -> None:
        """Begin anew where a pool is gone, with what was in hand."""
        state = self._state
        for future in list(state.running):
            if future.done() and (job := self._take(future)) is not None:
                dead.append(job)
        dead += state.running.values()
        state.running.clear()
        self._workers.renew()
        if len(dead) != 1:
            state.suspects.extend(dead)
            return
        (job,) = dead
        job.strikes += 1
        if job.strikes < STRIKES:
            state.suspects.append(job)
        else:
            what = "planning" if job.is_plan else "the cell"
            self._accept(job, Failure(f"{what} ended its worker process {job.strikes} times"))

    def _note(self, cell: Cell, event: str, **more: object) -> None:
        self._store.log(
            {
                "time": time.time(),
                "host": socket.gethostname(),
                "process": os.getpid(),
                "event": event,
                "cell": cell.key,
                **more,
            }
        )
