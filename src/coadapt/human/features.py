"""Histories by their features, for memories too long to keep whole (Sec. 7).

There are about ``|X| |A|^(k-1)`` windows of ``k`` steps. A *feature map* says what of a window
counts; windows that end in the same state and have the same features are taken for one. The first
one found, in order of length, stands for the others: what the person perceives and what may follow
is looked up for that one. So nothing is lost where windows with equal features are
perceived alike and go on alike, and otherwise it is an approximation. Only as many windows are
visited as remain.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.human.enumeration import enumerate_windows
from coadapt.human.history import NO_ACTION, NO_STATE, NO_WINDOW, Windows

Features = Callable[[Sequence[int], Sequence[int]], Hashable]
"""From the states of a window, oldest first, and the actions between them, one fewer."""


def action_counts(states: Sequence[int], actions: Sequence[int]) -> Hashable:
    """How often each action was taken; in which order is forgotten.

    There are ``C(k - 1 + |A|, |A|)`` of them, a polynomial in ``k``.
    """
    return tuple(sorted(actions))


@dataclass(frozen=True, eq=False)
class PerceivedMode:
    """What the person makes of the window's past steps, rounded: Eq. 2 without the present one.

    Attributes:
        robot_policies: ``[M, X, A]`` the robot half of every modal policy.
        levels: into how many steps probabilities from 0 to 1 are rounded.
    """

    robot_policies: FloatArray
    levels: int = 10

    def __call__(self, states: Sequence[int], actions: Sequence[int]) -> Hashable:
        """The rounded probabilities, times `levels`."""
        past = self.robot_policies[
            :, np.array(states[:-1], dtype=np.int64), np.array(actions, dtype=np.int64)
        ]
        likelihood = past.prod(axis=1)
        total = likelihood.sum()
        share = likelihood / total if total > 0 else np.full(len(past), 1.0 / len(past))
        return tuple(np.rint(self.levels * share).astype(np.int64).tolist())


def feature_windows(
    moves: IntArray,
    starts: Sequence[int],
    ends: BoolArray,
    memory: int,
    features: Features,
) -> Windows:
    """The windows of a task, one for all that end in the same state with the same features.

    Args:
        moves: ``[X, A]`` or ``[X, A, N]`` the states each action leads to.
        starts: the states in which the task may begin.
        ends: ``[X]`` where the task ends.
        memory: ``k``.
        features: the feature map.

    Returns:
        Those that can be reached from the starts, also for ``k = 1``.

    Raises:
        ValueError: if ``k`` is out of its range or there are more than
            `coadapt.human.enumeration.MOST_WINDOWS` windows.
    """
    outcomes = moves[:, :, None] if moves.ndim == 2 else moves

    def key(window: _Window) -> Hashable:
        return window.states[-1], features(window.states, window.actions)

    def following(window: _Window) -> list[_Window | None]:
        state = window.states[-1]
        after: list[_Window | None] = []
        for (a, n), reached in np.ndenumerate(outcomes[state]):
            if ends[state]:
                after.append(window)
            else:
                is_one = reached != NO_STATE
                after.append(window.then(a, n, int(reached), memory) if is_one else None)
        return after

    begin = [_Window((start,), (), ()) for start in sorted(set(starts))]
    kept, follows = enumerate_windows(begin, following, memory, key)
    number = {key(window): w for w, window in enumerate(kept)}
    beginning = np.full(len(moves), NO_WINDOW)
    for window in begin:
        beginning[window.states[0]] = number[key(window)]
    taken = np.full((len(kept), memory - 1), NO_ACTION)
    chance = np.zeros((len(kept), memory - 1), dtype=np.int64)
    for w, window in enumerate(kept):
        taken[w, : len(window.actions)] = window.actions
        chance[w, : len(window.actions)] = window.outcomes
    return Windows(
        memory=memory,
        first=np.array([window.states[0] for window in kept]),
        actions=taken,
        outcomes=chance,
        state=np.array([window.states[-1] for window in kept]),
        next=follows.reshape(-1, *outcomes.shape[1:]),
        beginning=beginning,
    )


@dataclass(frozen=True)
class _Window:
    """States, oldest first, the actions between them and which outcome each had."""

    states: tuple[int, ...]
    actions: tuple[int, ...]
    outcomes: tuple[int, ...]

    def then(self, action: int, outcome: int, state: int, memory: int) -> _Window:
        """One step more, of which the last ``memory - 1`` remain."""
        keep = slice(max(0, len(self.actions) + 2 - memory), None)
        return _Window(
            (*self.states, state)[keep],
            (*self.actions, action)[keep],
            (*self.outcomes, outcome)[keep],
        )
