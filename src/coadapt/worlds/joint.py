"""A world that robot and human move together, both at the same time (Sec. 2.3)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.worlds.world import Goal, World


@dataclass(frozen=True, eq=False)
class JointWorld:
    """States of a world and the moves that pairs of actions make in it.

    Attributes:
        name: short identifier, used in files and reports.
        moves: ``[X, A_r, A_h]`` the state each pair of actions leads to
            (``T: X_world x A_r x A_h -> X_world``, Sec. 2.3); a blocked move leads to its own
            state. Where moves are uncertain, ``[X, A_r, A_h, N]``: the different states each pair
            may lead to, filled up with `coadapt.human.history.NO_STATE`.
        goals: one mode each, in the order of the modes.
        starts: probability of each state in which the task may begin.
        state_names: ``X`` labels.
        action_names: ``A_r`` labels of the robot's actions.
        human_action_names: ``A_h`` labels of the human's actions.
        positions: ``[X, 2]`` where to draw each state: to the right, ahead.
        chances: ``[X, A_r, A_h, N]`` the probability of each outcome, where moves are uncertain.

    Raises:
        ValueError: if the parts do not fit together.
    """

    name: str
    moves: IntArray
    goals: tuple[Goal, ...]
    starts: Mapping[int, float]
    state_names: tuple[str, ...] = field(repr=False)
    action_names: tuple[str, ...]
    human_action_names: tuple[str, ...]
    positions: FloatArray = field(repr=False)
    chances: FloatArray | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        shape = self.moves.shape
        if len(shape) not in (3, 4):
            raise ValueError(
                f"moves have shape {shape}, expected [X, A_r, A_h] or [X, A_r, A_h, N]"
            )
        named = (len(self.state_names), len(self.action_names), len(self.human_action_names))
        if named != shape[:3]:
            raise ValueError(
                f"there are names for {named} states and actions of robot and human, "
                f"expected {shape[:3]}"
            )
        if self.positions.shape != (self.states, 2):
            raise ValueError(f"positions have shape {self.positions.shape}, not {(self.states, 2)}")
        if not self.starts:
            raise ValueError("a world needs at least one start")
        _ = self.together  # which checks the rest

    @cached_property
    def together(self) -> World:
        """The same world, moved by one who chooses both actions: action ``a_r * |A_h| + a_h``."""
        pairs = [", ".join(pair) for pair in product(self.action_names, self.human_action_names)]
        shape = (self.states, len(pairs), *self.moves.shape[3:])
        return World(
            name=self.name,
            moves=self.moves.reshape(shape),
            goals=self.goals,
            start=self.start,
            state_names=self.state_names,
            action_names=tuple(pairs),
            positions=self.positions,
            directions=np.zeros((len(pairs), 2)),
            chances=None if self.chances is None else self.chances.reshape(shape),
            starts=self.starts,
        )

    @property
    def states(self) -> int:
        """Number of states ``|X_world|``."""
        return len(self.moves)

    @property
    def actions(self) -> int:
        """Number of robot actions ``|A_r|``."""
        return self.moves.shape[1]

    @property
    def human_actions(self) -> int:
        """Number of human actions ``|A_h|``."""
        return self.moves.shape[2]

    @property
    def start(self) -> int:
        """The first of the states in which the task may begin."""
        return next(iter(self.starts))

    @property
    def start_chances(self) -> Mapping[int, float]:
        """The probability of each state in which the task may begin."""
        return self.starts

    @property
    def is_deterministic(self) -> bool:
        """Whether every pair of actions has one outcome."""
        return self.together.is_deterministic

    @property
    def outcomes(self) -> IntArray:
        """``[X, A_r, A_h * N]`` the states each robot action may lead to.

        Those of one human action are side by side, and `NO_STATE` where it has fewer.
        """
        return self.together.outcomes.reshape(self.states, self.actions, -1)

    @property
    def outcome_chances(self) -> FloatArray:
        """``[X, A_r, A_h, N]`` the probability of each outcome, given both actions."""
        return self.together.outcome_chances.reshape(*self.moves.shape[:3], -1)

    @property
    def goal_states(self) -> tuple[int, ...]:
        """The states of all goals, those of the first goal first."""
        return self.together.goal_states

    @property
    def goal_of(self) -> IntArray:
        """``[X]`` index of the goal in each state, or `coadapt.worlds.world.NO_GOAL`."""
        return self.together.goal_of

    @property
    def ends(self) -> BoolArray:
        """``[X]`` where the task ends."""
        return self.together.ends

    @property
    def optimal_goal(self) -> int:
        """Index of the goal with the largest reward (the first one, on a tie)."""
        return self.together.optimal_goal

    def goal_at(self, state: int) -> int | None:
        """Index of the goal in ``state``, or None."""
        return self.together.goal_at(state)
