"""What a person remembers where modes are hidden and both act: the robot's last ``k`` steps.

As in `coadapt.human.history` the robot's action of the present step completes the ``k`` steps of
Eq. 1. Both actions move the world, so the states are kept and not only the first of them. The last
human action is kept too: not for the person, but because the robot has seen it, and it tells of
their mode.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from coadapt.arrays import BoolArray, IntArray
from coadapt.human.enumeration import enumerate_windows
from coadapt.human.history import NO_ACTION, NO_STATE, NO_WINDOW

_Steps = tuple[tuple[int, int], ...]
"""States and the robot's actions there, oldest first."""

_Window = tuple[int, _Steps, int]
"""The state now, the steps before it and the last human action."""


@dataclass(frozen=True, eq=False)
class StepWindows:
    """The windows of a task, each known by its index.

    Attributes:
        memory: ``k``, from 1 to `coadapt.human.history.LONGEST_MEMORY`.
        state: ``[W]`` the state now.
        past_states, past_actions: ``[W, k - 1]`` the states before and the robot's actions there,
            oldest first; state 0 and `NO_ACTION` after the last one where there were fewer.
        human_action: ``[W]`` the human action that led here, `NO_ACTION` at the start.
        next: ``[W, A_r, A_h * N]`` the window after each outcome of a pair of actions, `NO_WINDOW`
            where there is none. A window whose state ends the task stays.
        beginning: ``[X]`` the window without a past in each state, or `NO_WINDOW`.
    """

    memory: int
    state: IntArray
    past_states: IntArray
    past_actions: IntArray
    human_action: IntArray
    next: IntArray
    beginning: IntArray

    @classmethod
    def of(
        cls,
        moves: IntArray,
        starts: Sequence[int],
        ends: BoolArray,
        memory: int,
        human_actions: int,
    ) -> Self:
        """The windows of a task.

        Args:
            moves: ``[X, A_r, A_h * N]`` the states that each pair of actions may lead to, those of
                one human action side by side and filled up with `NO_STATE`.
            starts: the first states.
            ends: ``[X]`` where the task ends.
            memory: ``k``.
            human_actions: ``|A_h|``.

        Raises:
            ValueError: if ``k`` is out of its range, or there are more than
                `coadapt.human.enumeration.MOST_WINDOWS` windows.
        """
        outcomes: int = moves.shape[2]
        branching = outcomes // human_actions

        def following(window: _Window) -> list[_Window | None]:
            state, steps, _ = window
            after: list[_Window | None] = []
            for where, to in enumerate(moves[state].ravel().tolist()):
                a, outcome = divmod(where, outcomes)
                # Not [-(memory - 1):], which is everything for a memory of one step.
                kept = (*steps, (state, a))[max(0, len(steps) + 2 - memory) :]
                if ends[state]:
                    after.append(window)
                else:
                    after.append(None if to == NO_STATE else (to, kept, outcome // branching))
            return after

        begin: list[_Window] = [(start, (), NO_ACTION) for start in starts]
        windows, follows = enumerate_windows(begin, following, memory)
        state = np.array([x for x, _, _ in windows])
        human_action = np.array([h for _, _, h in windows])
        past = np.zeros((len(windows), memory - 1, 2), dtype=np.int64)
        past[:, :, 1] = NO_ACTION
        for w, (_, steps, _) in enumerate(windows):
            past[w, : len(steps)] = np.reshape(steps, (-1, 2))
        beginning = np.full(len(moves), NO_WINDOW)
        fresh = np.flatnonzero(human_action == NO_ACTION)
        beginning[state[fresh]] = fresh
        return cls(
            memory=memory,
            state=state,
            past_states=past[:, :, 0],
            past_actions=past[:, :, 1],
            human_action=human_action,
            next=follows.reshape(-1, *moves.shape[1:]),
            beginning=beginning,
        )

    def __len__(self) -> int:
        return len(self.state)
