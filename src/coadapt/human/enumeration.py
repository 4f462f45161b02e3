"""Windows numbered in the order in which they are found."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence
from typing import TypeVar

import numpy as np

from coadapt.arrays import IntArray
from coadapt.human.history import LONGEST_MEMORY, NO_WINDOW

MOST_WINDOWS = 200_000
"""Windows that are enumerated one by one."""

Window = TypeVar("Window", bound=Hashable)


def itself(window: Hashable) -> Hashable:
    """Tells every window from every other."""
    return window


def enumerate_windows(
    begin: Iterable[Window],
    following: Callable[[Window], Sequence[Window | None]],
    memory: int,
    key: Callable[[Window], Hashable] = itself,
) -> tuple[list[Window], IntArray]:
    """Everything that can follow.

    Args:
        begin: windows to begin with. All that follows one of them gets its number before the next.
        following: the windows that may follow one, always as many; None where nothing does.
        memory: ``k``, for the message.
        key: windows with the same key are taken for one, the first of them.

    Returns:
        The windows, and ``[W, F]`` the numbers of those that follow each, `NO_WINDOW` for None.

    Raises:
        ValueError: if ``k`` is out of its range or there are more than `MOST_WINDOWS` windows.
    """
    if not 1 <= memory <= LONGEST_MEMORY:
        raise ValueError(f"memory must be 1 to {LONGEST_MEMORY} steps, not {memory}")
    number: dict[Hashable, int] = {}
    found: list[Window] = []
    follows: list[list[int]] = []

    def place(window: Window | None) -> int:
        if window is None:
            return NO_WINDOW
        name = key(window)
        if name not in number:
            if len(found) == MOST_WINDOWS:
                raise ValueError(
                    f"a memory of {memory} steps makes more than {MOST_WINDOWS:,} windows here"
                )
            number[name] = len(found)
            found.append(window)
        return number[name]

    for window in begin:
        place(window)
        while len(follows) < len(found):
            follows.append([place(after) for after in following(found[len(follows)])])
    return found, np.array(follows, dtype=np.int64)
