"""Planning as the report does it: an interrupt ends the report, not just the search."""

from __future__ import annotations

from coadapt.momdp import MOMDP
from coadapt.momdp.sarsop import SARSOP, Solution, Status


def solve(problem: MOMDP, gap: float, max_backups: int | None = None) -> Solution:
    """Plan for ``problem`` until the bounds are ``gap`` apart, or for ``max_backups``.

    Raises:
        KeyboardInterrupt: where the search was interrupted; alone it would return what it has.
    """
    solution = SARSOP(gap=gap, max_backups=max_backups).solve(problem)
    if solution.status is Status.INTERRUPTED:
        raise KeyboardInterrupt
    return solution
