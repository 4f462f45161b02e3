"""Collaboration where actions give modes away: observed are the last pairs of modes.

The hidden state is adaptability alone, ``Y = A``. The human mode at step ``t`` follows from the
window of the last ``k`` pairs: a person switches to the robot mode that they saw most often with
probability alpha (Eq. 4) and otherwise acts in the mode that they themselves took most often.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.human import filter as human_filter
from coadapt.human.adaptation import Adaptability
from coadapt.human.mode_pairs import PairWindows, Ties, most_frequent
from coadapt.worlds.joint import JointWorld


@dataclass(frozen=True, eq=False)
class SeenModes:
    """How modes follow each other when everybody sees them.

    Attributes:
        windows: what the person remembers.
        alpha: adaptability.
        mode_prior: ``[M]`` the person's first mode.
        likelihood: ``[X, A_h, M]`` probability of each human action in each mode.
        ties: see `most_frequent`.
    """

    windows: PairWindows
    alpha: Adaptability
    mode_prior: FloatArray
    likelihood: FloatArray
    ties: Ties

    @property
    def branching(self) -> int:
        """``N``, the number of outcomes that a pair of actions may have."""
        return self.windows.next.shape[2] // self.likelihood.shape[1]

    @cached_property
    def stays(self) -> FloatArray:
        """``[W, M]`` the mode of somebody who does not adapt: their own most frequent one."""
        return most_frequent(self.windows.human_modes, len(self.mode_prior), self.ties)

    @cached_property
    def sees(self) -> FloatArray:
        """``[W, M]`` the robot's most frequent mode; uniform where none of its actions showed one.

        The same is said of a window that says nothing in Eq. 2.
        """
        modes = len(self.mode_prior)
        seen = most_frequent(self.windows.robot_modes, modes, self.ties)
        seen[~seen.any(axis=1)] = 1 / modes
        return seen

    @cached_property
    def perceived(self) -> FloatArray:
        """``[W, A_r, M]``: `sees` once the robot has taken an action."""
        # It is the same after each human action and outcome.
        return self.sees[self.windows.next.max(axis=2)]

    @cached_property
    def mode_chance(self) -> FloatArray:
        """``[W, A, M]``: ``P(m_h | alpha, w)``, Eq. 3-4 with what the window tells."""
        rates = self.alpha.rates(len(self.mode_prior))
        own = np.repeat(self.stays[:, None], len(rates), axis=1)
        chance = human_filter.predict(own, rates, self.sees, None)
        chance[self.windows.length == 0] = self.mode_prior
        return chance

    def kept_modes(self, window: int | IntArray, action: int | IntArray) -> FloatArray:
        """``[..., M, M]``: what `stays` becomes by one more action in each mode."""
        acts = self.likelihood[self.windows.state[window]].argmax(axis=-2)  # [..., M]
        first = self.windows.next[window, action][..., :: self.branching]  # [..., A_h]
        return self.stays[np.take_along_axis(first, acts, axis=-1)]

    @property
    def hidden_names(self) -> tuple[str, ...]:
        """``Y`` labels."""
        return self.alpha.names

    @cached_property
    def human_chance(self) -> FloatArray:
        """``[W, A_h, Y]`` probability of each human action."""
        return np.einsum("whm,wam->wha", self.likelihood[self.windows.state], self.mode_chance)

    @cached_property
    def change(self) -> tuple[FloatArray, IntArray]:
        """``[D, Y, Y']`` how the hidden state moves, and ``[W, A_r]`` which of them holds where."""
        return self.alpha.transition[None], np.zeros(self.windows.next.shape[:2], dtype=np.int64)

    def observed_names(self, world: JointWorld) -> tuple[str, ...]:
        """``W`` labels: the state and the pairs of modes before it, the human's first."""
        windows = self.windows
        modes = [*(goal.name for goal in world.goals), "none"]  # the last one for `NO_MODE`
        names: list[str] = [world.state_names[x] for x in windows.state]
        for i in range(windows.memory):
            human, robot = windows.human_modes[:, i], windows.robot_modes[:, i]
            for w in np.flatnonzero(windows.length > i):
                names[w] += f", {modes[human[w]]}/{modes[robot[w]]}"
        return tuple(names)

    def hidden(self, belief: FloatArray) -> FloatArray:
        """The belief ``[..., Y]`` of the planning problem for ``[..., A, M]``."""
        return belief.sum(axis=-1)

    def predict(
        self, belief: FloatArray, window: IntArray, action: IntArray, human_action: IntArray
    ) -> FloatArray:
        """``[..., A, M]`` before the next human action. Alpha changes first, then the mode."""
        alpha = np.einsum("...i,ij->...j", belief.sum(axis=-1), self.alpha.transition)
        # Which outcome their actions had says nothing about the mode.
        reached = self.windows.next[window, action, human_action * self.branching]
        return alpha[..., None] * self.mode_chance[reached]
