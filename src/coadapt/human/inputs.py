"""What a person steers with: the inputs they can give, and what each says about their wish.

In a mode the person wants one of the robot's actions, drawn from the human half of the modal
policy, and gives an input for it. So the observation of Sec. 5.1 is

    O(i | m, x) = (1 - silence) sum_a P(i | a) m_h(a | x),

and with probability ``silence`` there is no input, whatever the mode. In the paper the inputs are
the robot's actions: ``P(i | a) = 1`` for ``i = a``.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.human.adaptation import require_distribution
from coadapt.human.history import NO_ACTION

NO_INPUT_NAME = "none"
"""Name of the observation that there was no input."""

EIGHT_DIRECTIONS = {
    "right": 0.0,
    "forward right": 0.25 * np.pi,
    "forward": 0.5 * np.pi,
    "forward left": 0.75 * np.pi,
    "left": np.pi,
    "back left": 1.25 * np.pi,
    "back": 1.5 * np.pi,
    "back right": 1.75 * np.pi,
}
"""The directions of a two-axis joystick, radians from the right, counter-clockwise."""

ACROSS = 1e-9
"""A cosine up to this is no push in a direction: it lies across."""


@dataclass(frozen=True, eq=False)
class Inputs:
    """The inputs a person can give.

    Attributes:
        names: ``I`` labels.
        likelihood: ``[A, I]`` ``P(i | a)``: the input given for a wish for robot action ``a``.
        asks: ``[I]`` the robot action that each input asks for, which the match rule executes;
            `NO_ACTION` where it asks for none.
        directions: ``[I, 2]`` where each points on a drawing of the world; zeros for none.
        silence: probability that there is no input in a step, in [0, 1).

    Raises:
        ValueError: if the parts do not fit together or are out of range.
    """

    names: tuple[str, ...]
    likelihood: FloatArray
    asks: IntArray
    directions: FloatArray
    silence: float = 0.0

    def __post_init__(self) -> None:
        count = len(self.names)
        actions = len(self.likelihood)
        require_distribution("likelihood of inputs", self.likelihood, (actions, count))
        if self.asks.shape != (count,) or self.directions.shape != (count, 2):
            raise ValueError("there must be one action asked for and one direction for each input")
        if len(set(self.names)) < count or NO_INPUT_NAME in self.names:
            raise ValueError(f"names of inputs must differ, and none be {NO_INPUT_NAME!r}")
        if np.any((self.asks != NO_ACTION) & ((self.asks < 0) | (self.asks >= actions))):
            raise ValueError(f"inputs must ask for actions 0 to {actions - 1}")
        if not 0 <= self.silence < 1:
            raise ValueError(f"silence must lie in [0, 1), not {self.silence}")

    def __len__(self) -> int:
        return len(self.names)

    @property
    def observation_names(self) -> tuple[str, ...]:
        """The inputs, and `NO_INPUT_NAME` if there may be none."""
        return (*self.names, NO_INPUT_NAME) if self.silence > 0 else self.names

    def asked(self, human_inputs: IntArray) -> IntArray:
        """``[...]`` the action that each of ``human_inputs`` asks for, `NO_ACTION` for none.

        Args:
            human_inputs: ``[...]`` inputs, negative where there was none.
        """
        return np.where(human_inputs < 0, NO_ACTION, self.asks[human_inputs])

    def observed(self, policies: FloatArray) -> FloatArray:
        """``[M, X, O]``: ``O(i | m, x)``, the last one for no input if there may be none.

        Args:
            policies: ``[M, X, A]`` the human half of every modal policy.
        """
        given = (1.0 - self.silence) * (policies @ self.likelihood)
        if self.silence == 0:
            return given
        return np.concatenate([given, np.full((*given.shape[:2], 1), self.silence)], axis=2)

    @classmethod
    def actions(
        cls, names: Sequence[str], directions: FloatArray, slip: float = 0.0, silence: float = 0.0
    ) -> Self:
        """The robot's actions themselves, as in the paper.

        Args:
            names: of the robot's actions.
            directions: ``[A, 2]`` where they point.
            slip: probability of another input than the wanted one, all alike, in [0, 1].
            silence: as for `Inputs`.

        Raises:
            ValueError: if a probability is out of its range.
        """
        count = len(names)
        if not 0 <= slip <= 1:
            raise ValueError(f"slip must lie in [0, 1], not {slip}")
        likelihood = np.eye(count)
        if slip > 0 and count > 1:
            likelihood = (1 - slip) * likelihood + slip * (1 - likelihood) / (count - 1)
        return cls(tuple(names), likelihood, np.arange(count), directions, silence)

    @classmethod
    def joystick(
        cls, directions: FloatArray, concentration: float = 4.0, silence: float = 0.0
    ) -> Self:
        """A two-axis joystick with eight directions.

        A person who wants an action that points at angle ``u`` pushes at angle ``v`` with a
        probability proportional to ``exp(k cos(v - u))``, a von Mises density. A wish for an action
        without a direction leaves all of them alike. A push asks for the action nearest to it,
        and for none where all lie across or behind.

        Args:
            directions: ``[A, 2]`` where the robot's actions point.
            concentration: ``k`` of the density, at least 0: 4 puts 60 % on the right one of the
                eight directions, 0 is no aim at all; at most 500.
            silence: as for `Inputs`.

        Raises:
            ValueError: if a number is out of its range.
        """
        if not 0 <= concentration <= 500:
            raise ValueError(f"concentration must lie in [0, 500], not {concentration}")
        angles = np.array(list(EIGHT_DIRECTIONS.values()))
        pushes = np.column_stack([np.cos(angles), np.sin(angles)])
        length = np.linalg.norm(directions, axis=1, keepdims=True)
        unit = np.divide(directions, length, out=np.zeros_like(directions), where=length > 0)
        cosine = unit @ pushes.T  # [A, I]
        weight = np.exp(concentration * (cosine - 1.0))
        asks = np.where(cosine.max(axis=0) > ACROSS, cosine.round(9).argmax(axis=0), NO_ACTION)
        return cls(
            names=tuple(EIGHT_DIRECTIONS),
            likelihood=weight / weight.sum(axis=1, keepdims=True),
            asks=asks,
            directions=pushes.round(12),
            silence=silence,
        )

    @classmethod
    def switch(
        cls, actions: int, pressed_for: Collection[int], error: float = 0.05, silence: float = 0.0
    ) -> Self:
        """A button: pressed for some of the robot's actions, left alone for the others.

        Unlike having no input, leaving it alone says something. It asks for an action only where
        pressing, or not pressing, stands for a single one.

        Args:
            actions: number of the robot's actions.
            pressed_for: those for which the person presses, at least one and not all.
            error: probability of the other thing, in [0, 0.5].
            silence: as for `Inputs`: steps in which the button was not looked at.

        Raises:
            ValueError: if it is pressed for no action, for all, or a number is out of its range.
        """
        wanted = sorted(set(pressed_for))
        if not 0 < len(wanted) < actions or wanted[0] < 0 or wanted[-1] >= actions:
            raise ValueError(
                f"a switch is pressed for some of the actions 0 to {actions - 1} and not for all, "
                f"not for {wanted}"
            )
        if not 0 <= error <= 0.5:
            raise ValueError(f"error must lie in [0, 0.5], not {error}")
        presses = np.isin(np.arange(actions), wanted)
        press = np.where(presses, 1.0 - error, error)
        asks = [
            int(np.flatnonzero(choice)[0]) if choice.sum() == 1 else NO_ACTION
            for choice in (presses, ~presses)
        ]
        return cls(
            names=("press", "leave"),
            likelihood=np.column_stack([press, 1.0 - press]),
            asks=np.array(asks),
            directions=np.zeros((2, 2)),
            silence=silence,
        )
