"""Workers for tests: everything happens in this process, as soon as it is asked for."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Future
from typing import Any


class InlineWorkers:
    """Runs jobs at once; those that ``kills`` says end the worker instead.

    Attributes:
        kills: whether a job, by its function's name and its arguments, kills its worker.
        renewed: how often a new pool was made.
        jobs: the name and the arguments of every job handed out.
        closed: None until the workers are closed, then whether it was without waiting.
    """

    def __init__(self, kills: Callable[[str, tuple[Any, ...]], bool] | None = None) -> None:
        self.kills = kills or (lambda name, arguments: False)
        self.renewed = 0
        self.jobs: list[tuple[str, tuple[Any, ...]]] = []
        self.closed: bool | None = None
        self._broken = False

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        if self._broken:
            raise BrokenExecutor("gone")
        self.jobs.append((function.__name__, arguments))
        future: Future[Any] = Future()
        if self.kills(function.__name__, arguments):
            self._broken = True
            future.set_exception(BrokenExecutor("a worker died"))
        else:
            future.set_result(function(*arguments))
        return future

    def capacity(self) -> int:
        return 4

    def lost(self, error: BaseException) -> bool:
        return isinstance(error, BrokenExecutor)

    def renew(self) -> None:
        self._broken = False
        self.renewed += 1

    def close(self, *, now: bool = False) -> None:
        self.closed = now
