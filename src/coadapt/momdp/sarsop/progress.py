"""The line a person watches while the solver works."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from rich.status import Status

    from coadapt.momdp.sarsop.solution import Record

REFRESH_SECONDS = 0.1


class ProgressLine:
    """A line on standard error, redrawn in place; nothing where it is off or not a terminal."""

    def __init__(self, on: bool) -> None:
        self._on = on
        self._status: Status | None = None
        self._shown = 0.0

    def __enter__(self) -> Self:
        if self._on:
            from rich.console import Console  # noqa: PLC0415 (only where it is shown)

            console = Console(stderr=True)
            if console.is_terminal:
                self._status = console.status("")
                self._status.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._status is not None:
            self._status.stop()

    def say(self, text: str) -> None:
        """Show ``text``."""
        if self._status is not None:
            self._status.update(text)

    def show(self, record: Callable[[float], Record], seconds: float) -> None:
        """Show where the solver stands, a few times a second at most."""
        now = perf_counter()
        if self._status is None or now - self._shown < REFRESH_SECONDS:
            return
        self._shown = now
        r = record(seconds)
        rate = r.backups / r.seconds if r.seconds > 0 else 0.0
        self._status.update(
            f"lower {r.lower:.4f}  upper {r.upper:.4f}  gap {r.gap:.2e}  "
            f"{r.backups:,} backups ({rate:,.0f}/s)  {r.vectors:,} vectors  "
            f"{r.memory / 2**20:,.0f} MB  {r.seconds:.0f} s"
        )
