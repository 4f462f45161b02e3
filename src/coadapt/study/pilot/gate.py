"""Who takes part at the same time, and in which order they are allocated.

Which condition somebody gets depends on who has come before. Where simulated participants run side
by side, those of a wave go through their allocation one after the other, and no wave begins before
the last has ended. So the same seed gives the same study.
"""

from __future__ import annotations

import asyncio


class Gate:
    """The order of allocation within a wave of participants.

    Args:
        n: number of participants.
    """

    def __init__(self, n: int) -> None:
        self._passed = [asyncio.Event() for _ in range(n)]

    async def turn(self, i: int) -> None:
        """Wait until everybody before participant ``i`` has passed."""
        for passed in self._passed[:i]:
            await passed.wait()

    def passed(self, i: int) -> None:
        """Participant ``i`` has been allocated, or never will be."""
        self._passed[i].set()

    async def all_passed(self) -> None:
        """Wait until everybody has passed."""
        for passed in self._passed:
            await passed.wait()
