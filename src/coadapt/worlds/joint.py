"""A world that robot and human move together, both at the same time (Sec. 2.3)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.worlds.world import NO_GOAL, UNREACHABLE, Goal


@dataclass(frozen=True, eq=False)
class JointWorld:
    """States of a world and the moves that pairs of actions make in it.

    Attributes:
        name: short identifier, used in files and reports.
        moves: ``[X, A_r, A_h]`` the state each pair of actions leads to
            (``T: X_world x A_r x A_h -> X_world``, Sec. 2.3); a blocked move leads to its own
            state.
        goals: one mode each, in the order of the modes.
        starts: probability of each state in which the task may begin.
        state_names: ``X`` labels.
        action_names: ``A_r`` labels of the robot's actions.
        human_action_names: ``A_h`` labels of the human's actions.
        positions: ``[X, 2]`` where to draw each state: to the right, ahead.

    Raises:
        ValueError: if an index is out of range, two goals share a state or a name, a start is a
            goal, the starts are no distribution, or the numbers of names do not fit.
    """

    name: str
    moves: IntArray
    goals: tuple[Goal, ...]
    starts: Mapping[int, float]
    state_names: tuple[str, ...] = field(repr=False)
    action_names: tuple[str, ...]
    human_action_names: tuple[str, ...]
    positions: FloatArray = field(repr=False)

    def __post_init__(self) -> None:
        if self.moves.ndim != 3:
            raise ValueError(f"moves have shape {self.moves.shape}, expected [X, A_r, A_h]")
        states, actions, human_actions = self.moves.shape
        if self.moves.min(initial=0) < 0 or self.moves.max(initial=0) >= states:
            raise ValueError(f"moves must lead to states 0 to {states - 1}")
        named = (len(self.state_names), len(self.action_names), len(self.human_action_names))
        if named != (states, actions, human_actions):
            raise ValueError(
                f"there are names for {named} states and actions of robot and human, "
                f"expected {self.moves.shape}"
            )
        if self.positions.shape != (states, 2):
            raise ValueError(f"positions have shape {self.positions.shape}, not {(states, 2)}")
        if not self.goals:
            raise ValueError("a world needs at least one goal")
        for where in (*self.starts, *self.goal_states):
            if not 0 <= where < states:
                raise ValueError(f"state {where} is not one of 0 to {states - 1}")
        for goal in self.goals:
            if not goal.states:
                raise ValueError(f"goal {goal.name} has no state")
        if len(set(self.goal_states)) < len(self.goal_states):
            raise ValueError("two goals share a state")
        if len({goal.name for goal in self.goals}) < len(self.goals):
            raise ValueError("two goals share a name")
        for start in self.starts:
            if start in self.goal_states:
                raise ValueError(f"the start, {self.state_names[start]}, is a goal")
        chances = np.array(list(self.starts.values()))
        if not (np.all(chances > 0) and abs(chances.sum() - 1.0) <= 1e-9):
            raise ValueError("starts must be positive probabilities that sum to 1")

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
        return True

    @property
    def outcomes(self) -> IntArray:
        """``[X, A_r, N]`` the states a robot action may lead to: one for each human action."""
        return self.moves

    @property
    def goal_states(self) -> tuple[int, ...]:
        """The states of all goals, those of the first goal first."""
        return tuple(state for goal in self.goals for state in goal.states)

    @cached_property
    def goal_of(self) -> IntArray:
        """``[X]`` index of the goal in each state, or `NO_GOAL`."""
        found = np.full(self.states, NO_GOAL)
        for g, goal in enumerate(self.goals):
            found[list(goal.states)] = g
        return found

    @cached_property
    def ends(self) -> BoolArray:
        """``[X]`` where the task ends."""
        return self.goal_of != NO_GOAL

    @property
    def optimal_goal(self) -> int:
        """Index of the goal with the largest reward (the first one, on a tie)."""
        return max(range(len(self.goals)), key=lambda g: self.goals[g].reward)

    def goal_at(self, state: int) -> int | None:
        """Index of the goal in ``state``, or None."""
        goal = int(self.goal_of[state])
        return None if goal == NO_GOAL else goal

    def distance(self, goal: int) -> IntArray:
        """``[X]`` fewest steps to goal ``goal`` past no other goal, if both want to go there.

        `UNREACHABLE` where there is no such path.
        """
        steps = np.full(self.states, UNREACHABLE, dtype=np.int64)
        steps[list(self.goals[goal].states)] = 0
        going = ~self.ends
        for count in range(1, self.states + 1):
            nearer = np.isin(self.moves, np.flatnonzero(steps == count - 1)).any(axis=(1, 2))
            new = going & nearer & (steps == UNREACHABLE)
            if not new.any():
                break
            steps[new] = count
        return steps
