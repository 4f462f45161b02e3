"""Collaboration where actions only hint at modes, as in shared autonomy.

Hidden are adaptability and the human mode, ``Y = A x M`` with index ``y = alpha * |M| + m``. The
person infers the robot mode from its last ``k`` steps, the present one among them (Eq. 2), and
switches to it from their own with probability alpha (Eq. 3-4).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.human import filter as human_filter
from coadapt.human.adaptation import Adaptability
from coadapt.human.history import NO_ACTION
from coadapt.human.perceived import perceived_robot_mode
from coadapt.human.robot_steps import StepWindows
from coadapt.worlds.joint import JointWorld


@dataclass(frozen=True, eq=False)
class HiddenModes:
    """How modes follow each other when nobody sees them.

    Attributes:
        windows: what the person remembers.
        alpha: adaptability.
        mode_names: ``M`` labels.
        robot_policies: ``[M, X, A_r]`` the robot half of every modal policy.
        likelihood: ``[X, A_h, M]`` probability of each human action in each mode.
    """

    windows: StepWindows
    alpha: Adaptability
    mode_names: tuple[str, ...]
    robot_policies: FloatArray
    likelihood: FloatArray

    @cached_property
    def perceived(self) -> FloatArray:
        """``[W, A_r, M]``: ``P(m_r | w, a_r)``, Eq. 2."""
        windows = self.windows
        steps: list[tuple[IntArray, IntArray]] = [
            (windows.past_states[:, i, None], windows.past_actions[:, i, None])
            for i in range(windows.memory - 1)
        ]
        actions: int = windows.next.shape[1]
        steps.append((windows.state[:, None], np.arange(actions)))
        return perceived_robot_mode(self.robot_policies, steps)

    def kept_modes(self, window: int | IntArray, action: int | IntArray) -> FloatArray:
        """``[..., M, M]``: somebody who does not adapt keeps the mode in which they are."""
        modes = len(self.mode_names)
        return np.broadcast_to(np.eye(modes), (*np.shape(window), modes, modes))

    @property
    def hidden_names(self) -> tuple[str, ...]:
        """``Y`` labels."""
        return tuple(f"{alpha} {mode}" for alpha in self.alpha.names for mode in self.mode_names)

    @cached_property
    def human_chance(self) -> FloatArray:
        """``[W, A_h, Y]`` probability of each human action."""
        return np.tile(self.likelihood[self.windows.state], len(self.alpha.values))

    @cached_property
    def change(self) -> tuple[FloatArray, IntArray]:
        """``[D, Y, Y']`` how the hidden state moves, and ``[W, A_r]`` which of them holds where."""
        modes = len(self.mode_names)
        rates = self.alpha.rates(modes)
        seen, which = np.unique(self.perceived.reshape(-1, modes), axis=0, return_inverse=True)
        # A person in mode m is carried from the belief that is certain of m, for every alpha.
        certain = np.broadcast_to(np.eye(modes)[:, None], (modes, len(rates), modes))
        switch = human_filter.predict(certain, rates, seen[:, None], None)  # [D, M, A, M']
        moved = np.einsum("dman,ab->dambn", switch, self.alpha.transition)
        hidden = rates.size
        return moved.reshape(-1, hidden, hidden), which.reshape(self.perceived.shape[:2])

    def observed_names(self, world: JointWorld) -> tuple[str, ...]:
        """``W`` labels: the state, the robot's steps before it and the last human action."""
        windows = self.windows
        names: list[str] = [world.state_names[x] for x in windows.state]
        for i in range(windows.memory - 1):
            states, actions = windows.past_states[:, i], windows.past_actions[:, i]
            for w in np.flatnonzero(actions != NO_ACTION):
                names[w] += f", {world.state_names[states[w]]} {world.action_names[actions[w]]}"
        for w in np.flatnonzero(windows.human_action != NO_ACTION):
            names[w] += f", human {world.human_action_names[windows.human_action[w]]}"
        return tuple(names)

    def hidden(self, belief: FloatArray) -> FloatArray:
        """The belief ``[..., Y]`` of the planning problem for ``[..., A, M]``."""
        return belief.reshape(*belief.shape[:-2], -1)

    def predict(
        self, belief: FloatArray, window: IntArray, action: IntArray, human_action: IntArray
    ) -> FloatArray:
        """``[..., A, M]`` before the next human action (Eq. 9)."""
        transition = None if self.alpha.is_fixed else self.alpha.transition
        rates = self.alpha.rates(len(self.mode_names))
        return human_filter.predict(belief, rates, self.perceived[window, action], transition)
