"""A lock that can be taken without waiting."""

from __future__ import annotations

import asyncio
from collections import deque


class Turnstile:
    """Lets one through at a time, in the order in which they come.

    It is used as `asyncio.Lock` is, ``async with turnstile``. Besides, who finds it open can
    `enter` at once, outside of any task, and has to `leave`.
    """

    def __init__(self) -> None:
        self._taken = False
        self._waiting: deque[asyncio.Future[None]] = deque()

    @property
    def is_taken(self) -> bool:
        """Whether somebody is in it."""
        return self._taken

    def enter(self) -> bool:
        """Go in if nobody is in it; False if somebody is."""
        if self._taken:
            return False
        self._taken = True
        return True

    def leave(self) -> None:
        """Go out, and let the next one in."""
        while self._waiting:
            following = self._waiting.popleft()
            if not following.done():  # else it was cancelled
                following.set_result(None)
                return
        self._taken = False

    async def __aenter__(self) -> None:
        if self.enter():
            return
        own: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.append(own)
        try:
            await own
        except asyncio.CancelledError:
            if own.done() and not own.cancelled():  # let in and cancelled at the same moment
                self.leave()
            raise

    async def __aexit__(self, *_: object) -> None:
        self.leave()
