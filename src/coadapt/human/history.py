"""What a person remembers of the robot: the window of the last ``k`` steps (Eq. 1).

This file fixes the time index. Before the robot acts at step ``t`` the *window* is

    x^{t-k+1}, a^{t-k+1}, ..., x^{t-1}, a^{t-1}, x^t,

of which the first state, the ``k - 1`` actions and, where moves are uncertain, which of its
outcomes each had are kept: the other states follow by replay. (Not so backwards: a blocked move
leads where another one would.) The action ``a^t`` completes the ``k`` steps of Eq. 1. At the start
of the task windows are shorter. For ``k = 1`` no past action is kept and a window is a robot state.

Moves are ``[X, A]`` states, or ``[X, A, N]`` with the different states each action may lead to,
filled up with `NO_STATE`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from coadapt.arrays import BoolArray, IntArray

NO_ACTION = -1
"""Fills up the actions of a window that is shorter than the memory."""

NO_WINDOW = -1
"""Stands where no window is."""

NO_STATE = -1
"""Fills up the outcomes of a move that has fewer than others."""

LONGEST_MEMORY = 100
"""Steps."""

MOST_WINDOWS = 2_000_000
"""Windows that are enumerated; more would not leave room for a planning problem."""


@dataclass(frozen=True, eq=False)
class Windows:
    """The windows of a task, each known by its index.

    For ``k = 1`` they are the robot states, in their order. For ``k > 1`` they are those that can
    be reached from the start: the shorter ones by length, then those of ``k - 1`` actions.

    Attributes:
        memory: ``k``, from 1 to `LONGEST_MEMORY`.
        first: ``[W]`` the state in which each window begins.
        actions: ``[W, k - 1]`` the actions taken since, oldest first, `NO_ACTION` after the last
            one where there were fewer.
        outcomes: ``[W, k - 1]`` which outcome each of them had, 0 where there is but one.
        state: ``[W]`` the robot state now.
        next: ``[W, A, N]`` the window after each action and outcome, `NO_WINDOW` where there is no
            such outcome. A window whose state ends the task stays.
        beginning: ``[X]`` the window without actions in each state, or `NO_WINDOW`.
    """

    memory: int
    first: IntArray
    actions: IntArray
    outcomes: IntArray
    state: IntArray
    next: IntArray
    beginning: IntArray

    @classmethod
    def of(cls, moves: IntArray, starts: int | Sequence[int], ends: BoolArray, memory: int) -> Self:
        """The windows of a task.

        Args:
            moves: ``[X, A]`` or ``[X, A, N]`` the states each action leads to.
            starts: the first state, or those in which the task may begin.
            ends: ``[X]`` where the task ends.
            memory: ``k``.

        Raises:
            ValueError: if ``k`` is out of its range or there are more than `MOST_WINDOWS` windows.
        """
        if count_windows(moves, starts, ends, memory) > MOST_WINDOWS:
            raise ValueError(
                f"a memory of {memory} steps makes more than {MOST_WINDOWS:,} windows here"
            )
        # An action and its outcome are followed as one.
        flat = moves.reshape(len(moves), -1)
        branching = moves.shape[2] if moves.ndim == 3 else 1
        first, taken, state, following = _enumerate(flat, _as_array(starts), ends, memory)
        over = np.flatnonzero(ends[state])
        following[over] = over[:, None]
        beginning = np.full(len(moves), NO_WINDOW)
        without_actions = np.flatnonzero((taken == NO_ACTION).all(axis=1))
        beginning[first[without_actions]] = without_actions
        return cls(
            memory=memory,
            first=first,
            actions=np.where(taken == NO_ACTION, NO_ACTION, taken // branching),
            outcomes=np.where(taken == NO_ACTION, 0, taken % branching),
            state=state,
            next=following.reshape(len(first), -1, branching),
            beginning=beginning,
        )

    def __len__(self) -> int:
        return len(self.state)

    def steps(self, moves: IntArray) -> Iterator[tuple[IntArray, IntArray]]:
        """The ``k`` steps of Eq. 1, oldest first, of every window with every action to follow.

        Args:
            moves: ``[X, A]`` as the windows were made from.

        Yields:
            States and actions of a step: arrays that broadcast to ``[W, A]``, with `NO_ACTION`
            where a window has no such step.
        """
        state = self.first
        outcomes = moves[:, :, None] if moves.ndim == 2 else moves
        for taken, outcome in zip(self.actions.T, self.outcomes.T, strict=True):
            yield state[:, None], taken[:, None]
            state = np.where(taken == NO_ACTION, state, outcomes[state, taken, outcome])
        yield state[:, None], np.arange(moves.shape[1])[None, :]


def count_windows(
    moves: IntArray, starts: int | Sequence[int], ends: BoolArray, memory: int
) -> int:
    """How many windows a task has, without enumerating them; exact up to `MOST_WINDOWS`.

    Let ``L_l(x)`` be the number of sequences of ``l`` actions from ``x`` that do not go on after
    an end: ``L_0(x) = 1`` and ``L_{l+1}(x) = sum_a L_l(T(x, a))``, or 0 where ``x`` is an end. An
    action with several outcomes counts once for each. The number of windows is

        sum_{l < k-1} sum_start L_l(start) + sum_x L_{k-1}(x),

    the last sum over the states that can be reached, or over all where ``k = 1``.

    Args:
        moves, starts, ends, memory: as for `Windows.of`.

    Raises:
        ValueError: if ``k`` is out of its range.
    """
    if not 1 <= memory <= LONGEST_MEMORY:
        raise ValueError(f"memory must be 1 to {LONGEST_MEMORY} steps, not {memory}")
    flat, begin = moves.reshape(len(moves), -1), _as_array(starts)
    sequences, shorter = np.ones(len(moves)), 0.0
    for _ in range(memory - 1):
        shorter += sequences[begin].sum()
        onwards = np.where(flat == NO_STATE, 0.0, sequences[flat])
        sequences = np.where(ends, 0.0, onwards.sum(axis=1))
    first = _first_states(flat, begin, ends, memory)
    return int(shorter + sequences[first].sum())


def _as_array(starts: int | Sequence[int]) -> IntArray:
    return np.unique(np.array(starts, dtype=np.int64))


def _first_states(moves: IntArray, starts: IntArray, ends: BoolArray, memory: int) -> IntArray:
    """Where a window may begin: in what can be reached, or anywhere for ``k = 1``."""
    if memory == 1:
        return np.arange(len(moves))
    reached = np.zeros(len(moves), dtype=np.bool_)
    front = starts
    while len(front):
        reached[front] = True
        following = moves[front[~ends[front]]]
        front = np.unique(following[following != NO_STATE])
        front = front[~reached[front]]
    return np.flatnonzero(reached)


def _enumerate(
    moves: IntArray, starts: IntArray, ends: BoolArray, memory: int
) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """First states, moves, states and successors of all windows, `NO_WINDOW` after an end.

    Sequences of moves are followed from all first states at once, one move further at a time.
    Of the sequence ``n = (x, a_1 ... a_l)``, ``child[n, a]`` is ``(x, a_1 ... a_l, a)`` among those
    one longer and ``rest[n]`` is ``(T(x, a_1), a_2 ... a_l)`` among those one shorter. A window of
    ``k - 1`` moves slides to ``rest[child[n, a]] = child[rest[n], a]``; shorter ones grow.
    """
    branching = moves.shape[1]
    first = state = _first_states(moves, starts, ends, memory)
    taken = np.empty((len(first), 0), dtype=np.int64)
    place = np.full(len(moves), NO_WINDOW)
    place[first] = np.arange(len(first))
    rest = shorter_child = grown = np.empty(0, dtype=np.int64)
    parts: list[tuple[IntArray, IntArray, IntArray]] = []
    following: list[IntArray] = []
    count = 0
    for length in range(memory):
        is_full = length == memory - 1
        # Only in the starts are there windows shorter than the memory.
        kept = np.arange(len(first)) if is_full else np.flatnonzero(np.isin(first, starts))
        padded = np.full((len(kept), memory - 1), NO_ACTION)
        padded[:, :length] = taken[kept]
        parts.append((first[kept], padded, state[kept]))
        number = np.full(len(first) + 1, NO_WINDOW)  # the last one for `NO_WINDOW` itself
        number[kept] = count + np.arange(len(kept))
        count += len(kept)
        if length > 0:
            following.append(number[grown])
        going = np.flatnonzero(~ends[state])
        reached = moves[state[going]]
        before, last = np.nonzero(reached != NO_STATE)
        reached = reached[before, last]
        before = going[before]
        without_first = place[reached] if length == 0 else shorter_child[rest[before], last]
        child = np.full((len(first), branching), NO_WINDOW)
        if is_full:
            child[before, last] = without_first
            following.append(number[child])
            break
        child[before, last] = np.arange(len(reached))
        rest, shorter_child, grown = without_first, child, child[kept]
        taken = np.column_stack((taken[before], last))
        first, state = first[before], reached
    firsts, actions, states = (np.concatenate(part) for part in zip(*parts, strict=True))
    return firsts, actions, states, np.concatenate(following)
