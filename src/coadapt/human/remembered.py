"""What all kinds of windows have in common."""

from __future__ import annotations

from typing import Protocol

from coadapt.arrays import IntArray
from coadapt.human.history import NO_WINDOW


class Remembered(Protocol):
    """Windows of any kind."""

    @property
    def memory(self) -> int:
        """``k``."""
        ...

    @property
    def state(self) -> IntArray:
        """``[W]`` the state in which each window ends."""
        ...

    @property
    def next(self) -> IntArray:
        """``[W, A, N]`` the window after each action and outcome."""
        ...

    @property
    def beginning(self) -> IntArray:
        """``[X]`` the window without a past in each state, or `NO_WINDOW`."""
        ...

    def __len__(self) -> int:
        """Number of windows ``W``."""
        ...


def locate(windows: Remembered, expected: IntArray | None, state: int) -> int:
    """The window with which a step in ``state`` begins.

    It is the one of ``expected`` that ends in ``state``. If none does, the robot came there in
    a way that nobody saw, and it is the window without actions.

    Args:
        windows: all windows.
        expected: those that the last action may have led to, or None where there was no action.
        state: the robot state.

    Raises:
        ValueError: if there is no such window. With ``k > 1`` only the starts have one.
    """
    for window in () if expected is None else map(int, expected):
        if window != NO_WINDOW and windows.state[window] == state:
            return window
    window = int(windows.beginning[state])
    if window == NO_WINDOW:
        raise ValueError(
            f"state {state} does not follow from the last action, and with a memory of "
            f"{windows.memory} steps only the start state needs no past"
        )
    return window
