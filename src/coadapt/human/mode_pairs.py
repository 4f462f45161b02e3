"""What a person remembers where modes show: the last ``k`` pairs of their mode and the robot's.

Where the modal policies are deterministic and lead to different actions, an action tells its mode,
and robot and human see each other's (Sec. 2.3). Before step ``t`` the *window* is

    (m_h^{t-k}, m_r^{t-k}), ..., (m_h^{t-1}, m_r^{t-1}), x^t,

shorter at the start of the task. In contrast to `coadapt.human.history` the present step is not in
it, because both act at the same time.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, product
from typing import Literal, Self, get_args

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.human.enumeration import enumerate_windows
from coadapt.human.history import NO_STATE, NO_WINDOW

NO_MODE = -1
"""The mode of an action that none or several of the modes would take."""

Ties = Literal["latest", "earliest", "even"]
"""Which mode a person goes by of those they saw equally often: the one seen last, the one seen
first, or each of them with the same probability."""

TIES: tuple[Ties, ...] = get_args(Ties)

_Pairs = tuple[tuple[int, int], ...]
"""The human mode and the robot mode of each step, oldest first."""

_Window = tuple[int, _Pairs]
"""The state now and the pairs that led to it."""


def most_frequent(seen: IntArray, modes: int, ties: Ties) -> FloatArray:
    """The mode seen most often, as a distribution.

    Args:
        seen: ``[..., k]`` modes in the order in which they were seen, `NO_MODE` where there was
            none.
        modes: number of modes ``M``.
        ties: what to make of modes that were seen equally often.

    Returns:
        ``[..., M]``, distributions over modes; all 0 where no mode was seen.
    """
    shows = seen[..., None, :] == np.arange(modes)[:, None]  # [..., M, k]
    count = shows.sum(axis=-1)
    leads = (count == count.max(axis=-1, keepdims=True)) & (count > 0)
    if ties != "even":
        memory: int = seen.shape[-1]
        place = np.arange(memory) if ties == "latest" else np.arange(memory)[::-1]
        rank = np.where(shows & leads[..., None], place, -1).max(axis=-1)
        leads &= rank == rank.max(axis=-1, keepdims=True)
    return leads / np.maximum(leads.sum(axis=-1, keepdims=True), 1)


@dataclass(frozen=True, eq=False)
class PairWindows:
    """The windows of a task, each known by its index.

    Attributes:
        memory: ``k``, from 1 to `coadapt.human.history.LONGEST_MEMORY`.
        state: ``[W]`` the state now.
        human_modes, robot_modes: ``[W, k]`` the modes seen, oldest first; `NO_MODE` after the last
            one where there were fewer than ``k`` steps, and where an action showed no mode.
        length: ``[W]`` number of steps in each window.
        next: ``[W, A_r, A_h * N]`` the window after each outcome of a pair of actions, `NO_WINDOW`
            where there is none or the human action shows no mode. A window whose state ends the
            task stays.
        beginning: ``[X]`` the window without pairs in each state, or `NO_WINDOW`.
    """

    memory: int
    state: IntArray
    human_modes: IntArray
    robot_modes: IntArray
    length: IntArray
    next: IntArray
    beginning: IntArray

    @classmethod
    def of(
        cls,
        moves: IntArray,
        starts: Sequence[int],
        ends: BoolArray,
        memory: int,
        robot_mode: IntArray,
        human_mode: IntArray,
        *,
        everything: bool = False,
    ) -> Self:
        """The windows of a task.

        Args:
            moves: ``[X, A_r, A_h * N]`` the states that each pair of actions may lead to, those of
                one human action side by side and filled up with `NO_STATE`.
            starts: the first states.
            ends: ``[X]`` where the task ends.
            memory: ``k``.
            robot_mode: ``[X, A_r]`` the mode that each robot action shows, or `NO_MODE`.
            human_mode: ``[X, A_h]`` the same of the human actions; those without are not taken.
            everything: whether to add, after the windows that actions lead to, those that none
                do: every state after every sequence of up to ``k`` pairs of modes.

        Raises:
            ValueError: if ``k`` is out of its range, or there are more than
                `coadapt.human.enumeration.MOST_WINDOWS` windows.
        """
        outcomes: int = moves.shape[2]
        branching = outcomes // human_mode.shape[1]

        def following(window: _Window) -> list[_Window | None]:
            state, pairs = window
            if ends[state]:
                return [window] * moves[state].size
            after: list[_Window | None] = []
            for where, to in enumerate(moves[state].ravel().tolist()):
                a, outcome = divmod(where, outcomes)
                pair = (int(human_mode[state, outcome // branching]), int(robot_mode[state, a]))
                impossible = to == NO_STATE or pair[0] == NO_MODE
                after.append(None if impossible else (to, (*pairs, pair)[-memory:]))
            return after

        begin: Iterator[_Window] = ((start, ()) for start in starts)
        if everything:
            going = np.flatnonzero(~ends)
            symbols = product(
                [m for m in np.unique(human_mode[going]).tolist() if m != NO_MODE],
                np.unique(robot_mode[going]).tolist(),
            )
            begin = chain(begin, _all_windows(len(moves), list(symbols), memory))
        windows, follows = enumerate_windows(begin, following, memory)
        state = np.array([x for x, _ in windows])
        length = np.array([len(pairs) for _, pairs in windows])
        seen = np.full((len(windows), memory, 2), NO_MODE)
        for w, (_, pairs) in enumerate(windows):
            seen[w, : len(pairs)] = np.reshape(pairs, (-1, 2))
        beginning = np.full(len(moves), NO_WINDOW)
        beginning[state[length == 0]] = np.flatnonzero(length == 0)
        return cls(
            memory=memory,
            state=state,
            human_modes=seen[:, :, 0],
            robot_modes=seen[:, :, 1],
            length=length,
            next=follows.reshape(-1, *moves.shape[1:]),
            beginning=beginning,
        )

    def __len__(self) -> int:
        return len(self.state)


def _all_windows(states: int, symbols: list[tuple[int, int]], memory: int) -> Iterator[_Window]:
    """Every state after every sequence of up to ``memory`` pairs, by length."""
    for length in range(memory + 1):
        for pairs in product(symbols, repeat=length):
            for state in range(states):
                yield state, pairs
