"""SARSOP: point-based planning near the beliefs an optimal policy reaches.

Kurniawati, Hsu, Lee, "SARSOP: Efficient point-based POMDP planning by approximating optimally
reachable belief spaces", RSS 2008; for mixed observability Ong, Png, Hsu, Lee, IJRR 2010.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

from coadapt.momdp.model import MOMDP
from coadapt.momdp.policy import AlphaVectorPolicy
from coadapt.momdp.sarsop.controller import require_start
from coadapt.momdp.sarsop.progress import ProgressLine
from coadapt.momdp.sarsop.search import COMPILING, Search, compile_kernels, kernels_are_compiled
from coadapt.momdp.sarsop.solution import Record, Solution, Status

CALL_SECONDS = 0.1
"""About how long a kernel runs before Python looks up."""


@dataclass(frozen=True)
class SARSOP:
    """The solver's settings. For given settings without a time limit its result is fixed.

    Attributes:
        gap: stop once the bounds at every root are at most this far apart, in reward units.
        relative_gap: or at most this part of the smaller of them, in absolute value.
        max_backups: stop after about this many backups (the trial under way is finished).
        memory_limit: stop before the arrays of the search take more than this many bytes. If the
            first bounds alone take more, `solve` refuses.
        time_limit: stop after about this many seconds. The result then depends on the machine.
        progress: show a line with the bounds on standard error.
        callback: called with every `Record` of the trace.

    Raises:
        ValueError: if a setting is out of its range.
    """

    gap: float = 1e-3
    relative_gap: float = 0.0
    max_backups: int | None = None
    memory_limit: int | None = None
    time_limit: float | None = None
    progress: bool = False
    callback: Callable[[Record], None] | None = None

    def __post_init__(self) -> None:
        if not self.gap > 0:
            raise ValueError(f"gap must be positive, not {self.gap}")
        if not 0 <= self.relative_gap < 1:
            raise ValueError(f"relative_gap must lie in [0, 1), not {self.relative_gap}")
        if self.memory_limit is not None and not self.memory_limit > 0:
            raise ValueError(f"memory_limit must be positive, not {self.memory_limit}")
        if self.max_backups is not None and self.max_backups < 0:
            raise ValueError(f"max_backups must be at least 0, not {self.max_backups}")
        if self.time_limit is not None and not self.time_limit >= 0:
            raise ValueError(f"time_limit must be at least 0 seconds, not {self.time_limit}")

    def solve(self, problem: MOMDP, start: AlphaVectorPolicy | None = None) -> Solution:
        """Plan for ``problem``, from what ``start`` achieves in it if that is given.

        The values in ``start`` are not trusted: it may be a policy for a problem with other
        probabilities, rewards or discount, of the same sizes.

        Ctrl-C ends the search and returns the best policy so far, with status ``INTERRUPTED``.

        Raises:
            ValueError: if ``start`` does not fit the problem's states and actions.
            MemoryError: if the first bounds take more than ``memory_limit``.
        """
        if start is not None:
            require_start(problem, start)
        with ProgressLine(self.progress) as line:
            if not kernels_are_compiled():
                line.say(COMPILING)
            compile_kernels(start is not None)
            line.say("initial bounds")
            begun = perf_counter()
            search = Search(problem, start, self.memory_limit)
            trace: list[Record] = []

            def record() -> None:
                trace.append(search.record(perf_counter() - begun))
                if self.callback is not None:
                    self.callback(trace[-1])

            record()
            try:
                status = self._search(search, begun, record, line)
            except KeyboardInterrupt:
                status = Status.INTERRUPTED
            record()
            return search.solution(status, tuple(trace), perf_counter() - begun)

    def _search(
        self, search: Search, begun: float, record: Callable[[], None], line: ProgressLine
    ) -> Status:
        last = self.max_backups
        call = 50  # backups asked of the next kernel call
        next_record = 100
        while True:
            done = search.backups
            seconds = perf_counter() - begun
            line.show(search.record, seconds)
            if last is not None and done >= last:
                return Status.BACKUPS
            if self.time_limit is not None and seconds >= self.time_limit:
                return Status.TIME
            if done >= next_record:
                record()
                # Records lie a tenth of the work apart: at the same work on every machine.
                next_record = done + max(100, done // 10)
            ahead = min(call, next_record - done)
            if last is not None:
                ahead = min(ahead, last - done)
            before = perf_counter()
            ended = search.run(self.gap, self.relative_gap, ahead)
            if ended is not None:
                return ended
            now = perf_counter()
            target = CALL_SECONDS
            if self.time_limit is not None:
                target = min(target, max(0.0, self.time_limit - (now - begun)))
            spent = max(now - before, 1e-6)
            call = int(min(call * 2, (search.backups - done) * target / spent)) + 1
